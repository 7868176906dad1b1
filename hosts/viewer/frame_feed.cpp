#include "hosts/viewer/frame_feed.hpp"

#include <algorithm>

namespace posefusion {

void FrameFeed::publish(const ScheduledFrame& frame) {
    FrameNews news;
    news.number = frame.number;
    news.stamp = frame.input.stamp;
    news.T_world_camera = frame.result.T_world_camera;
    news.result = frame.result;
    news.people = frame.people.segmentation.people;
    news.latency_ms = frame.latency_ms;
    news.dropped = frame.dropped;
    for (const LoopEvent& event : frame.result.loops) loops_ += event.closes_loop() ? 1 : 0;
    news.loops = loops_;
    news.stages_ms = {{"read", frame.read_ms}};
    if (frame.people.joints_ms) news.stages_ms.emplace_back("joints", *frame.people.joints_ms);
    if (frame.people.segmentation_ms) news.stages_ms.emplace_back("segmentation", *frame.people.segmentation_ms);
    if (frame.features_ms) news.stages_ms.emplace_back("features", *frame.features_ms);
    news.stages_ms.emplace_back("slam", frame.slam_ms);
    if (frame.people.joints) last_joints_ = *frame.people.joints;
    if (news.people > 0) {
        news.joints = last_joints_;
        news.skeletons = lift_joints(news.joints, frame.input.depth, frame.people.segmentation.labels, camera_,
                                     news.T_world_camera.cast<float>());
    }
    const std::lock_guard lock(mutex_);
    stamps_.push_back(news.stamp);
    poses_.push_back(news.T_world_camera);
    shown_.push_back(true);
    news_.push_back(std::move(news));
}

void FrameFeed::correct(const std::vector<std::size_t>& frames, const std::vector<Eigen::Isometry3d>& poses) {
    const std::lock_guard lock(mutex_);
    std::fill(shown_.begin(), shown_.end(), false);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        poses_.at(frames[i]) = poses[i];
        shown_.at(frames[i]) = true;
    }
    corrected_ = true;
}

FrameFeed::News FrameFeed::collect() {
    const std::lock_guard lock(mutex_);
    News news{std::exchange(news_, {}), std::nullopt};
    if (std::exchange(corrected_, false)) news.corrected = shown_poses();
    return news;
}

std::size_t FrameFeed::frames_done() const {
    const std::lock_guard lock(mutex_);
    return poses_.size();
}

Trajectory FrameFeed::trajectory() const {
    const std::lock_guard lock(mutex_);
    return shown_poses();
}

Trajectory FrameFeed::shown_poses() const {
    Trajectory trajectory;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
        if (shown_[i]) trajectory.push_back({stamps_[i], poses_[i]});
    }
    return trajectory;
}

void FrameFeed::publish_models(std::vector<ObjectMap> models) {
    const std::lock_guard lock(mutex_);
    models_ = std::move(models);
    models_wanted_ = false;
}

bool FrameFeed::models_wanted() const {
    const std::lock_guard lock(mutex_);
    return models_wanted_;
}

std::optional<std::vector<ObjectMap>> FrameFeed::take_models() {
    const std::lock_guard lock(mutex_);
    if (!models_) models_wanted_ = true;
    return std::exchange(models_, std::nullopt);
}

void FrameFeed::clear() {
    const std::lock_guard lock(mutex_);
    news_.clear();
    poses_.clear();
    stamps_.clear();
    shown_.clear();
    last_joints_.clear();
    corrected_ = false;
    loops_ = 0;
    models_.reset();
    models_wanted_ = false;
}

}  // namespace posefusion
