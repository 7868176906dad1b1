#include "hosts/pipeline/frame_by_frame.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "engine/core/error.hpp"
#include "hosts/pipeline/undistort_on_device.hpp"

namespace posefusion {
namespace {

RunConfig checked(const RunConfig& config) {
    check_config(config);
    return config;
}

}  // namespace

FrameByFrame::FrameByFrame(const Camera& camera, const RunConfig& config)
    : config_(checked(config)),
      geometry_(camera, config_.scale),
      people_(make_people_finder(config_, geometry_.intrinsics())),
      slam_(geometry_.intrinsics(), slam_config(config_), config_.device) {
    undistort_on_device(geometry_, slam_);
}

FrameByFrame::Result FrameByFrame::process(double stamp, ColorImage color, DepthImage depth,
                                           std::optional<LabelImage> labels) {
    const double previous_stamp = stamps_.empty() ? 0 : stamps_.back();
    if (!std::isfinite(stamp) || (!stamps_.empty() && stamp <= previous_stamp)) {
        throw Error("time stamp " + std::to_string(stamp) +
                    " s does not come after that of the frame before; give frames in order");
    }
    Frame frame;
    frame.index = stamps_.size();
    frame.stamp = stamp;
    ImageGeometry::FrameImages images = geometry_.from_source(std::move(color), std::move(depth));
    frame.color = std::move(images.color);
    frame.depth = std::move(images.depth);
    frame.undistort = images.undistort;
    const std::string name = "frame at " + std::to_string(stamp) + " s";
    check_usable(frame, name, name);

    Result result;
    if (labels) {
        result.people.segmentation = cut_out(frame.depth, geometry_.from_source(std::move(*labels)));
    } else {
        // As many poses are published as frames were processed: the prediction never waits.
        result.people = people_->find(frame, [&] { return motion_.predict(frame.index, stamp, previous_stamp); });
    }
    result.slam =
        slam_.process(frame.color, result.people.segmentation.static_depth, result.people.segmentation.labels);
    add_undistortion_time(frame, result.slam);
    motion_.publish({stamp, result.slam.T_world_tracked, result.slam.T_world_camera});
    stamps_.push_back(stamp);
    return result;
}

Trajectory FrameByFrame::trajectory() const {
    const std::vector<Eigen::Isometry3d> poses = slam_.trajectory();
    Trajectory trajectory;
    for (std::size_t i = 0; i < stamps_.size() && i < poses.size(); ++i) trajectory.push_back({stamps_[i], poses[i]});
    return trajectory;
}

}  // namespace posefusion
