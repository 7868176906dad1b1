#include "engine/tracking/tracker.hpp"

#include "engine/vulkan/shared_types.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

// shaders/include/reduction.glsl
constexpr std::uint32_t kPixelsPerGroup = 64 * 16;
constexpr std::uint32_t kMaxRowsPerGroup = 64;
constexpr std::uint32_t kColumns = 36;

// Slots of the dispatch arguments: pairs of (reduce, solve).
constexpr std::uint32_t kSo3Slot = 0;
constexpr std::uint32_t level_slot(int level) { return 2 + 2 * static_cast<std::uint32_t>(level); }
constexpr std::uint32_t kSlots = 2 + 2 * kLevels;

struct BeginPush {
    std::uint32_t so3_groups, level_groups[kLevels];
};
struct LevelPush {
    std::uint32_t level;
};
struct ReducePush {
    std::uint32_t level, step;
};
struct SolvePush {
    std::uint32_t groups, slot;
};
struct TrackSolvePush {
    std::uint32_t groups, slot, step;
};

}  // namespace

Tracker::Tracker(Context& context, const Intrinsics& camera, const TrackingConfig& config)
    : record(device_buffer<gpu::TrackingRecord>(context, 1, "tracking record")),
      camera_(camera),
      config_(config),
      previous_(device_buffer<gpu::vec4>(context, pixels_at(camera, kSo3Level), "previous live photometric")),
      rows_(device_buffer<float>(
          context, Groups::covering(pixels_at(camera, 0), kPixelsPerGroup).x * kMaxRowsPerGroup * kColumns, "rows")),
      row_counts_(device_buffer<std::uint32_t>(context, Groups::covering(pixels_at(camera, 0), kPixelsPerGroup).x,
                                               "row counts")),
      arguments_(device_buffer<gpu::DispatchArguments>(context, kSlots, "tracking dispatch arguments")),
      begin_(context, "tracking/track_begin", 3, sizeof(BeginPush)),
      so3_reduce_(context, "tracking/so3_reduce", 6, sizeof(LevelPush)),
      so3_solve_(context, "tracking/so3_solve", 5, sizeof(SolvePush)),
      reduce_(context, "tracking/track_reduce", 8, sizeof(ReducePush)),
      solve_(context, "tracking/track_solve", 5, sizeof(TrackSolvePush)),
      end_(context, "tracking/track_end", 2) {}

void Tracker::enqueue_frame(Sequence& sequence, const Buffer& params, const ImagePyramid& live,
                            const ImagePyramid& model) const {
    const auto step = [&](int level) {
        return level == 0 ? static_cast<std::uint32_t>(config_.full_resolution_step) : 1u;
    };
    const auto groups = [&](int level) {
        return Groups::covering(pixels_at(camera_, level) / step(level), kPixelsPerGroup).x;
    };

    sequence.stage("so3");
    sequence.dispatch(begin_, {in(params), inout(record), out(arguments_)},
                      BeginPush{groups(kSo3Level), {groups(0), groups(1), groups(2)}}, 1);
    for (int i = 0; i < config_.so3_iterations; ++i) {
        sequence.dispatch_indirect(
            so3_reduce_,
            {in(params), in(live.photometric[kSo3Level]), in(previous_), in(record), out(rows_), out(row_counts_)},
            LevelPush{kSo3Level}, arguments_, kSo3Slot);
        sequence.dispatch_indirect(so3_solve_,
                                   {in(params), in(rows_), in(row_counts_), inout(record), inout(arguments_)},
                                   SolvePush{groups(kSo3Level), kSo3Slot}, arguments_, kSo3Slot + 1);
    }
    sequence.copy(record, record, sizeof(gpu::Pose), offsetof(gpu::TrackingRecord, so3_best),
                  offsetof(gpu::TrackingRecord, model_live));

    for (int level = kLevels - 1; level >= 0; --level) {
        sequence.stage("track level " + std::to_string(level));
        for (int i = 0; i < config_.iterations[level]; ++i) {
            sequence.dispatch_indirect(
                reduce_,
                {in(params), in(live.geometry[level]), in(live.photometric[level]), in(model.geometry[level]),
                 in(model.photometric[level]), in(record), out(rows_), out(row_counts_)},
                ReducePush{static_cast<std::uint32_t>(level), step(level)}, arguments_, level_slot(level));
            sequence.dispatch_indirect(
                solve_, {in(params), in(rows_), in(row_counts_), inout(record), inout(arguments_)},
                TrackSolvePush{groups(level), level_slot(level), step(level)}, arguments_, level_slot(level) + 1);
        }
    }
    sequence.dispatch(end_, {in(params), inout(record)}, 1);
}

void Tracker::enqueue_keep_live(Sequence& sequence, const ImagePyramid& live) const {
    sequence.copy(live.photometric[kSo3Level], previous_, pixels_at(camera_, kSo3Level) * sizeof(gpu::vec4));
}

}  // namespace posefusion
