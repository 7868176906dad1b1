#pragma once
#include <filesystem>

#include "tools/evaluate_objects/object_truth.hpp"

namespace posefusion {

/// A mesh as `posefusion export` writes it, .ply or .glb, in the world of the run: what turns a .glb upright is in its
/// node, not in its positions. Throws Error: another format, damaged, or without triangles.
[[nodiscard]] TrueMesh read_exported_mesh(const std::filesystem::path& file);

/// The same of a .glb, whatever its name.
[[nodiscard]] TrueMesh read_exported_glb(const std::filesystem::path& file);

}  // namespace posefusion
