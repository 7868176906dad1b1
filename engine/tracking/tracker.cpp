#include "engine/tracking/tracker.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/angle.hpp"
#include "engine/vulkan/pose_conversion.hpp"
#include "engine/vulkan/transfer.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

/// Workgroups of a reduction.
std::uint32_t groups_of(std::uint32_t pixels) { return ceil_div(pixels, gpu::REDUCTION_PIXELS_PER_GROUP); }

/// Rows of the reductions: at full resolution, and with more columns at that of the turn.
std::uint32_t floats_of_rows(const Intrinsics& camera, int turn_level) {
    return gpu::REDUCTION_MAX_ROWS * std::max(groups_of(pixels_at(camera, 0)) * gpu::REDUCTION_COLUMNS,
                                              groups_of(pixels_at(camera, turn_level)) * gpu::TURN_COLUMNS);
}

/// Slots of the dispatch arguments.
constexpr std::uint32_t reduce_slot(int level) {
    return gpu::FIRST_LEVEL_SLOT + gpu::SLOTS_PER_LEVEL * static_cast<std::uint32_t>(level);
}
constexpr std::uint32_t solve_slot(int level) { return reduce_slot(level) + 1; }

/// What tracking reads of the model.
std::vector<const Buffer*> tracked_images(const ImagePyramid& model, const Buffer& model_color) {
    std::vector<const Buffer*> buffers;
    for (const Buffer& buffer : model.geometry) buffers.push_back(&buffer);
    for (const Buffer& buffer : model.photometric) buffers.push_back(&buffer);
    buffers.push_back(&model_color);
    return buffers;
}

}  // namespace

void set_params(gpu::Params& params, const TrackingConfig& config) {
    params.icp_enabled = config.icp ? 1.0f : 0.0f;
    params.icp_max_distance = config.icp_max_distance;
    params.icp_min_cosine = std::cos(radians(TrackingConfig::kIcpMaxAngleDeg));
    params.icp_robust = config.icp_robust;
    params.photometric_weight = config.photometric ? config.photometric_weight : 0.0f;
    params.photometric_robust = TrackingConfig::kPhotometricRobust;
    params.min_gradient = config.min_gradient;
    params.converged_rotation = TrackingConfig::kConvergedRotation;
    params.converged_translation = TrackingConfig::kConvergedTranslation;
    params.min_inlier_ratio = config.min_inlier_ratio;
    params.max_icp_rmse = config.max_icp_rmse;
    params.max_translation_sigma = config.max_translation_sigma;
    params.max_rotation_sigma = config.max_rotation_sigma;
    params.max_step_translation = config.max_translation;
    params.max_step_rotation = radians(config.max_rotation_deg);
}

void expect_steady_motion(gpu::Params& params) {
    if (!(params.interval > 0)) return;
    const float sigma = TrackingConfig::kAcceleration * params.interval * params.interval;
    params.steady_floor = gpu::CORRELATED_PIXELS / (sigma * sigma);
    params.steady_share = TrackingConfig::kSteadyShare;
    params.steady_enough = TrackingConfig::kSteadyEnough;
}

gpu::TrackingRecord first_record() {
    gpu::TrackingRecord record{};
    record.world_live = record.world_model = record.model_live = to_device(Eigen::Isometry3d::Identity());
    record.exposure = gpu::vec4(1.0f);
    record.photometric_gain = 1;
    record.fusion_weight = 1;
    return record;
}

Tracker::Tracker(Context& context, const Intrinsics& camera, const TrackingConfig& config, bool rolling)
    : record(device_buffer<gpu::TrackingRecord>(context, 1, "tracking record")),
      context_(context),
      camera_(camera),
      config_(config),
      rolling_(rolling),
      previous_(device_buffer<gpu::vec4>(context, pixels_at(camera, kSo3Level), "previous live photometric")),
      rows_(device_buffer<float>(context, floats_of_rows(camera, kTurnLevel), "rows")),
      row_counts_(device_buffer<std::uint32_t>(context, groups_of(pixels_at(camera, 0)), "row counts")),
      arguments_(device_buffer<gpu::DispatchArguments>(context, gpu::TRACKING_SLOTS, "tracking dispatch arguments")),
      begin_(context, "tracking/track_begin"),
      so3_reduce_(context, "tracking/so3_reduce"),
      so3_solve_(context, "tracking/so3_solve"),
      choose_start_(context, "tracking/start_choose"),
      reduce_(context, "tracking/track_reduce", {{"ROLLING", rolling ? 1u : 0u}, {"TIMING", 0u}, {"TURN", 0u}}),
      solve_(context, "tracking/track_solve"),
      turn_reduce_(context, "tracking/track_reduce", {{"ROLLING", 1u}, {"TIMING", 0u}, {"TURN", 1u}}),
      turn_solve_(context, "tracking/turn_solve"),
      end_(context, "tracking/track_end") {}

void Tracker::enqueue_frame(Sequence& sequence, const Buffer& params, const ImagePyramid& live,
                            const ImagePyramid& model, const Buffer* start) const {
    const auto step = [&](int level) {
        return level == 0 ? static_cast<std::uint32_t>(config_.full_resolution_step) : 1u;
    };
    const auto groups = [&](int level) { return groups_of(pixels_at(camera_, level) / step(level)); };

    sequence.stage("so3");
    sequence.dispatch(begin_, {{"record", record}, {"arguments", arguments_}},
                      {{"so3_groups", groups(kSo3Level)},
                       {"level_groups[0]", groups(0)},
                       {"level_groups[1]", groups(1)},
                       {"level_groups[2]", groups(2)}},
                      1);
    for (int i = 0; i < config_.so3_iterations; ++i) {
        sequence.dispatch_indirect(so3_reduce_,
                                   {{"params", params},
                                    {"live_photometric", live.photometric[kSo3Level]},
                                    {"previous_photometric", previous_},
                                    {"record", record},
                                    {"rows", rows_},
                                    {"row_counts", row_counts_}},
                                   {{"level", kSo3Level}}, arguments_, gpu::SO3_SLOT);
        sequence.dispatch_indirect(
            so3_solve_, {{"rows", rows_}, {"row_counts", row_counts_}, {"record", record}, {"arguments", arguments_}},
            {{"groups", groups(kSo3Level)}, {"slot", gpu::SO3_SLOT}}, arguments_, gpu::SO3_SLOT + 1);
    }
    sequence.copy(record, record, sizeof(gpu::Pose), offsetof(gpu::TrackingRecord, so3_best),
                  offsetof(gpu::TrackingRecord, model_live));

    const auto images_of = [&](int level) {
        return NamedBuffers{{"params", params},
                            {"live_geometry", live.geometry[level]},
                            {"live_photometric", live.photometric[level]},
                            {"model_geometry", model.geometry[level]},
                            {"model_photometric", model.photometric[level]},
                            {"record", record},
                            {"rows", rows_},
                            {"row_counts", row_counts_}};
    };
    const auto reduce = [&](int level, std::uint32_t slot) {
        sequence.dispatch_indirect(reduce_, images_of(level), {{"level", level}, {"step", step(level)}}, arguments_,
                                   slot);
    };
    if (start != nullptr) {
        constexpr int kCoarsest = kLevels - 1;
        const NamedBuffers buffers{{"params", params}, {"rows", rows_},   {"row_counts", row_counts_},
                                   {"record", record}, {"start", *start}, {"arguments", arguments_}};
        const auto choose = [&](std::uint32_t number) {
            const NamedValues push{{"step", number}, {"groups", groups(kCoarsest)}};
            if (number == 0) {
                sequence.dispatch(choose_start_, buffers, push, 1);
            } else {
                sequence.dispatch_indirect(choose_start_, buffers, push, arguments_, gpu::START_SLOT + 1);
            }
        };
        choose(0);
        for (const std::uint32_t number : {1u, 2u}) {
            reduce(kCoarsest, gpu::START_SLOT);
            choose(number);
        }
    }

    for (int level = kLevels - 1; level >= 0; --level) {
        sequence.stage("track level " + std::to_string(level));
        for (int i = 0; i < config_.iterations[level]; ++i) {
            reduce(level, reduce_slot(level));
            sequence.dispatch_indirect(solve_,
                                       {{"params", params},
                                        {"rows", rows_},
                                        {"row_counts", row_counts_},
                                        {"record", record},
                                        {"arguments", arguments_}},
                                       {{"groups", groups(level)}, {"slot", reduce_slot(level)}, {"step", step(level)}},
                                       arguments_, solve_slot(level));
        }
        if (rolling_ && level == kTurnLevel) {
            for (int i = 0; i < kTurnSteps; ++i) {
                sequence.dispatch(turn_reduce_, images_of(level), {{"level", level}, {"step", step(level)}},
                                  groups(level));
                sequence.dispatch(
                    turn_solve_, {{"params", params}, {"rows", rows_}, {"row_counts", row_counts_}, {"record", record}},
                    {{"groups", groups(level)}, {"last", static_cast<std::uint32_t>(i + 1 == kTurnSteps)}}, 1);
            }
        }
    }
    sequence.dispatch(end_, {{"params", params}, {"record", record}}, 1);
}

void Tracker::enqueue_keep_live(Sequence& sequence, const ImagePyramid& live) const {
    sequence.copy(live.photometric[kSo3Level], previous_, pixels_at(camera_, kSo3Level) * sizeof(gpu::vec4));
}

TrackerState Tracker::state(const ImagePyramid& model, const Buffer& model_color) const {
    TrackerState state;
    state.record = read_back(context_, record, record.bytes());
    state.previous_live = read_back(context_, previous_, previous_.bytes());
    for (const Buffer* image : tracked_images(model, model_color)) {
        const ByteArray values = read_back(context_, *image, image->bytes());
        state.model.insert(state.model.end(), values.begin(), values.end());
    }
    return state;
}

TrackerState Tracker::first_state(const ImagePyramid& model, const Buffer& model_color) const {
    const gpu::TrackingRecord first = first_record();
    const auto bytes = std::as_bytes(std::span(&first, 1));
    TrackerState state;
    state.record.assign(bytes.begin(), bytes.end());
    state.previous_live.resize(previous_.bytes());
    std::size_t model_bytes = 0;
    for (const Buffer* image : tracked_images(model, model_color)) model_bytes += image->bytes();
    state.model.resize(model_bytes);
    return state;
}

bool Tracker::fits(const TrackerState& state, const ImagePyramid& model, const Buffer& model_color) const {
    std::size_t model_bytes = 0;
    for (const Buffer* image : tracked_images(model, model_color)) model_bytes += image->bytes();
    return state.record.size() == record.bytes() && state.previous_live.size() == previous_.bytes() &&
           state.model.size() == model_bytes;
}

void Tracker::restore(const TrackerState& state, const ImagePyramid& model, const Buffer& model_color) {
    write(context_, state.record, record);
    write(context_, state.previous_live, previous_);
    std::span<const std::byte> rest(state.model);
    for (const Buffer* image : tracked_images(model, model_color)) {
        write(context_, rest.first(image->bytes()), *image);
        rest = rest.subspan(image->bytes());
    }
}

}  // namespace posefusion
