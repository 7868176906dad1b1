#pragma once
#include <filesystem>

#include "hosts/mesh/mesh.hpp"

namespace posefusion {

/// Throws Error unless the name ends in .ply or .obj.
void check_mesh_name(const std::filesystem::path& file);

/// Binary PLY (float x y z, uchar red green blue; faces as lists of int) or Wavefront OBJ with colours behind the
/// coordinates
/// (`v x y z r g b`, 0 .. 1), by the name. Written atomically; throws Error.
void write_mesh(const std::filesystem::path& file, const Mesh& mesh);

}  // namespace posefusion
