#include "hosts/viewer/frame_feed.hpp"

namespace posefusion {

void FrameFeed::publish(const TrackedFrame& frame) {
    FrameNews news;
    news.number = frame.number;
    news.stamp = frame.input.stamp;
    news.T_world_camera = frame.result.T_world_camera;
    news.result = frame.result;
    news.people = frame.people.segmentation.people;
    news.latency_ms = frame.latency_ms;
    news.dropped = frame.dropped;
    news.stages_ms = {{"read", frame.read_ms}};
    if (frame.people.joints_ms) news.stages_ms.emplace_back("joints", *frame.people.joints_ms);
    if (frame.people.min_cut_ms) news.stages_ms.emplace_back("min-cut", *frame.people.min_cut_ms);
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

std::vector<FrameNews> FrameFeed::collect() {
    const std::lock_guard lock(mutex_);
    return std::exchange(news_, {});
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
}

}  // namespace posefusion
