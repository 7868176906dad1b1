#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include "engine/map/surfel.hpp"

namespace posefusion {

/// The surfels of map.ply, which holds stable ones (or all, if the run was told so), or of a map file, which holds all.
/// Says on the standard error stream how many there are. Throws Error: not readable, or none is left.
/// @param min_confidence  those below it are left out; nullopt: those that are not stable
[[nodiscard]] std::vector<Surfel> read_wanted_surfels(const std::filesystem::path& file,
                                                      std::optional<float> min_confidence);

}  // namespace posefusion
