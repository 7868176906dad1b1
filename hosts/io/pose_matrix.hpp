#pragma once
#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

/// Poses as 4x4 matrices in text files.
namespace posefusion {

/// 16 numbers row by row (or the 12 of the upper rows); rotations of few digits are made exact. nullopt: not finite (as
/// ScanNet marks a camera that is lost), or no rigid motion.
[[nodiscard]] std::optional<Eigen::Isometry3d> rigid_motion(std::span<const double> numbers);

/// A file that holds one. Throws Error naming it.
[[nodiscard]] Eigen::Isometry3d read_rigid_motion(const std::filesystem::path& file);

/// The numbers of a file that holds one; empty where something else is in it.
[[nodiscard]] std::vector<double> read_numbers(const std::filesystem::path& file);

}  // namespace posefusion
