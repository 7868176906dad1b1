#include "engine/objects/model_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/map/map_reader.hpp"
#include "engine/slam/params.hpp"
#include "engine/vulkan/pose_conversion.hpp"
#include "engine/vulkan/transfer.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

/// An object is seen for a second or two, by a camera that was not sent to look at it: less has to do.
constexpr float kStable = 4;
/// Light stays where it is while a thing moves through it: what varies smoothly over its surface does not move with it.
constexpr float kPhotometricWeight = 1;
constexpr int kIterations = 20;                                             // at each level, at most
constexpr unsigned kLeastCapacity = 1u << 15, kLargestCapacity = 1u << 20;  // surfels

SlamConfig of_objects(SlamConfig config) {
    config.shutter = {};
    config.tracking.so3_iterations = 0;  // there is no image before, the start is a prediction already
    config.tracking.full_resolution_step = 1;
    config.tracking.photometric_weight = std::min(config.tracking.photometric_weight, kPhotometricWeight);
    // few surfaces: along them steps are short
    for (int level = 0; level < kLevels; ++level) config.tracking.iterations[level] = kIterations;
    config.map.stable_confidence = kStable;
    config.map.initial_capacity = kLeastCapacity;
    config.map.max_capacity = kLargestCapacity;
    return config;
}

}  // namespace

ModelTracker::ModelTracker(Context& context, const Intrinsics& image, const SlamConfig& config)
    : context_(context),
      image_(image),
      window_(ObjectView::largest(image)),
      config_(of_objects(config)),
      host_params_(host_buffer<gpu::Params>(context, 1, "host parameters of objects")),
      params_(device_buffer<gpu::Params>(context, 1, "parameters of objects")),
      pyramids_(context, window_, config_.preprocess),
      images_(context, window_, config_.preprocess, config_.shutter),
      tracker_(context, window_, config_.tracking),
      predicted_(context, window_, "object"),
      predicted_color_(device_buffer<std::uint32_t>(context, pixels_at(window_, 0), "object colour")),
      host_record_(host_buffer<gpu::TrackingRecord>(context, 1, "host record of objects")),
      host_depth_(host_buffer<float>(context, pixels_at(window_, 0), "host depth of objects")),
      host_counters_(host_buffer<gpu::MapRecord>(context, 1, "host counters of objects")) {}

std::unique_ptr<ObjectModel> ModelTracker::model() {
    if (unused_.empty()) return std::make_unique<ObjectModel>(context_, window_, config_.map);
    auto model = std::move(unused_.back());
    unused_.pop_back();
    return model;
}

void ModelTracker::give_back(std::unique_ptr<ObjectModel> model) {
    if (!model) return;
    MapState empty = model->map.empty_state();
    empty.capacity = std::max<std::uint32_t>(kLeastCapacity, 2 * pixels_at(window_, 0));  // as that of a new one
    model->map.restore(empty);
    model->frames = 0;
    model->track.reset(), model->fuse.reset();
    unused_.push_back(std::move(model));
}

void ModelTracker::prepare(const ObjectModel& model, const ObjectFrame& frame,
                           const Eigen::Isometry3d& T_object_camera) {
    const ObjectView& view = frame.view;
    const auto stride = static_cast<float>(view.stride);
    gpu::Params p = make_params(image_, config_);
    p.fx = view.camera.fx, p.fy = view.camera.fy, p.cx = view.camera.cx, p.cy = view.camera.cy;
    p.width = static_cast<gpu::uint>(view.camera.width), p.height = static_cast<gpu::uint>(view.camera.height);
    p.lateral_noise /= stride;
    p.dilation = 0;  // the pixels have been chosen by their depth
    const auto diagonal = [](const Intrinsics& camera) {
        return std::hypot(static_cast<float>(camera.width), static_cast<float>(camera.height));
    };
    p.image_over_window = diagonal(image_) / (stride * diagonal(view.camera));
    p.frame = model.frames;
    p.predict_confidence = std::min(config_.map.predict_confidence, 0.3f * static_cast<float>(model.frames));
    // the caller judges by what it sees
    p.min_inlier_ratio = 0;
    p.max_step_translation = p.max_step_rotation = std::numeric_limits<float>::max();
    p.max_icp_rmse = p.max_translation_sigma = p.max_rotation_sigma = std::numeric_limits<float>::max();
    host_params_.host<gpu::Params>()[0] = p;
    auto& record = host_record_.host<gpu::TrackingRecord>()[0];
    record = first_record();
    record.world_live = to_device(T_object_camera);
    images_.upload(frame.color, frame.depth, frame.outside);
}

void ModelTracker::enqueue_frame(Sequence& sequence) const {
    sequence.stage("objects");
    sequence.copy(host_params_, params_, sizeof(gpu::Params));
    sequence.copy(host_record_, tracker_.record, sizeof(gpu::TrackingRecord));
    images_.enqueue(sequence, params_, tracker_.record, pyramids_);
}

void ModelTracker::enqueue_prediction(Sequence& sequence, const ObjectModel& model) const {
    model.map.enqueue_prediction(sequence, params_, tracker_.record, images_, false, predicted_, predicted_color_);
}

ModelTracker::Result ModelTracker::track(ObjectModel& model, const ObjectFrame& frame,
                                         const Eigen::Isometry3d& T_object_camera, const PosePrior& prior) {
    prepare(model, frame, T_object_camera);
    auto& params = host_params_.host<gpu::Params>()[0];
    params.prior_share = prior.share;
    params.prior_floor = gpu::CORRELATED_PIXELS / (prior.sigma * prior.sigma);
    params.prior_x = prior.middle.x(), params.prior_y = prior.middle.y(), params.prior_z = prior.middle.z();
    params.prior_radius = prior.radius;
    if (!model.track) {
        model.track = std::make_unique<Sequence>(context_);
        Sequence& sequence = *model.track;
        enqueue_frame(sequence);
        enqueue_prediction(sequence, model);
        pyramids_.enqueue_model(sequence, params_, predicted_);
        tracker_.enqueue_frame(sequence, params_, images_.live, predicted_);
        enqueue_prediction(sequence, model);
        sequence.copy(tracker_.record, host_record_, sizeof(gpu::TrackingRecord));
        sequence.copy(predicted_.depth[0], host_depth_, host_depth_.bytes());
        sequence.finish();
    }
    model.track->run();
    const auto& record = host_record_.host<gpu::TrackingRecord>()[0];
    Result result;
    result.T_object_camera = from_device(record.world_live);
    result.solved = record.failed == 0;
    result.inliers = std::max(record.icp_inliers, record.photometric_inliers);
    result.icp_rmse = record.icp_rmse;
    result.model_depth = DepthImage(window_.width, window_.height);
    std::copy_n(host_depth_.host<float>().data(), result.model_depth.size(), result.model_depth.data());
    return result;
}

void ModelTracker::fuse(ObjectModel& model, const ObjectFrame& frame, const Eigen::Isometry3d& T_object_camera) {
    if (model.map.make_room()) model.track.reset(), model.fuse.reset();
    prepare(model, frame, T_object_camera);
    if (!model.fuse) {
        model.fuse = std::make_unique<Sequence>(context_);
        Sequence& sequence = *model.fuse;
        enqueue_frame(sequence);
        model.map.enqueue_fusion(sequence, params_, tracker_.record, images_);
        sequence.copy(model.map.counters(), host_counters_, sizeof(gpu::MapRecord));
        sequence.finish();
    }
    model.fuse->run();
    const auto& counters = host_counters_.host<gpu::MapRecord>()[0];
    model.map.update(counters.count, counters.alive);
    ++model.frames;
}

std::vector<Surfel> ModelTracker::surfels(const ObjectModel& model, bool stable_only) const {
    return read_surfels(context_, model.map, stable_only ? kStable : 0.0f);
}

void ModelTracker::save(StateWriter& out, const ObjectModel& model) const {
    const MapState state = model.map.state();
    for (const std::uint32_t value : {state.capacity, state.slots, state.alive, model.frames}) out.put(value);
    for (const ByteArray* bytes :
         {&state.counters, &state.position_confidence, &state.normal_radius, &state.appearance}) {
        out.put(std::uint64_t{bytes->size()});
        out.raw(bytes->data(), bytes->size());
    }
}

std::unique_ptr<ObjectModel> ModelTracker::load(StateReader& in) {
    MapState state;
    auto model = this->model();
    for (std::uint32_t* value : {&state.capacity, &state.slots, &state.alive, &model->frames})
        *value = in.get<std::uint32_t>();
    for (ByteArray* bytes : {&state.counters, &state.position_confidence, &state.normal_radius, &state.appearance}) {
        const auto size = in.get<std::uint64_t>();
        in.expect(size);
        bytes->resize(size);
        in.raw(bytes->data(), bytes->size());
    }
    if (state.capacity > kLargestCapacity) in.fail();
    model->map.check(state);
    model->map.restore(state);
    model->track.reset(), model->fuse.reset();
    return model;
}

}  // namespace posefusion
