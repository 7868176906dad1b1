#include "engine/loops/back_end.hpp"

namespace posefusion {

using namespace vulkan;

BackEnd::BackEnd(Context& context, const Intrinsics& camera, const BackEndConfig& config)
    : close_loops_(config.loops.enabled && !config.localise_only),
      relocalise_(config.relocalisation.enabled),
      localise_only_(config.localise_only),
      places_(context, camera, config.depth_max, config.loops.ferns),
      aligner_(context, camera, config.alignment, config.tracking),
      loop_closer_(context, camera, config.loops, config.deformation),
      relocaliser_(config.relocalisation, config.tracking, config.localise_only) {}

BackEnd::Outcome BackEnd::after_frame(const TrackedFrame& frame) {
    Outcome outcome;
    outcome.T_world_camera = frame.T_world_camera;
    trajectory_.push_back({frame.T_world_camera, frame.number(), frame.information});
    const FernCode code = places_.code_of_frame();
    if (frame.failed) {
        relocaliser_.count_failure();
        outcome.state = lost() ? TrackingState::Lost : TrackingState::Failed;
        if (relocalise_) find_camera(frame, code, outcome);
    } else {
        relocaliser_.count_success();
        if (frame.number() == 0) outcome.state = TrackingState::FirstFrame;
        if (close_loops_) close_loop(frame, code, outcome);
        if (!localise_only_) places_.database().add(code, outcome.T_world_camera, frame.number());
    }
    trajectory_.back().T_world_camera = outcome.T_world_camera;
    return outcome;
}

void BackEnd::find_camera(const TrackedFrame& frame, const FernCode& code, Outcome& outcome) {
    const LoopAttempt attempt = relocaliser_.find_camera(frame, code, places_.database(), aligner_);
    outcome.events.push_back(attempt.event);
    if (!attempt.event.accepted) return;
    outcome.state = TrackingState::Relocalised;
    outcome.T_world_camera = attempt.T_world_camera;
    outcome.moved = true;
}

void BackEnd::close_loop(const TrackedFrame& frame, const FernCode& code, Outcome& outcome) {
    for (const LoopAttempt& attempt : loop_closer_.close_loop(frame, code, places_.database(), aligner_, trajectory_)) {
        outcome.events.push_back(attempt.event);
        if (!attempt.event.accepted) continue;
        outcome.T_world_camera = attempt.T_world_camera;
        outcome.moved = true;
    }
}

void BackEnd::follow(const SurfelMap& map, std::span<const Eigen::Isometry3d> poses) {
    loop_closer_.follow(map, poses, trajectory_, places_.database().keyframes());
}

std::vector<Eigen::Isometry3d> BackEnd::trajectory() const {
    std::vector<Eigen::Isometry3d> poses;
    for (const GraphCamera& camera : trajectory_) poses.push_back(camera.T_world_camera);
    return poses;
}

std::optional<Eigen::Isometry3d> BackEnd::pose_before(std::uint32_t age) const {
    if (age == 0 || age > trajectory_.size()) return std::nullopt;
    const GraphCamera& camera = trajectory_[trajectory_.size() - age];
    // that of the newest frame may have been found by other means than tracking
    const bool known = age == 1 ? failures() == 0 : camera.frame == 0 || !camera.information.isZero();
    return known ? std::optional(camera.T_world_camera) : std::nullopt;
}

void BackEnd::lose_camera() {
    relocaliser_.lose_camera();
    loop_closer_.lose_camera();
}

BackEndState BackEnd::state() const {
    BackEndState state;
    state.ferns = places_.identity();
    state.keyframes = keyframes();
    state.trajectory = trajectory();
    for (const GraphCamera& camera : trajectory_) state.information.push_back(camera.information);
    state.relative_constraints = loop_closer_.correction().relative_constraints();
    state.relocalisation = relocaliser_.state();
    state.pending_loop = loop_closer_.pending();
    return state;
}

void BackEnd::restore(const BackEndState& state) {
    places_.check(state.ferns);
    places_.database().keyframes() = state.keyframes;
    trajectory_.clear();
    for (std::uint32_t frame = 0; frame < state.trajectory.size(); ++frame)
        trajectory_.push_back({state.trajectory[frame], frame, state.information[frame]});
    relocaliser_.restore(state.relocalisation);
    loop_closer_.restore(state.pending_loop, state.relative_constraints);
}

}  // namespace posefusion
