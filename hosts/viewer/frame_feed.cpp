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
    for (const LoopEvent& event : frame.result.loops)
        loops_ += event.accepted && event.kind != LoopKind::Relocalisation ? 1 : 0;
    news.loops = loops_;
    news.stages_ms = {{"read", frame.read_ms}};
    if (frame.people.joints_ms) news.stages_ms.emplace_back("joints", *frame.people.joints_ms);
    if (frame.people.segmentation_ms) news.stages_ms.emplace_back("segmentation", *frame.people.segmentation_ms);
    news.stages_ms.emplace_back("slam", frame.slam_ms);
    if (frame.people.joints) last_joints_ = *frame.people.joints;
    if (news.people > 0) {
        news.joints = last_joints_;
        news.skeletons = lift_joints(news.joints, frame.input.depth, frame.people.segmentation.labels, camera_,
                                     news.T_world_camera.cast<float>());
    }
    const std::lock_guard lock(mutex_);
    trajectory_.push_back({news.stamp, news.T_world_camera});
    news_.push_back(std::move(news));
}

void FrameFeed::correct(const std::vector<Eigen::Isometry3d>& poses) {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < std::min(poses.size(), trajectory_.size()); ++i)
        trajectory_[i].T_world_camera = poses[i];
    corrected_ = true;
}

FrameFeed::News FrameFeed::collect() {
    const std::lock_guard lock(mutex_);
    News news{std::exchange(news_, {}), std::nullopt};
    if (std::exchange(corrected_, false)) news.corrected = trajectory_;
    return news;
}

std::size_t FrameFeed::frames_done() const {
    const std::lock_guard lock(mutex_);
    return trajectory_.size();
}

Trajectory FrameFeed::trajectory() const {
    const std::lock_guard lock(mutex_);
    return trajectory_;
}

void FrameFeed::clear() {
    const std::lock_guard lock(mutex_);
    news_.clear();
    trajectory_.clear();
    last_joints_.clear();
    corrected_ = false;
    loops_ = 0;
}

}  // namespace posefusion
