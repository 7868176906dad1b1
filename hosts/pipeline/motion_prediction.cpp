#include "hosts/pipeline/motion_prediction.hpp"

#include <utility>

namespace posefusion {
namespace {

/// The motion at the same velocity over `ratio` times the interval.
Eigen::Isometry3d scale_motion(const Eigen::Isometry3d& motion, double ratio) {
    Eigen::AngleAxisd rotation(motion.rotation());
    rotation.angle() *= ratio;
    return Eigen::Translation3d(ratio * motion.translation()) * rotation;
}

}  // namespace

void MotionPrediction::publish(const Pose& pose) {
    {
        const std::lock_guard lock(mutex_);
        poses_.push_back(pose);
    }
    published_.notify_all();
}

void MotionPrediction::close() {
    {
        const std::lock_guard lock(mutex_);
        closed_ = true;
    }
    published_.notify_all();
}

void MotionPrediction::restart(std::vector<Pose> poses) {
    const std::lock_guard lock(mutex_);
    poses_ = std::move(poses);
    closed_ = false;
}

Eigen::Isometry3f MotionPrediction::predict(std::size_t frame, Stamp stamp, Stamp previous_stamp) {
    if (frame < 3) return Eigen::Isometry3f::Identity();
    std::unique_lock lock(mutex_);
    published_.wait(lock, [&] { return poses_.size() >= frame - 1 || closed_; });
    if (poses_.size() < frame - 1) return Eigen::Isometry3f::Identity();
    const Pose& from = poses_[frame - 3];
    const Pose& to = poses_[frame - 2];
    const Eigen::Isometry3d motion = from.T_world_camera.inverse() * to.T_world_tracked;
    const double known_time = to_seconds(to.stamp) - to_seconds(from.stamp),
                 wanted_time = to_seconds(stamp) - to_seconds(previous_stamp);
    if (known_time <= 0 || wanted_time <= 0) return motion.cast<float>();
    return scale_motion(motion, wanted_time / known_time).cast<float>();
}

}  // namespace posefusion
