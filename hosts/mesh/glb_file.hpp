#pragma once
#include <Eigen/Geometry>
#include <iosfwd>

#include "hosts/mesh/mesh.hpp"
#include "hosts/mesh/textured_mesh.hpp"

namespace posefusion {

/// A binary glTF 2.0 (https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html): one mesh with positions, normals,
/// vertex colours (linear, 16 bit) and a material that shows them as they are (KHR_materials_unlit: the light of the
/// room is in them). Positions are those of the mesh, in metres; the node turns them. Throws Error: 4 GB and more.
/// @param upright  turns the world of the mesh to y up, as glTF has it
void write_glb_mesh(std::ostream& out, const Mesh& mesh, const Eigen::Quaternionf& upright);
/// The same with the texture, as a JPEG, in place of vertex colours.
void write_glb_mesh(std::ostream& out, const TexturedMesh& mesh, const Eigen::Quaternionf& upright);

}  // namespace posefusion
