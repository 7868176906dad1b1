#include "engine/slam/slam.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <span>
#include <sstream>

#include "engine/core/error.hpp"
#include "engine/loops/back_end.hpp"
#include "engine/map/surfel_map.hpp"
#include "engine/preprocess/preprocessing.hpp"
#include "engine/slam/map_snapshot.hpp"
#include "engine/slam/params.hpp"
#include "engine/slam/pose_conversion.hpp"
#include "engine/slam/slam_state.hpp"
#include "engine/tracking/tracker.hpp"
#include "engine/vulkan/shared_types.hpp"
#include "engine/vulkan/transfer.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

constexpr int kMinSize = 16;  // pixels: the coarsest level still has neighbours

void check_size(int width, int height, const Intrinsics& camera, const char* what) {
    if (width == camera.width && height == camera.height) return;
    throw Error(std::string("the ") + what + " image is " + std::to_string(width) + "x" + std::to_string(height) +
                " but the camera is " + std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                "; mend the image or the camera file");
}

const Intrinsics& checked(const Intrinsics& camera) {
    if (!camera.valid()) throw Error("camera: width, height, fx and fy must be positive; mend the camera file");
    for (const float value : {camera.fx, camera.fy, camera.cx, camera.cy}) {
        if (!std::isfinite(value))
            throw Error("camera: fx, fy, cx and cy must be finite numbers; mend the camera file");
    }
    if (camera.width % 4 != 0 || camera.height % 4 != 0) {
        throw Error("camera: images of " + std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                    " cannot be used, width and height must be multiples of 4; crop or scale them");
    }
    if (camera.width < kMinSize || camera.height < kMinSize) {
        throw Error("camera: images of " + std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                    " are too small, at least " + std::to_string(kMinSize) +
                    " pixels are needed either way; use a larger --scale");
    }
    return camera;
}

std::string text_of(const Intrinsics& camera) {
    std::ostringstream text;
    text << camera.width << 'x' << camera.height << " with fx " << camera.fx << ", fy " << camera.fy << ", cx "
         << camera.cx << ", cy " << camera.cy;
    return text.str();
}

const SlamConfig& checked(const SlamConfig& config) {
    if (config.tracking.full_resolution_step < 1 || config.tracking.full_resolution_step > 2) {
        throw Error("tracking.full_resolution_step is " + std::to_string(config.tracking.full_resolution_step) +
                    ", it must be 1 or 2");
    }
    if (config.map.index_map_scale < 1 || config.map.index_map_scale > 8) {
        throw Error("map.index_map_scale is " + std::to_string(config.map.index_map_scale) + ", it must be 1 to 8");
    }
    return config;
}

}  // namespace

struct Slam::Impl {
    Intrinsics camera;
    SlamConfig config;
    std::shared_ptr<Context> shared_context;
    Context& context;
    Buffer host_params, params, view_params;
    PyramidBuilder pyramids;
    Preprocessing frame;
    Tracker tracker;
    SurfelMap map;
    BackEnd back_end;
    ImagePyramid model;
    Buffer model_color;
    Buffer host_record, host_counters;  ///< results of a frame
    Buffer host_view_record, view_record;
    std::unique_ptr<Sequence> first_frame, next_frame, prediction;
    std::uint32_t frames = 0;

    Impl(const Intrinsics& intrinsics, const SlamConfig& slam_config, std::shared_ptr<Context> device_context)
        : camera(checked(intrinsics)),
          config(checked(slam_config)),
          shared_context(std::move(device_context)),
          context(*shared_context),
          host_params(host_buffer<gpu::Params>(context, 1, "host parameters")),
          params(device_buffer<gpu::Params>(context, 1, "parameters")),
          view_params(host_buffer<gpu::Params>(context, 1, "view parameters")),
          pyramids(context, camera, config.preprocess),
          frame(context, camera, config.preprocess),
          tracker(context, camera, config.tracking),
          map(context, camera, config.map),
          back_end(context, camera, config),
          model(context, camera, "model"),
          model_color(device_buffer<std::uint32_t>(context, pixels_at(camera, 0), "model colour")),
          host_record(host_buffer<gpu::TrackingRecord>(context, 1, "host tracking record")),
          host_counters(host_buffer<gpu::MapRecord>(context, 1, "host map counters")),
          host_view_record(host_buffer<gpu::TrackingRecord>(context, 1, "host view record")),
          view_record(device_buffer<gpu::TrackingRecord>(context, 1, "view record")) {
        host_params.host<gpu::Params>()[0] = make_params(camera, config);
        view_params.host<gpu::Params>()[0] = make_params(camera, config);
        // before the first frame: camera at the world's origin, nothing failed, full weight
        gpu::TrackingRecord start{};
        start.world_live = start.world_model = start.model_live = to_device(Eigen::Isometry3d::Identity());
        start.fusion_weight = 1;
        host_record.host<gpu::TrackingRecord>()[0] = start;
        Sequence sequence(context);
        sequence.copy(host_record, tracker.record, sizeof(start));
        sequence.finish();
        sequence.run();
    }

    /// What the next frame is tracked against: the active model from the current pose.
    void enqueue_model(Sequence& sequence) const {
        sequence.stage("predict");
        map.enqueue_prediction(sequence, params, tracker.record, frame, true, model, model_color);
        sequence.stage("model pyramid");
        pyramids.enqueue_model(sequence, params, model);
    }

    /// One frame, as the paper's step 3 has it.
    void enqueue(Sequence& sequence, bool is_first) const {
        sequence.stage("preprocess");
        sequence.copy(host_params, params, sizeof(gpu::Params));
        frame.enqueue(sequence, params, pyramids);
        if (!is_first) tracker.enqueue_frame(sequence, params, frame.live, model);
        if (!config.localise_only) map.enqueue_fusion(sequence, params, tracker.record, frame);
        enqueue_model(sequence);
        tracker.enqueue_keep_live(sequence, frame.live);
        back_end.enqueue_thumbnail(sequence, params, tracker.record, model_color, model.depth[0], frame);
        sequence.copy(tracker.record, host_record, sizeof(gpu::TrackingRecord));
        sequence.copy(map.counters(), host_counters, sizeof(gpu::MapRecord));
        sequence.finish();
    }

    /// What the tracker reads of the model.
    [[nodiscard]] std::vector<const Buffer*> tracked_model() const {
        std::vector<const Buffer*> buffers;
        for (const Buffer& buffer : model.geometry) buffers.push_back(&buffer);
        for (const Buffer& buffer : model.photometric) buffers.push_back(&buffer);
        return buffers;
    }

    void forget_recordings() {
        first_frame.reset(), next_frame.reset(), prediction.reset();
        back_end.forget_recordings();
    }

    /// The back end has moved the camera or bent the map.
    void predict_from(const Eigen::Isometry3d& T_world_camera) {
        auto& record = host_record.host<gpu::TrackingRecord>()[0];
        record.world_live = to_device(T_world_camera);
        record.failed = 0;  // the live frame may fill holes again
        if (!prediction) {
            prediction = std::make_unique<Sequence>(context);
            prediction->copy(host_record, tracker.record, sizeof(gpu::TrackingRecord));
            enqueue_model(*prediction);
            prediction->finish();
        }
        prediction->run();
    }

    Sequence& sequence_for_next_frame() {
        if (!config.localise_only && map.make_room()) forget_recordings();
        auto& sequence = frames == 0 ? first_frame : next_frame;
        if (!sequence) {
            sequence = std::make_unique<Sequence>(context);
            enqueue(*sequence, frames == 0);
        }
        return *sequence;
    }

    void upload(const ColorImage& color, const DepthImage& depth, const LabelImage& labels) {
        const auto depths = frame.host_depth.host<float>();
        const auto colors = frame.host_color.host<std::uint32_t>();
        for (std::size_t i = 0; i < depth.size(); ++i) {
            depths[i] = std::isfinite(depth[i]) ? depth[i] : 0.0f;
            const std::uint32_t label = labels.empty() ? 0u : labels[i];
            colors[i] = color[i].r | color[i].g << 8 | color[i].b << 16 | label << 24;
        }
        auto& p = host_params.host<gpu::Params>()[0];
        p.frame = frames;
        // a map of few frames holds no surfel of the final confidence yet
        p.predict_confidence = std::min(config.map.predict_confidence, 0.3f * static_cast<float>(frames));
        // while lost, the camera may come back anywhere
        const auto window = static_cast<std::uint32_t>(config.loops.time_window);
        const bool windowed = config.loops.enabled && !config.localise_only;
        p.active_since = windowed && frames > window && !back_end.lost() ? frames - window : 0;
        // after a failure a look-alike must not be taken for the place that was lost
        p.min_inlier_ratio =
            back_end.failures() > 0 ? RelocalisationConfig::kRecoverInlierRatio : config.tracking.min_inlier_ratio;
    }
};

/// What stays when the map starts anew, and what threads hand each other.
struct Slam::Shared {
    Shared(const Intrinsics& intrinsics, std::shared_ptr<Context> device_context)
        : camera(intrinsics), context(std::move(device_context)) {}

    const Intrinsics camera;
    const std::shared_ptr<Context> context;
    std::mutex busy;  ///< held while the device's buffers are used: by a frame, a copy, a reset
    std::atomic<bool> snapshot_wanted = false;
    bool snapshot_stale = false;  ///< there is a frame that is in no snapshot; under `busy`
    std::shared_ptr<SnapshotExchange> snapshots = std::make_shared<SnapshotExchange>();
    std::mutex config_mutex;
    std::optional<SlamConfig> next_config;

    void copy_snapshot(const Impl& s) {
        snapshot_stale = false;
        const std::uint32_t slots = s.map.slots();
        auto snapshot = snapshots->blank(s.shared_context, s.camera, slots);
        const auto& from = s.map.streams();
        const std::size_t bytes = std::size_t{slots} * sizeof(gpu::vec4),
                          pixels = pixels_at(s.camera, 0) * sizeof(std::uint32_t);
        Sequence sequence(s.context);
        if (slots > 0) {
            sequence.copy(from.position_confidence, snapshot->surfels.position_confidence, bytes);
            sequence.copy(from.normal_radius, snapshot->surfels.normal_radius, bytes);
            sequence.copy(from.appearance, snapshot->surfels.appearance, bytes);
        }
        sequence.copy(s.frame.color, snapshot->color, pixels);
        sequence.copy(s.frame.depth, snapshot->depth, pixels);
        sequence.copy(s.model_color, snapshot->model_color, pixels);
        sequence.copy(s.model.depth[0], snapshot->model_depth, pixels);
        sequence.finish();
        sequence.run();
        snapshot->slots = slots;
        snapshot->frame = s.frames - 1;
        snapshots->offer(std::move(snapshot));
    }

    void take_over_config(Impl& s) {
        const std::lock_guard lock(config_mutex);
        if (!next_config) return;
        next_config->localise_only = s.config.localise_only;  // is part of what was recorded
        s.config = *next_config;
        next_config.reset();
        s.host_params.host<gpu::Params>()[0] = make_params(s.camera, s.config);
        s.view_params.host<gpu::Params>()[0] = make_params(s.camera, s.config);
    }
};

Slam::Slam(const Intrinsics& camera, const SlamConfig& config, const std::string& device, const DeviceSharing& sharing)
    : shared_(std::make_unique<Shared>(
          checked(camera),
          std::make_shared<Context>(ContextOptions{device, config.validation, config.int64_atomics, sharing}))),
      impl_(std::make_unique<Impl>(camera, config, shared_->context)) {}
Slam::~Slam() = default;
Slam::Slam(Slam&&) noexcept = default;
Slam& Slam::operator=(Slam&&) noexcept = default;

FrameResult Slam::process(const ColorImage& color, const DepthImage& depth, const LabelImage& labels) {
    const std::lock_guard lock(shared_->busy);
    Impl& s = *impl_;
    check_size(color.width(), color.height(), s.camera, "colour");
    check_size(depth.width(), depth.height(), s.camera, "depth");
    if (!labels.empty()) check_size(labels.width(), labels.height(), s.camera, "label");
    if (s.config.localise_only && s.frames == 0) throw Error("localise_only needs a map; restore one first");

    shared_->take_over_config(s);
    s.upload(color, depth, labels);
    Sequence& sequence = s.sequence_for_next_frame();
    sequence.run();

    const auto& record = s.host_record.host<gpu::TrackingRecord>()[0];
    const auto& counters = s.host_counters.host<gpu::MapRecord>()[0];
    s.map.update(counters.count, counters.alive);

    FrameResult result;
    Matrix6d information = Matrix6d::Zero();
    if (s.frames > 0) {
        if (record.failed == 0) information = information_of(record);
        result.covariance = covariance_of(record);
        result.icp_inliers = record.icp_inliers;
        result.photometric_inliers = record.photometric_inliers;
        result.icp_rmse_m = record.icp_rmse;
        result.photometric_rmse = record.photometric_rmse;
        result.valid_pixels = record.valid_pixels;
        result.iterations = static_cast<int>(record.iterations);
    }
    result.surfels = counters.alive;
    result.stable_surfels = counters.stable;
    result.device_bytes = s.context.allocated_bytes();
    for (const auto& time : sequence.times()) result.gpu_times.push_back({time.stage, time.milliseconds});

    result.T_world_tracked = from_device(record.world_live);
    BackEnd::Outcome outcome =
        s.back_end.after_frame({s.host_params.host<gpu::Params>()[0], result.T_world_tracked, information,
                                record.failed != 0, counters.inactive_in_view, s.frame, s.pyramids, s.map});
    if (outcome.moved) s.predict_from(outcome.T_world_camera);
    result.T_world_camera = outcome.T_world_camera;
    result.tracking = outcome.state;
    result.loops = std::move(outcome.events);
    result.keyframes = static_cast<std::uint32_t>(s.back_end.places().keyframes().size());
    ++s.frames;
    shared_->snapshot_stale = true;
    if (shared_->snapshot_wanted.exchange(false)) shared_->copy_snapshot(s);
    return result;
}

SlamState Slam::state() const {
    const std::lock_guard lock(shared_->busy);
    Impl& s = *impl_;
    SlamState state;
    state.camera = s.camera;
    state.frames = s.frames;
    state.map = s.map.state();
    state.tracking.record = read_back(s.context, s.tracker.record, sizeof(gpu::TrackingRecord));
    state.tracking.previous_live = read_back(s.context, s.tracker.previous_live(), s.tracker.previous_live().bytes());
    for (const Buffer* buffer : s.tracked_model()) {
        const ByteArray values = read_back(s.context, *buffer, buffer->bytes());
        state.tracking.model.insert(state.tracking.model.end(), values.begin(), values.end());
    }
    state.back_end = s.back_end.state();
    return state;
}

void Slam::restore(const SlamState& state) {
    const std::lock_guard lock(shared_->busy);
    Impl& s = *impl_;
    const Intrinsics &is = s.camera, &was = state.camera;
    if (is != was) {
        throw Error("the map was made with another camera: " + text_of(was) + ", not " + text_of(is) +
                    "; use that camera and the same --scale");
    }
    std::size_t model_bytes = 0;
    for (const Buffer* buffer : s.tracked_model()) model_bytes += buffer->bytes();
    const TrackerState& tracking = state.tracking;
    if (tracking.record.size() != sizeof(gpu::TrackingRecord) ||
        tracking.previous_live.size() != s.tracker.previous_live().bytes() || tracking.model.size() != model_bytes ||
        state.back_end.trajectory.size() != state.frames || state.back_end.information.size() != state.frames) {
        throw Error("the map to be restored contradicts itself; use another file");
    }
    s.map.check(state.map);
    s.back_end.restore(state.back_end);
    s.forget_recordings();
    s.map.restore(state.map);
    s.frames = state.frames;
    write(s.context, tracking.record, s.tracker.record);
    write(s.context, tracking.previous_live, s.tracker.previous_live());
    std::copy(tracking.record.begin(), tracking.record.end(), s.host_record.host<std::byte>().begin());
    std::copy(state.map.counters.begin(), state.map.counters.end(), s.host_counters.host<std::byte>().begin());
    std::span<const std::byte> rest(tracking.model);
    for (const Buffer* buffer : s.tracked_model()) {
        write(s.context, rest.first(buffer->bytes()), *buffer);
        rest = rest.subspan(buffer->bytes());
    }
}

void Slam::lose_camera() {
    const std::lock_guard lock(shared_->busy);
    impl_->back_end.lose_camera();
}

std::vector<Eigen::Isometry3d> Slam::trajectory() const {
    const std::lock_guard lock(shared_->busy);
    return impl_->back_end.trajectory();
}

std::vector<std::uint32_t> Slam::keyframes() const {
    const std::lock_guard lock(shared_->busy);
    std::vector<std::uint32_t> frames;
    for (const Keyframe& keyframe : impl_->back_end.places().keyframes()) frames.push_back(keyframe.frame);
    return frames;
}

std::optional<LoopGraph> Slam::loop_graph() const {
    const std::lock_guard lock(shared_->busy);
    return impl_->back_end.loop_graph();
}

std::vector<Surfel> Slam::surfels(bool stable_only) const {
    const std::lock_guard lock(shared_->busy);
    Impl& s = *impl_;
    const std::uint32_t slots = s.map.slots();
    if (slots == 0) return {};
    const auto& streams = s.map.streams();
    Context& context = s.context;
    const std::size_t bytes = std::size_t{slots} * sizeof(gpu::vec4);
    const Buffer positions = host_buffer<gpu::vec4>(context, slots, "positions read back");
    const Buffer normals = host_buffer<gpu::vec4>(context, slots, "normals read back");
    const Buffer appearances = host_buffer<gpu::vec4>(context, slots, "appearances read back");
    Sequence sequence(context);
    sequence.copy(streams.position_confidence, positions, bytes);
    sequence.copy(streams.normal_radius, normals, bytes);
    sequence.copy(streams.appearance, appearances, bytes);
    sequence.finish();
    sequence.run();

    const auto p = positions.host<gpu::vec4>();
    const auto n = normals.host<gpu::vec4>();
    const auto a = appearances.host<std::uint32_t>();
    const float least = stable_only ? s.config.map.stable_confidence : 0.0f;
    const auto to_byte = [](std::uint32_t unorm16) { return static_cast<std::uint8_t>((unorm16 & 0xffff) / 257); };
    std::vector<Surfel> surfels;
    for (std::uint32_t i = 0; i < slots; ++i) {
        if (p[i].w <= 0 || p[i].w < least) continue;
        const std::uint32_t* look = &a[std::size_t{i} * 4];
        surfels.push_back({{p[i].x, p[i].y, p[i].z},
                           {n[i].x, n[i].y, n[i].z},
                           {to_byte(look[0]), to_byte(look[0] >> 16), to_byte(look[1])},
                           n[i].w,
                           p[i].w,
                           look[2],
                           look[3]});
    }
    return surfels;
}

ModelView Slam::render(const Eigen::Isometry3d& T_world_camera) const {
    const std::lock_guard lock(shared_->busy);
    Impl& s = *impl_;
    s.view_params.host<gpu::Params>()[0].predict_confidence = s.config.map.stable_confidence;
    auto& record = s.host_view_record.host<gpu::TrackingRecord>()[0];
    record = {};
    record.world_live = to_device(T_world_camera);
    const std::uint32_t n = pixels_at(s.camera, 0);
    const ImagePyramid view(s.context, s.camera, "view");
    const Buffer color = device_buffer<std::uint32_t>(s.context, n, "view colour");
    const Buffer host_color = host_buffer<std::uint32_t>(s.context, n, "view colour read back");
    const Buffer host_depth = host_buffer<float>(s.context, n, "view depth read back");
    Sequence sequence(s.context);
    sequence.copy(s.host_view_record, s.view_record, sizeof(gpu::TrackingRecord));
    s.map.enqueue_prediction(sequence, s.view_params, s.view_record, s.frame, false, view, color);
    sequence.copy(color, host_color, n * sizeof(std::uint32_t));
    sequence.copy(view.depth[0], host_depth, n * sizeof(float));
    sequence.finish();
    sequence.run();

    ModelView result{ColorImage(s.camera.width, s.camera.height), DepthImage(s.camera.width, s.camera.height)};
    const auto colors = host_color.host<std::uint32_t>();
    std::copy_n(host_depth.host<float>().data(), n, result.depth.data());
    for (std::uint32_t i = 0; i < n; ++i) {
        result.color[i] = {static_cast<std::uint8_t>(colors[i]), static_cast<std::uint8_t>(colors[i] >> 8),
                           static_cast<std::uint8_t>(colors[i] >> 16)};
    }
    return result;
}

void Slam::set_config(const SlamConfig& config) {
    const std::lock_guard lock(shared_->config_mutex);
    shared_->next_config = checked(config);
}

void Slam::reset() {
    const std::lock_guard lock(shared_->busy);
    shared_->take_over_config(*impl_);
    const auto context = impl_->shared_context;
    const Intrinsics camera = impl_->camera;
    const SlamConfig config = impl_->config;
    impl_.reset();  // its memory is needed for the new one
    impl_ = std::make_unique<Impl>(camera, config, context);
    shared_->snapshot_stale = false;
    shared_->snapshots->clear();
}

std::shared_ptr<const MapSnapshot> Slam::snapshot() {
    shared_->snapshot_wanted = true;
    if (const std::unique_lock idle(shared_->busy, std::try_to_lock); idle && shared_->snapshot_stale) {
        shared_->snapshot_wanted = false;
        shared_->copy_snapshot(*impl_);
    }
    return shared_->snapshots->take();
}

std::shared_ptr<Context> Slam::context() const { return shared_->context; }
const DeviceInfo& Slam::device() const { return shared_->context->info(); }
const Intrinsics& Slam::camera() const { return shared_->camera; }
std::uint32_t Slam::validation_messages() const { return shared_->context->validation_messages(); }

}  // namespace posefusion
