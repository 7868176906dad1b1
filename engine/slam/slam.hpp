#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "engine/slam/slam_config.hpp"
#include "engine/vulkan/device_info.hpp"

/// Step 3 of the paper: static depth and colour in, camera pose and surfel map out.
namespace posefusion {

/// GPU time of one stage of a frame, milliseconds.
struct StageTime {
    std::string name;
    double milliseconds = 0;
};

enum class TrackingState { FirstFrame, Ok, Failed };

struct FrameResult {
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();  ///< world = first camera
    TrackingState tracking = TrackingState::FirstFrame;
    Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< (translation, rotation), m and rad
    std::uint32_t icp_inliers = 0;          ///< pixels at full resolution, last iteration
    std::uint32_t photometric_inliers = 0;
    float icp_rmse_m = 0;                   ///< true RMS of the point-to-plane residuals, metres
    float photometric_rmse = 0;             ///< RMS intensity residual, 0..1
    std::uint32_t valid_pixels = 0;         ///< live pixels with usable static depth
    int iterations = 0;                     ///< Gauss-Newton steps made, all levels
    std::uint32_t surfels = 0;              ///< in the map after this frame
    std::uint32_t stable_surfels = 0;
    std::uint64_t device_bytes = 0;         ///< device memory held by the engine
    std::vector<StageTime> gpu_times;       ///< in order of execution
};

/// One element of the map, world frame, metres.
struct Surfel {
    Eigen::Vector3f position;
    Eigen::Vector3f normal;     ///< unit
    Rgb8 color;
    float radius = 0;           ///< metres
    float confidence = 0;
    std::uint32_t created = 0, last_seen = 0;  ///< frame numbers, the first frame is 0
};

/// What the model looks like from the current camera (splat prediction).
struct ModelView {
    ColorImage color;
    DepthImage depth;
};

class Slam {
public:
    /// @param device  name (part of it, any case) or index of the Vulkan device; empty = the best one
    Slam(const Intrinsics& camera, const SlamConfig& config, const std::string& device = {});
    ~Slam();
    Slam(Slam&&) noexcept;
    Slam& operator=(Slam&&) noexcept;

    /// One frame: preprocess, track against the model, fuse, clean, predict. `labels` marks people (non-zero): those
    /// pixels take no part in anything; empty = nobody. Blocks until the frame is done. Throws Error.
    FrameResult process(const ColorImage& color, const DepthImage& depth, const LabelImage& labels = {});

    /// Copies the map from the device. @param stable_only only surfels with confidence >= stable_confidence
    [[nodiscard]] std::vector<Surfel> surfels(bool stable_only = true) const;
    /// The map as seen from any pose by any pinhole camera (size at most that of the live camera).
    [[nodiscard]] ModelView render(const Eigen::Isometry3d& T_world_camera) const;
    [[nodiscard]] const DeviceInfo& device() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace posefusion
