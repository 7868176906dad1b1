#pragma once
#include <Eigen/Geometry>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <vector>

#include "hosts/io/stamp.hpp"

namespace posefusion {

/// Camera poses on their way back from the tracker (stage 3) to the segmentation (stage 2), which needs to know how the
/// camera moved since the previous frame in order to carry masks.
///
/// The pose of the previous frame is still being computed by then. So that the result never depends on timing,
/// the motion from frame k-1 to k is ALWAYS extrapolated at constant velocity from the poses of k-3 and k-2, and the
/// segmentation waits for the latter. Frame k-2 never needs anything of frame k, so there is no deadlock.
///
/// A loop or a relocalisation makes the pose jump, which is no motion of the camera. The motion from one frame to the
/// next is therefore taken between the corrected pose of the first, from which tracking continued, and the tracked pose
/// of the second.
class MotionPrediction {
public:
    /// A pose of the tracker.
    struct Pose {
        Stamp stamp{};
        Eigen::Isometry3d T_world_tracked;  ///< before a correction in this frame
        Eigen::Isometry3d T_world_camera;   ///< after it
        bool found = true;                  ///< false: held, as tracking has failed
    };
    /// Called by the tracker, once per frame and in order.
    void publish(const Pose& pose);

    /// Called by the tracker: no more poses will come; a waiting thread continues with those there are.
    void close();
    /// Starts again after these poses. No thread may be waiting.
    void restart(std::vector<Pose> poses);

    /// Camera motion T_previous_current from frame - 1 to `frame`; identity while there are not enough poses.
    /// @param stamp, previous_stamp  of `frame` and of the previous one
    [[nodiscard]] Eigen::Isometry3f predict(std::size_t frame, Stamp stamp, Stamp previous_stamp);

private:
    std::mutex mutex_;
    std::condition_variable published_;
    std::vector<Pose> poses_;
    bool closed_ = false;
};

}  // namespace posefusion
