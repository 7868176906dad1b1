#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "engine/slam/slam.hpp"

/// Surfel maps as PLY files that MeshLab and CloudCompare open.
namespace posefusion {

/// Binary little-endian PLY, one vertex per surfel, 47 bytes each: float x y z nx ny nz, uchar red green blue,
/// float radius confidence, uint created last_seen (frame numbers). World frame, metres. `comments` go into the header,
/// one `comment` line each. Written atomically; throws Error.
void write_ply(const std::filesystem::path& file, const std::vector<Surfel>& surfels,
               const std::vector<std::string>& comments = {});

/// Reads what write_ply writes, and any other binary little-endian PLY whose first element is `vertex` with scalar
/// properties: known properties are read in any order and number type, unknown ones are skipped, missing ones keep the
/// default of Surfel. x, y and z are required. Throws Error.
[[nodiscard]] std::vector<Surfel> read_ply(const std::filesystem::path& file);

}  // namespace posefusion
