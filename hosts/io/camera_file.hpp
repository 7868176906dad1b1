#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "engine/core/intrinsics.hpp"

/// What one has to know of a camera to use its recordings.
namespace posefusion {

struct Camera {
    Intrinsics intrinsics;
    float depth_scale = 5000.0f;        ///< depth image value of one metre
    std::array<float, 5> distortion{};  ///< k1 k2 p1 p2 k3 (Brown), 0 = none; the same for colour and registered depth
    [[nodiscard]] bool distorted() const { return distortion != std::array<float, 5>{}; }
};

/// YAML: fx fy cx cy width height (needed), depth_scale (where missing `default_depth_scale`), k1 k2 p1 p2 k3 (default
/// 0); other keys are ignored. Throws Error naming the file and the key that is missing, not a number or out of range.
[[nodiscard]] Camera read_camera_file(const std::filesystem::path& file, float default_depth_scale = 5000.0f);

/// Writes what read_camera_file() reads back bit for bit. Atomic; throws Error.
void write_camera_file(const std::filesystem::path& file, const Camera& camera);

/// The published calibration of the TUM RGB-D cameras if the folder name says which one it was (fr1, freiburg2, ...).
[[nodiscard]] std::optional<Camera> tum_camera(const std::string& folder_name);

/// The camera of the renderings of ICL-NUIM (with y pointing down, as everywhere here).
[[nodiscard]] Camera icl_camera();

/// tum_camera(), or icl_camera() for a folder name of ICL-NUIM (icl, living_room_traj, office_room_traj, frei_png).
[[nodiscard]] std::optional<Camera> known_camera(const std::string& folder_name);

}  // namespace posefusion
