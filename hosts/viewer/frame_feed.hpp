#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/objects/object_map.hpp"
#include "hosts/io/trajectory.hpp"
#include "hosts/pipeline/frame_scheduler.hpp"
#include "hosts/viewer/skeleton_3d.hpp"

namespace posefusion {

/// The data of a frame that the viewer shows as text, lines and plots. The pixels and the map stay on the device.
struct FrameNews {
    std::size_t number = 0;
    Stamp stamp{};
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    FrameResult result;
    int people = 0;
    People joints;  ///< in pixels of the image; those of the last frame on which the network ran
    std::vector<Skeleton3d> skeletons;
    double latency_ms = 0;
    std::size_t dropped = 0;                                ///< frames before it, in real time
    std::size_t loops = 0;                                  ///< closed up to this frame
    std::vector<std::pair<std::string, double>> stages_ms;  ///< times of the pipeline's stages, which overlap
};

/// Passes the results of frames from the pipeline's thread to the window's. Neither waits for the other.
class FrameFeed {
public:
    explicit FrameFeed(const Intrinsics& camera) : camera_(camera) {}

    /// Called by the pipeline, once per frame and in order.
    void publish(const ScheduledFrame& frame);
    /// Called by the pipeline after publish(), when a loop has corrected earlier poses or the map has another world.
    /// @param frames  numbers of the frames that have a pose in the map; the others are no longer shown  @param poses
    /// of each
    void correct(const std::vector<std::size_t>& frames, const std::vector<Eigen::Isometry3d>& poses);

    struct News {
        std::vector<FrameNews> frames;        ///< since the last call, the newest last
        std::optional<Trajectory> corrected;  ///< all poses, those of `frames` included, if earlier ones have changed
    };
    /// Called by the window.
    [[nodiscard]] News collect();
    [[nodiscard]] std::size_t frames_done() const;
    [[nodiscard]] Trajectory trajectory() const;

    /// Called by the pipeline after publish(), where models_wanted().
    void publish_models(std::vector<ObjectMap> models);
    [[nodiscard]] bool models_wanted() const;
    /// Called by the window: models that were not taken yet. Where there are none, they are wanted from now on.
    [[nodiscard]] std::optional<std::vector<ObjectMap>> take_models();

    /// Called at the start of a new run.
    void clear();

private:
    [[nodiscard]] Trajectory shown_poses() const;  // under mutex_

    const Intrinsics camera_;
    mutable std::mutex mutex_;
    std::vector<FrameNews> news_;
    bool corrected_ = false;  // since collect()
    std::size_t loops_ = 0;
    std::vector<Eigen::Isometry3d> poses_;  // of all frames
    std::vector<Stamp> stamps_;
    std::vector<bool> shown_;  // is it in the world of the map?
    People last_joints_;
    std::optional<std::vector<ObjectMap>> models_;
    bool models_wanted_ = false;
};

}  // namespace posefusion
