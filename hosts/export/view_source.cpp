#include "hosts/export/view_source.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "engine/core/error.hpp"
#include "engine/core/pinhole.hpp"

namespace posefusion {
namespace {

/// As recorded images show it: the nodes of a deformation are in the undistorted image.
Image<float> deformation_as_recorded(const Camera& camera) {
    const Intrinsics& K = camera.intrinsics;
    if (!camera.distorted()) return deformation_map(camera.deformation, K.width, K.height);
    if (camera.deformation.is_none()) return {};
    Image<float> map(K.width, K.height);
    for (int v = 0; v < K.height; ++v) {
        for (int u = 0; u < K.width; ++u) {
            const Eigen::Vector3f ray = pixel_ray(static_cast<float>(u), static_cast<float>(v), K);
            const PlanePoint ideal = undistort({ray.x(), ray.y()}, camera.distortion);
            const Eigen::Vector2f at = project(Eigen::Vector3f(ideal.x, ideal.y, 1), K);
            const DeformationCell cell =
                deformation_cell(static_cast<double>(at.x()), static_cast<double>(at.y()), K.width, K.height);
            double c = 0;
            for (std::size_t i = 0; i < cell.nodes.size(); ++i)
                c += cell.weights[i] * static_cast<double>(camera.deformation.nodes[cell.nodes[i]]);
            map(u, v) = static_cast<float>(c);
        }
    }
    return map;
}

}  // namespace

ViewSource::ViewSource(const FinishedRun& run, bool undistort)
    : recording_(run.recording, run.source_options()), undistort_(undistort) {
    recorded_ = run.source_options().calibrated.value_or(recording_.camera());
    recorded_.depth_scale = recording_.camera().depth_scale;
    camera_ = undistort_ ? Camera{recording_.intrinsics()} : recorded_;
    if (!undistort_) deformation_ = deformation_as_recorded(recorded_);
    margin_ = static_cast<int>(std::lround(static_cast<float>(run.config.slam.preprocess.mask_dilation) *
                                           static_cast<float>(camera_.intrinsics.width) / kReferenceWidth));
    find_frames(run);
    if (!run.saved_masks()) return;
    masks_.emplace(run.masks(), recording_);
    without_mask_ = std::erase_if(
        frames_, [&](const KnownFrame& frame) { return !masks_->has(recording_.frames()[frame.index].stamp); });
}

void ViewSource::find_frames(const FinishedRun& run) {
    std::unordered_map<Stamp::rep, std::size_t> index_of;
    for (std::size_t i = 0; i < recording_.frames().size(); ++i)
        index_of.emplace(recording_.frames()[i].stamp.count(), i);
    for (const StampedPose& pose : run.trajectory) {
        if (const auto found = index_of.find(pose.stamp.count()); found != index_of.end())
            frames_.push_back({found->second, pose.T_world_camera});
    }
    unknown_ = run.trajectory.size() - frames_.size();
    if (frames_.empty())
        throw Error(recording_.location() + ": has none of the frames of " + (run.folder / "trajectory.txt").string() +
                    "; is it another recording?");
}

LabelImage ViewSource::people_in(std::size_t i) const {
    if (!masks_) return {};
    const auto labels = masks_->load_as_recorded(recording_.frames()[frames_[i].index].stamp);
    if (!labels) return {};
    return grown(undistort_ ? recording_.labels_from_source(*labels) : *labels, margin_);
}

View ViewSource::load(std::size_t i) const {
    const KnownFrame& frame = frames_[i];
    View view;
    view.name = recording_.frames()[frame.index].stamp_text;
    view.T_world_camera = frame.T_world_camera;
    view.people = people_in(i);
    RawFrame raw = recording_.source().read(frame.index);
    view.color = std::move(raw.color);
    view.depth = to_metres(raw.depth, recorded_.depth_scale);
    if (undistort_) {
        auto images = recording_.geometry().from_source(std::move(view.color), std::move(view.depth));
        view.color = std::move(images.color);
        view.depth = std::move(images.depth);
    } else {
        undo_deformation(deformation_, view.depth);
    }
    for (std::size_t p = 0; p < view.people.size(); ++p)
        if (view.people[p] != 0) view.depth[p] = 0;
    return view;
}

}  // namespace posefusion
