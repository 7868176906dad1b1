#include "engine/slam/slam.hpp"

#include <atomic>
#include <mutex>

#include "engine/slam/atlas.hpp"
#include "engine/slam/input_checks.hpp"

namespace posefusion {

using namespace vulkan;

/// The map, and the state shared between threads.
struct Slam::Shared {
    const Intrinsics camera;
    const std::shared_ptr<Context> context;
    std::mutex busy;  ///< held while the device's buffers are used: by a frame, a copy, a reset
    std::unique_ptr<Atlas> atlas;
    std::shared_ptr<MotionJudge> judge;
    std::atomic<bool> snapshot_wanted = false;
    bool snapshot_stale = false;  ///< the newest frame is in no snapshot yet; guarded by `busy`
    const std::shared_ptr<SnapshotExchange> snapshots = std::make_shared<SnapshotExchange>();
    std::mutex config_mutex;
    std::optional<SlamConfig> next_config;

    Shared(const Intrinsics& intrinsics, const SlamConfig& config, const ContextOptions& options)
        : camera(checked(intrinsics)),
          context(std::make_shared<Context>(options)),
          atlas(std::make_unique<Atlas>(camera, config, context)) {}

    [[nodiscard]] DenseSlam& slam() const { return atlas->current(); }

    [[nodiscard]] float least_confidence(bool stable_only) const {
        return stable_only ? slam().config().map.stable_confidence : 0.0f;
    }

    void take_over_config() {
        const std::lock_guard lock(config_mutex);
        if (next_config) slam().set_config(*next_config);
        next_config.reset();
    }

    void copy_snapshot() {
        snapshot_stale = false;
        snapshots->offer(slam().snapshot(*snapshots));
    }
};

Slam::Slam(const Intrinsics& camera, const SlamConfig& config, const std::string& device, const DeviceSharing& sharing)
    : shared_(std::make_unique<Shared>(camera, config,
                                       ContextOptions{device, config.validation, config.int64_atomics, sharing})) {}
Slam::~Slam() = default;
Slam::Slam(Slam&&) noexcept = default;
Slam& Slam::operator=(Slam&&) noexcept = default;

FrameResult Slam::process(const ColorImage& color, const DepthImage& depth, const LabelImage& labels,
                          const FrameTiming& timing, std::span<const StartPose> starts) {
    const std::lock_guard lock(shared_->busy);
    shared_->take_over_config();
    FrameResult result = shared_->atlas->process(color, depth, labels, timing, starts);
    shared_->snapshot_stale = true;
    if (shared_->snapshot_wanted.exchange(false)) shared_->copy_snapshot();
    return result;
}

void Slam::set_motion_judge(std::shared_ptr<MotionJudge> judge) {
    const std::lock_guard lock(shared_->busy);
    shared_->judge = std::move(judge);
    shared_->slam().set_motion_judge(shared_->judge);
}

SlamState Slam::state() const {
    const std::lock_guard lock(shared_->busy);
    return shared_->slam().state();
}

void Slam::restore(const SlamState& state) {
    const std::lock_guard lock(shared_->busy);
    shared_->atlas->restore(state);
    if (shared_->judge) shared_->judge->restart();
}

AtlasState Slam::atlas_state() const {
    const std::lock_guard lock(shared_->busy);
    AtlasState state = shared_->atlas->state();
    if (shared_->judge) state.motion = shared_->judge->state();
    return state;
}

void Slam::restore(const AtlasState& state) {
    const std::lock_guard lock(shared_->busy);
    shared_->atlas->restore(state);
    if (!shared_->judge) return;
    if (state.motion.empty())
        shared_->judge->restart();
    else
        shared_->judge->restore(state.motion);
}

SensorTiming::Estimate Slam::sensor_timing() const {
    const std::lock_guard lock(shared_->busy);
    return shared_->slam().sensor_timing();
}

void Slam::lose_camera() {
    const std::lock_guard lock(shared_->busy);
    shared_->slam().lose_camera();
}

std::vector<Eigen::Isometry3d> Slam::trajectory() const {
    const std::lock_guard lock(shared_->busy);
    return shared_->slam().back_end().trajectory();
}

std::vector<std::uint32_t> Slam::frames() const {
    const std::lock_guard lock(shared_->busy);
    return shared_->atlas->frames();
}

std::uint32_t Slam::frames_processed() const {
    const std::lock_guard lock(shared_->busy);
    return shared_->atlas->frames_processed();
}

std::vector<MapPiece> Slam::other_pieces(bool stable_only) const {
    const std::lock_guard lock(shared_->busy);
    return shared_->atlas->other_pieces(shared_->least_confidence(stable_only));
}

void Slam::choose_main_piece() {
    const std::lock_guard lock(shared_->busy);
    shared_->atlas->choose_main_piece();
    shared_->snapshot_stale = true;
}

std::vector<std::uint32_t> Slam::keyframes() const {
    const std::lock_guard lock(shared_->busy);
    std::vector<std::uint32_t> frames;
    for (const Keyframe& keyframe : shared_->slam().back_end().keyframes()) frames.push_back(keyframe.frame);
    return frames;
}

void Slam::follow(std::span<const Eigen::Isometry3d> T_world_camera) {
    const std::lock_guard lock(shared_->busy);
    shared_->slam().follow(T_world_camera);
    shared_->snapshot_stale = true;
}

std::optional<LoopGraph> Slam::loop_graph() const {
    const std::lock_guard lock(shared_->busy);
    return shared_->atlas->loop_graph();
}

std::vector<Surfel> Slam::surfels(bool stable_only) const {
    const std::lock_guard lock(shared_->busy);
    return shared_->slam().surfels(shared_->least_confidence(stable_only));
}

ModelView Slam::render(const Eigen::Isometry3d& T_world_camera) const {
    const std::lock_guard lock(shared_->busy);
    return shared_->slam().render(T_world_camera);
}

void Slam::set_config(const SlamConfig& config) {
    const std::lock_guard lock(shared_->config_mutex);
    shared_->next_config = checked(config);
}

void Slam::reset() {
    const std::lock_guard lock(shared_->busy);
    shared_->take_over_config();
    const SlamConfig config = shared_->slam().config();
    shared_->atlas.reset();  // its memory is needed for the new one
    shared_->atlas = std::make_unique<Atlas>(shared_->camera, config, shared_->context);
    shared_->slam().set_motion_judge(shared_->judge);
    shared_->snapshot_stale = false;
    shared_->snapshots->clear();
}

std::shared_ptr<const MapSnapshot> Slam::snapshot() {
    shared_->snapshot_wanted = true;
    if (const std::unique_lock idle(shared_->busy, std::try_to_lock); idle && shared_->snapshot_stale) {
        shared_->snapshot_wanted = false;
        shared_->copy_snapshot();
    }
    return shared_->snapshots->take();
}

std::shared_ptr<Context> Slam::context() const { return shared_->context; }
const DeviceInfo& Slam::device() const { return shared_->context->info(); }
const Intrinsics& Slam::camera() const { return shared_->camera; }
std::uint32_t Slam::validation_messages() const { return shared_->context->validation_messages(); }

}  // namespace posefusion
