#pragma once
#include <Eigen/Geometry>
#include <filesystem>

#include "hosts/mesh/mesh.hpp"
#include "hosts/mesh/textured_mesh.hpp"

namespace posefusion {

/// Throws Error unless the name ends in .ply, .obj or .glb.
void check_mesh_name(const std::filesystem::path& file);

/// Turns a world with y down and z forward, as the first camera of a run has it, to y up and z back.
inline const Eigen::Quaternionf kCameraUpright{0, 1, 0, 0};

/// By the name:
///   - .ply: binary (float x y z, uchar red green blue; faces as lists of int)
///   - .obj: Wavefront OBJ with normals, and colours behind the coordinates (`v x y z r g b`, 0 .. 1); beside it
///   NAME.mtl
///     with the material, for programs that insist on one
///   - .glb: see write_glb_mesh(); `upright` is for this one, the others keep the world of the mesh
/// Written atomically; throws Error.
void write_mesh(const std::filesystem::path& file, const Mesh& mesh,
                const Eigen::Quaternionf& upright = kCameraUpright);

/// Throws Error unless the name ends in .obj or .glb, which can have a texture.
void check_textured_mesh_name(const std::filesystem::path& file);

/// The same with a texture: in the .glb, or in NAME.png beside .obj and .mtl.
void write_mesh(const std::filesystem::path& file, const TexturedMesh& mesh,
                const Eigen::Quaternionf& upright = kCameraUpright);

}  // namespace posefusion
