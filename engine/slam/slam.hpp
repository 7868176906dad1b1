#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "engine/slam/slam_config.hpp"
#include "engine/slam/tracking_state.hpp"
#include "engine/vulkan/device_info.hpp"
#include "engine/vulkan/device_sharing.hpp"

/// Step 3 of the paper: static depth and colour in, camera pose and surfel map out.
namespace posefusion {

struct SlamState;

/// GPU time of one stage of a frame, milliseconds.
struct StageTime {
    std::string name;
    double milliseconds = 0;
};

/// An attempt to bring the live image into agreement with an older part of the map.
struct LoopEvent {
    std::uint32_t frame = 0;
    LoopKind kind = LoopKind::Local;
    std::uint32_t model_frame = 0;  ///< of the keyframe; local loops: median creation time of what was matched
    bool accepted = false;
    std::string reason;      ///< why it was not accepted
    float overlap = 0;       ///< share of the image that shows the older part
    float inlier_ratio = 0;  ///< of the overlap
    float icp_rmse_m = 0, photometric_rmse = 0;
    float correlation = 0;  ///< of live and model intensities, -1..1; 1 where there is too little contrast to say
    double residual_before_m = 0;  ///< mean displacement of the older part against the live image, before ...
    double residual_after_m = 0;   ///< ... and after the deformation
    std::uint32_t nodes = 0;       ///< of the deformation graph; 0: nothing had to be deformed
    double milliseconds = 0;       ///< the whole attempt took; tracking stands still
    double solve_milliseconds =
        0;  ///< ... of it the graph: sampled, solved and prepared for the map; 0 where there was none

    friend bool operator==(const LoopEvent&, const LoopEvent&) = default;
};

/// The deformation graph that a loop bent the map with, for people to look at. World frame after that loop, metres.
struct LoopGraph {
    struct Node {
        Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< where the loop has put it
        Eigen::Vector3d moved = Eigen::Vector3d::Zero();     ///< from where it was before
    };
    std::uint32_t frame = 0;                          ///< of the loop
    std::vector<Node> nodes;                          ///< those of the map, then those of cameras
    std::uint32_t map_nodes = 0;                      ///< how many are of the map
    std::vector<std::array<std::uint32_t, 2>> edges;  ///< between which nodes
};

struct FrameResult {
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();  ///< world = first camera
    /// The pose before a loop or a relocalisation in this frame corrected it; the same where none did. Seen from the
    /// T_world_camera of the frame before, it is how the camera has really moved.
    Eigen::Isometry3d T_world_tracked = Eigen::Isometry3d::Identity();
    TrackingState tracking = TrackingState::FirstFrame;
    Eigen::Matrix<double, 6, 6> covariance =
        Eigen::Matrix<double, 6, 6>::Zero();  ///< (translation, rotation), m and rad
    std::uint32_t icp_inliers = 0;            ///< pixels at full resolution, last iteration
    std::uint32_t photometric_inliers = 0;
    float icp_rmse_m = 0;            ///< true RMS of the point-to-plane residuals, metres
    float photometric_rmse = 0;      ///< RMS intensity residual, 0..1
    std::uint32_t valid_pixels = 0;  ///< live pixels with usable static depth
    int iterations = 0;              ///< Gauss-Newton steps made, all levels
    std::uint32_t surfels = 0;       ///< in the map after this frame
    std::uint32_t stable_surfels = 0;
    std::uint64_t device_bytes = 0;    ///< device memory held by the engine
    std::uint32_t keyframes = 0;       ///< places that can be recognised
    std::vector<LoopEvent> loops;      ///< attempts in this frame
    std::vector<StageTime> gpu_times;  ///< in order of execution
};

/// One element of the map, world frame, metres.
struct Surfel {
    Eigen::Vector3f position;
    Eigen::Vector3f normal;  ///< unit
    Rgb8 color;
    float radius = 0;  ///< metres
    float confidence = 0;
    std::uint32_t created = 0, last_seen = 0;  ///< frame numbers, the first frame is 0
};

/// What the model looks like from the current camera (splat prediction).
struct ModelView {
    ColorImage color;
    DepthImage depth;
};

struct MapSnapshot;  // engine/slam/map_snapshot.hpp
namespace vulkan {
class Context;
}

/// The const members, snapshot(), set_config() and reset() may be called while process() runs in another thread; all
/// but snapshot() and set_config() then wait for the frame.
class Slam {
public:
    /// @param device  name (part of it, any case) or index of the Vulkan device; empty = the best one
    /// @param sharing what a guest needs that draws with that device
    Slam(const Intrinsics& camera, const SlamConfig& config, const std::string& device = {},
         const DeviceSharing& sharing = {});
    ~Slam();
    Slam(Slam&&) noexcept;
    Slam& operator=(Slam&&) noexcept;

    /// One frame: preprocess, track against the model, fuse, clean, predict. `labels` marks people (non-zero): those
    /// pixels take no part in anything; empty = nobody. Blocks until the frame is done. Throws Error.
    FrameResult process(const ColorImage& color, const DepthImage& depth, const LabelImage& labels = {});

    /// Camera poses of all frames so far. Loops correct the past: these are consistent with the map, what process()
    /// returned at the time need not be. T_world_camera, world = first camera unless the map has been deformed there.
    [[nodiscard]] std::vector<Eigen::Isometry3d> trajectory() const;

    /// Frames whose view can be recognised, oldest first. Where the camera was then is in trajectory().
    [[nodiscard]] std::vector<std::uint32_t> keyframes() const;
    /// Of the last loop that has bent the map since the start or restore(); nullopt: there was none.
    [[nodiscard]] std::optional<LoopGraph> loop_graph() const;

    /// All that the next frame depends on (engine/slam/slam_state.hpp).
    [[nodiscard]] SlamState state() const;
    /// Goes on where the state was taken: with the same configuration the same frames give the same bytes. Throws Error
    /// if it was taken with another camera or other ferns, contradicts itself, or holds more surfels than allowed;
    /// nothing has changed then.
    void restore(const SlamState& state);
    /// The camera may be anywhere in the map from now on: nothing is fused until tracking or place recognition has
    /// found it.
    void lose_camera();

    /// Copies the map from the device. @param stable_only only surfels with confidence >= stable_confidence
    [[nodiscard]] std::vector<Surfel> surfels(bool stable_only = true) const;
    /// The stable map as the live camera would see it from any pose.
    [[nodiscard]] ModelView render(const Eigen::Isometry3d& T_world_camera) const;
    [[nodiscard]] const DeviceInfo& device() const;

    /// From the next frame on. Numbers that decide kernels and buffers keep their value until reset(): iterations,
    /// steps, window radii, index_map_scale, capacities, int64_atomics, validation, localise_only, and all of loops and
    /// relocalisation. May be called by any thread. Throws Error as the constructor does.
    void set_config(const SlamConfig& config);
    /// Starts anew with an empty map, on the same device.
    void reset();

    /// The newest frame for drawing, never the same twice: nullptr if there is none yet. To be asked again and again: a
    /// frame is copied, on the device, only when it has been asked for since the last one. Never waits for a frame.
    [[nodiscard]] std::shared_ptr<const MapSnapshot> snapshot();
    /// For guests; lives as long as somebody holds it.
    [[nodiscard]] std::shared_ptr<vulkan::Context> context() const;
    [[nodiscard]] const Intrinsics& camera() const;
    /// Complaints of Vulkan's validation so far; 0 without SlamConfig::validation.
    [[nodiscard]] std::uint32_t validation_messages() const;

private:
    struct Impl;
    struct Shared;
    std::unique_ptr<Shared> shared_;  // outlives impl_
    std::unique_ptr<Impl> impl_;
};

}  // namespace posefusion
