#pragma once
#include <Eigen/Geometry>
#include <condition_variable>
#include <cstddef>
#include <mutex>

#include "hosts/io/trajectory.hpp"

namespace posefusion {

/// Camera poses on their way back from the tracker (stage 3) to the segmentation (stage 2), which needs to know how the
/// camera moved since the previous frame in order to carry masks.
///
/// The pose of the previous frame is still being computed by then. So that the answer never depends on who is faster,
/// the motion from frame k-1 to k is ALWAYS extrapolated at constant velocity from the poses of k-3 and k-2, and the
/// segmentation waits for the latter. Frame k-2 never needs anything of frame k, so nobody waits in a circle.
class MotionPrediction {
public:
    /// By the tracker, once per frame and in order. @param stamp seconds
    void publish(double stamp, const Eigen::Isometry3d& T_world_camera);

    /// By the tracker: no more poses will come; whoever waits goes on with what there is.
    void close();

    /// Camera motion T_previous_current from frame - 1 to `frame`; identity while there are not enough poses.
    /// @param stamp, previous_stamp seconds, of `frame` and of the one before it
    [[nodiscard]] Eigen::Isometry3f predict(std::size_t frame, double stamp, double previous_stamp);

private:
    std::mutex mutex_;
    std::condition_variable published_;
    Trajectory poses_;
    bool closed_ = false;
};

}  // namespace posefusion
