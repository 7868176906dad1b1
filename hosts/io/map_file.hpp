#pragma once
#include <filesystem>
#include <vector>

#include "engine/slam/slam_state.hpp"
#include "hosts/io/section_file.hpp"

/// The whole state of the engine as a file: what `--save-map` writes and `--load-map` reads.
namespace posefusion {

/// Changes whenever the sections, or the structures of the device among them, change.
inline constexpr std::uint32_t kStateVersion = 3;

/// Throws Error.
void write_map(const std::filesystem::path& file, const SlamState& state);
/// Throws Error; see read_sections(). Whether the content fits an engine is for Slam::restore() to say.
[[nodiscard]] SlamState read_map(const std::filesystem::path& file);

/// Does the file begin like one?
[[nodiscard]] bool is_map_file(const std::filesystem::path& file);

/// For files that hold more than a state. The sections refer to `state`, which must outlive them.
[[nodiscard]] std::vector<Section> sections_of(const SlamState& state);
[[nodiscard]] SlamState take_state(ReadSections& sections);

}  // namespace posefusion
