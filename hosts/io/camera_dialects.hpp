#pragma once
#include <filesystem>
#include <optional>
#include <span>

#include "hosts/io/camera_file.hpp"
#include "hosts/io/camera_keys.hpp"

/// Camera files of other programs.
namespace posefusion {

/// nullopt when the keys are not those of another program. Throws Error as read_camera_description() does.
[[nodiscard]] std::optional<CameraDescription> describe_foreign_camera(const CameraKeys& keys);

/// A file of numbers only: 4 are fx fy cx cy, 9 or 16 a camera matrix row by row.
[[nodiscard]] CameraDescription describe_numbers(std::span<const double> numbers, const std::filesystem::path& file);

/// A description whose fy may be negative, with y pointing down.
[[nodiscard]] CameraDescription with_y_down(CameraDescription description);

}  // namespace posefusion
