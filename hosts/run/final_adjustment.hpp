#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hosts/adjust/readout.hpp"
#include "hosts/config/run_config.hpp"

namespace posefusion {

struct RunRecord;  // hosts/run/run_record.hpp

/// Bundle adjustment at the end of a run: keyframes and the points that they see in common say better than tracking,
/// frame after frame, where the camera was. All other frames are placed by the same points; the map follows
/// (Slam::follow()).
struct FinalAdjustmentConfig {
    static constexpr std::size_t kFewestFrames = 40;  ///< tracked ones; a shorter run has not drifted
    static constexpr std::size_t kKeyframes = 48;     ///< at most
    static constexpr std::size_t kFewestKeyframes = 5, kFewestLandmarks = 100;
    static constexpr float kWidth = 640;  ///< images are shrunk to about this
    /// A frame is placed by the landmarks of so many keyframes before it, after it, and of the most similar views.
    static constexpr std::size_t kNear = 2, kSimilar = 4;
    /// Of a step from keyframe to keyframe, or to a frame between them, as tracking knows it, per axis: it counts where
    /// landmarks say little.
    static constexpr double kStepPosition = 0.01, kStepRotation = 0.005;  ///< metres, radians
    /// Every so manyth landmark has no part: it must fit better by this share of its cost, or nothing is changed.
    static constexpr std::size_t kHeldOut = 5;
    static constexpr double kLeastGain = 0.01;
    /// With a rolling shutter: better poses say better how the camera moved during read-out, and that gives better
    /// poses and times of the rows. A later round must not fit worse than the one before by more than this share.
    static constexpr int kRounds = 3;
    static constexpr double kMostLoss = 0.001;
    /// Where from one frame to the next this share more of the image is seen to move, it has moved unnoticed for up to
    /// so many frames, and tracking may have gone along: they are no keyframes, and are placed anew from the frames
    /// after them. So many times less than usual is known of where they are.
    static constexpr float kRevealed = 0.05f;
    static constexpr std::size_t kUnnoticed = 10;
    static constexpr double kVague = 10;
    /// A frame that its landmarks place farther from where its keyframes would have it is left there.
    static constexpr double kMostOff = 0.02, kMostTurned = 0.02;  ///< metres, radians
};

struct FinalAdjustment {
    std::vector<Eigen::Isometry3d> poses;  ///< T_world_camera of the frames of the first piece; empty: `reason`
    std::string reason;                    ///< why nothing is changed, in a line; empty: it is
    Way way = Way::Smooth;                 ///< how the camera goes from frame to frame, where its shutter rolls
    std::optional<RowTimes> times;         ///< of its rows, as the points have them; nullopt: as they were given
    std::size_t keyframes = 0, landmarks = 0, observations = 0;
    std::size_t placed = 0;                          ///< other frames that were placed by landmarks
    double held_out_before = 0, held_out = 0;        ///< mean cost of the observations held out
    double mean_change_m = 0, largest_change_m = 0;  ///< of the camera's position
};

/// @param recording  that it was a run of  @param progress  of the steps done and in all
/// @return nullopt: not asked for, a camera, a map that was there before, a run that did not finish, too few frames; or
/// cancelled. Throws Error: the recording cannot be read any more.
[[nodiscard]] std::optional<FinalAdjustment> adjust_at_end(
    const std::filesystem::path& recording, const RunConfig& config, const RunRecord& record,
    const std::function<void(std::size_t, std::size_t)>& progress, const std::function<bool()>& cancelled);

}  // namespace posefusion
