#pragma once
#include <filesystem>
#include <vector>

#include "engine/slam/slam_state.hpp"
#include "hosts/io/section_file.hpp"

/// The whole state of the engine as a file: what `--save-map` writes and `--load-map` reads.
namespace posefusion {

/// Changes whenever the sections, or the device structures in them, change.
inline constexpr std::uint32_t kStateVersion = 8;

/// Throws Error.
void write_map(const std::filesystem::path& file, const SlamState& state);
/// Throws Error; see read_sections(). Slam::restore() checks whether the content fits an engine.
[[nodiscard]] SlamState read_map(const std::filesystem::path& file);

/// Whether the file begins like a map file.
[[nodiscard]] bool is_map_file(const std::filesystem::path& file);

/// For files that hold more than a state. The sections refer to `state`, which must outlive them.
[[nodiscard]] std::vector<Section> sections_of(const SlamState& state);
[[nodiscard]] SlamState take_state(ReadSections& sections);

}  // namespace posefusion
