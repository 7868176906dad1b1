#pragma once
#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

/// Poses as 4x4 matrices in text files.
namespace posefusion {

/// 16 numbers row by row (or the 12 of the upper rows); rotations with few digits are orthonormalised. nullopt: not
/// finite (as ScanNet marks a lost camera), or not a rigid motion.
[[nodiscard]] std::optional<Eigen::Isometry3d> rigid_motion(std::span<const double> numbers);

/// Reads a file that holds one. Throws Error naming it.
[[nodiscard]] Eigen::Isometry3d read_rigid_motion(const std::filesystem::path& file);

/// The numbers of such a file; empty if it holds anything else.
[[nodiscard]] std::vector<double> read_numbers(const std::filesystem::path& file);

}  // namespace posefusion
