#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "engine/core/motion_judge.hpp"
#include "engine/loops/loop_graph.hpp"
#include "engine/map/model_view.hpp"
#include "engine/map/surfel.hpp"
#include "engine/slam/frame_result.hpp"
#include "engine/slam/slam_config.hpp"
#include "engine/tracking/sensor_timing.hpp"
#include "engine/tracking/start_pose.hpp"
#include "engine/vulkan/device_info.hpp"
#include "engine/vulkan/device_sharing.hpp"

/// Step 3 of the paper: static depth and colour in, camera pose and surfel map out.
namespace posefusion {

struct SlamState;    // engine/slam/slam_state.hpp
struct AtlasState;   // engine/slam/map_piece.hpp
struct MapPiece;     // engine/slam/map_piece.hpp
struct MapSnapshot;  // engine/slam/map_snapshot.hpp
namespace vulkan {
class Context;
}

/// The const members, snapshot(), set_config() and reset() may be called while process() runs in another thread; all
/// but snapshot() and set_config() then wait for the frame.
class Slam {
public:
    /// @param device  name (part of it, any case) or index of the Vulkan device; empty = the best one
    /// @param sharing requirements of a renderer that shares the device
    Slam(const Intrinsics& camera, const SlamConfig& config, const std::string& device = {},
         const DeviceSharing& sharing = {});
    ~Slam();
    Slam(Slam&&) noexcept;
    Slam& operator=(Slam&&) noexcept;

    /// One frame: preprocess, track against the model, fuse, clean, predict. `labels` marks people (non-zero): their
    /// pixels are neither tracked nor fused, and unstable surfels at their depth are removed; empty = no people. Blocks
    /// until the frame is done. `timing` matters with a rolling shutter only. `starts`: where the camera may be, the
    /// most reliable first; tracking begins at the first whose earlier frame has a pose, if its own start would miss.
    /// Throws Error.
    FrameResult process(const ColorImage& color, const DepthImage& depth, const LabelImage& labels = {},
                        const FrameTiming& timing = {}, std::span<const StartPose> starts = {});

    /// Who decides what moves and is no person: it is neither tracked nor fused, and what the map has of it is removed.
    /// nullptr, as at the beginning: nobody does.
    void set_motion_judge(std::shared_ptr<MotionJudge> judge);

    // The map may be in several pieces (engine/slam/map_piece.hpp). Unless stated otherwise the functions below are
    // about the current piece, the one that the camera is in.

    /// Camera poses T_world_camera of the frames of the piece, world = its first camera (unless a loop has deformed the
    /// map there). Loops correct earlier poses: these are consistent with the map, unlike those that process() returned
    /// at the time.
    [[nodiscard]] std::vector<Eigen::Isometry3d> trajectory() const;
    /// The numbers of these frames, counted over all that were processed (after restore(SlamState): those of the
    /// restored map first). Frames that are missing belong to another piece, or to a beginning that was given up.
    [[nodiscard]] std::vector<std::uint32_t> frames() const;
    [[nodiscard]] std::uint32_t frames_processed() const;
    /// Pieces that have not been joined to the current one, oldest first, with their stable surfels.
    [[nodiscard]] std::vector<MapPiece> other_pieces(bool stable_only = true) const;
    /// At the end: makes the largest piece current, the one with the most tracked frames; or that of a restored map.
    void choose_main_piece();

    /// Frames whose view can be recognised, oldest first, as positions in trajectory().
    [[nodiscard]] std::vector<std::uint32_t> keyframes() const;
    /// The graph of the last loop that deformed the map since the start or restore(); nullopt if there was none.
    [[nodiscard]] std::optional<LoopGraph> loop_graph() const;

    /// Everything that the next frame depends on (engine/slam/slam_state.hpp), except for other pieces.
    [[nodiscard]] SlamState state() const;
    /// The same with all pieces.
    [[nodiscard]] AtlasState atlas_state() const;
    /// Continues from a state: with the same configuration the same frames give the same bytes. Throws Error, and
    /// changes nothing, if the state stems from another camera or other ferns, is inconsistent, or holds more surfels
    /// than allowed.
    void restore(const SlamState& state);
    void restore(const AtlasState& state);
    /// The camera may be anywhere in the map from now on: nothing is fused until tracking or place recognition has
    /// found its pose.
    void lose_camera();

    /// The poses of the frames of the current piece are known better, from bundle adjustment for example: map,
    /// keyframes and camera follow them, the map through a deformation graph. Throws Error if there are not as many
    /// poses as frames. @param T_world_camera  of each frame of trajectory()
    void follow(std::span<const Eigen::Isometry3d> T_world_camera);

    /// Copies the map from the device. @param stable_only only surfels with confidence >= stable_confidence
    [[nodiscard]] std::vector<Surfel> surfels(bool stable_only = true) const;
    /// Renders the stable map from a pose, with the intrinsics of the live camera.
    [[nodiscard]] ModelView render(const Eigen::Isometry3d& T_world_camera) const;
    /// Of the frames so far, with SlamConfig::estimate_timing.
    [[nodiscard]] SensorTiming::Estimate sensor_timing() const;
    [[nodiscard]] const DeviceInfo& device() const;

    /// Takes effect with the next frame. Values that determine kernels and buffers keep their value until reset():
    /// iterations, steps, window radii, index_map_scale, capacities, int64_atomics, validation, localise_only, shutter,
    /// estimate_timing and all of loops and relocalisation. Thread-safe. Throws Error as the constructor does.
    void set_config(const SlamConfig& config);
    /// Starts again with an empty map, on the same device.
    void reset();

    /// The newest frame for drawing, each at most once: nullptr if there is no new one. Meant to be polled: a frame is
    /// copied, on the device, only after this was called since the last copy. Never waits for a frame.
    [[nodiscard]] std::shared_ptr<const MapSnapshot> snapshot();
    /// The device, for a renderer that shares it.
    [[nodiscard]] std::shared_ptr<vulkan::Context> context() const;
    [[nodiscard]] const Intrinsics& camera() const;
    /// Number of messages of Vulkan's validation so far; 0 without SlamConfig::validation.
    [[nodiscard]] std::uint32_t validation_messages() const;

private:
    struct Shared;
    std::unique_ptr<Shared> shared_;
};

}  // namespace posefusion
