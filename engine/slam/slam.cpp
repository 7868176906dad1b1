#include "engine/slam/slam.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/error.hpp"
#include "engine/map/surfel_map.hpp"
#include "engine/preprocess/preprocessing.hpp"
#include "engine/slam/params.hpp"
#include "engine/tracking/tracker.hpp"
#include "engine/vulkan/shared_types.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

constexpr int kMinSize = 16;             // pixels: the coarsest level still has neighbours
gpu::Pose to_device(const Eigen::Isometry3d& T) {
    const Eigen::Matrix4f m = T.matrix().cast<float>();
    const auto row = [&](int i) { return gpu::vec4{m(i, 0), m(i, 1), m(i, 2), m(i, 3)}; };
    return {row(0), row(1), row(2)};
}

Eigen::Isometry3d from_device(const gpu::Pose& pose) {
    Eigen::Matrix<double, 3, 4> m;
    m << pose.row0.x, pose.row0.y, pose.row0.z, pose.row0.w, pose.row1.x, pose.row1.y, pose.row1.z, pose.row1.w, pose.row2.x,
        pose.row2.y, pose.row2.z, pose.row2.w;
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = Eigen::Quaterniond(m.leftCols<3>()).normalized().toRotationMatrix();  // float rounding leaves SO(3)
    T.translation() = m.col(3);
    return T;
}

Eigen::Matrix<double, 6, 6> covariance_of(const gpu::TrackingRecord& record) {
    Eigen::Matrix<double, 6, 6> H;
    int k = 0;
    for (int i = 0; i < 6; ++i) {
        for (int j = i; j < 6; ++j) H(i, j) = H(j, i) = static_cast<double>(record.hessian[k++]);
    }
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> ldlt(H);
    return ldlt.isPositive() ? ldlt.solve(Eigen::Matrix<double, 6, 6>::Identity()).eval() : Eigen::Matrix<double, 6, 6>::Zero().eval();
}

void check_size(int width, int height, const Intrinsics& camera, const char* what) {
    if (width == camera.width && height == camera.height) return;
    throw Error(std::string("the ") + what + " image is " + std::to_string(width) + "x" + std::to_string(height) + " but the camera is " +
                std::to_string(camera.width) + "x" + std::to_string(camera.height) + "; mend the image or the camera file");
}

const Intrinsics& checked(const Intrinsics& camera) {
    if (!camera.valid()) throw Error("camera: width, height, fx and fy must be positive; mend the camera file");
    for (const float value : {camera.fx, camera.fy, camera.cx, camera.cy}) {
        if (!std::isfinite(value)) throw Error("camera: fx, fy, cx and cy must be finite numbers; mend the camera file");
    }
    if (camera.width % 4 != 0 || camera.height % 4 != 0) {
        throw Error("camera: images of " + std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                    " cannot be used, width and height must be multiples of 4; crop or scale them");
    }
    if (camera.width < kMinSize || camera.height < kMinSize) {
        throw Error("camera: images of " + std::to_string(camera.width) + "x" + std::to_string(camera.height) + " are too small, at least " +
                    std::to_string(kMinSize) + " pixels are needed either way; use a larger --scale");
    }
    return camera;
}

}  // namespace

struct Slam::Impl {
    Intrinsics camera;
    SlamConfig config;
    Context context;
    Buffer host_params, params, view_params;
    PyramidBuilder pyramids;
    Preprocessing frame;
    Tracker tracker;
    SurfelMap map;
    ImagePyramid model;
    Buffer model_color;
    Buffer host_record, host_counters;  ///< results of a frame
    Buffer host_view_record, view_record;
    std::unique_ptr<Sequence> first_frame, next_frame;
    std::uint32_t frames = 0;

    Impl(const Intrinsics& intrinsics, const SlamConfig& slam_config, const std::string& device)
        : camera(checked(intrinsics)),
          config(slam_config),
          context({device, slam_config.validation, slam_config.int64_atomics}),
          host_params(host_buffer<gpu::Params>(context, 1, "host parameters")),
          params(device_buffer<gpu::Params>(context, 1, "parameters")),
          view_params(host_buffer<gpu::Params>(context, 1, "view parameters")),
          pyramids(context, camera, config.preprocess),
          frame(context, camera, config.preprocess),
          tracker(context, camera, config.tracking),
          map(context, camera, config.map),
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

    /// One frame, as the paper's step 3 has it.
    void record(Sequence& sequence, bool is_first) const {
        sequence.stage("preprocess");
        sequence.copy(host_params, params, sizeof(gpu::Params));
        frame.record(sequence, params, pyramids);
        if (!is_first) tracker.record_frame(sequence, params, frame.live, model);
        map.record_fusion(sequence, params, tracker.record, frame);
        map.record_prediction(sequence, params, tracker.record, frame, true, model, model_color);
        sequence.stage("model pyramid");
        pyramids.record_model(sequence, params, model);
        tracker.record_keep_live(sequence, frame.live);
        sequence.copy(tracker.record, host_record, sizeof(gpu::TrackingRecord));
        sequence.copy(map.counters(), host_counters, sizeof(gpu::MapRecord));
        sequence.finish();
    }

    Sequence& sequence_for_next_frame() {
        if (map.make_room()) first_frame.reset(), next_frame.reset();
        auto& sequence = frames == 0 ? first_frame : next_frame;
        if (!sequence) {
            sequence = std::make_unique<Sequence>(context);
            record(*sequence, frames == 0);
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
    }
};

Slam::Slam(const Intrinsics& camera, const SlamConfig& config, const std::string& device)
    : impl_(std::make_unique<Impl>(camera, config, device)) {}
Slam::~Slam() = default;
Slam::Slam(Slam&&) noexcept = default;
Slam& Slam::operator=(Slam&&) noexcept = default;

FrameResult Slam::process(const ColorImage& color, const DepthImage& depth, const LabelImage& labels) {
    Impl& s = *impl_;
    check_size(color.width(), color.height(), s.camera, "colour");
    check_size(depth.width(), depth.height(), s.camera, "depth");
    if (!labels.empty()) check_size(labels.width(), labels.height(), s.camera, "label");

    s.upload(color, depth, labels);
    Sequence& sequence = s.sequence_for_next_frame();
    sequence.run();

    const auto& record = s.host_record.host<gpu::TrackingRecord>()[0];
    const auto& counters = s.host_counters.host<gpu::MapRecord>()[0];
    s.map.update(counters.count, counters.alive);

    FrameResult result;
    result.T_world_camera = from_device(record.world_live);
    if (s.frames > 0) {
        result.tracking = record.failed ? TrackingState::Failed : TrackingState::Ok;
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
    ++s.frames;
    return result;
}

std::vector<Surfel> Slam::surfels(bool stable_only) const {
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
    s.map.record_prediction(sequence, s.view_params, s.view_record, s.frame, false, view, color);
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

const DeviceInfo& Slam::device() const { return impl_->context.info(); }

}  // namespace posefusion
