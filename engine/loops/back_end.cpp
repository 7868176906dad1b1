#include "engine/loops/back_end.hpp"

#include <algorithm>
#include <numbers>

#include "engine/core/error.hpp"
#include "engine/core/stopwatch.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

constexpr std::uint32_t kSurfelSamples = 1u << 16;  // offered to the deformation graph as nodes
constexpr std::ptrdiff_t kConstraints = 100;        // of one loop, about

LoopEvent event_of(LoopKind kind, std::uint32_t frame, const Alignment& alignment) {
    LoopEvent event;
    event.kind = kind;
    event.frame = frame;
    event.accepted = alignment.accepted;
    event.reason = alignment.reason;
    event.overlap = alignment.overlap;
    event.inlier_ratio = alignment.inlier_ratio;
    event.icp_rmse_m = alignment.icp_rmse_m;
    event.photometric_rmse = alignment.photometric_rmse;
    event.correlation = alignment.correlation;
    return event;
}

std::uint32_t median_created(const std::vector<gpu::LoopSample>& samples) {
    std::vector<std::uint32_t> created;
    for (const auto& sample : samples) {
        if (sample.valid) created.push_back(sample.created);
    }
    if (created.empty()) return 0;
    const auto middle = created.begin() + static_cast<std::ptrdiff_t>(created.size() / 2);
    std::nth_element(created.begin(), middle, created.end());
    return *middle;
}

LoopGraph loop_graph_of(const DeformationGraph& graph, std::uint32_t frame) {
    LoopGraph result;
    result.frame = frame;
    result.map_nodes = static_cast<std::uint32_t>(graph.nodes().size());
    for (const auto& nodes : {graph.nodes(), graph.cameras()}) {
        for (const GraphNode& node : nodes) result.nodes.push_back({node.position + node.t, node.t});
    }
    for (const GraphEdge& edge : graph.edges()) result.edges.push_back({edge.a, edge.b});
    for (const CameraTie& tie : graph.camera_ties()) result.edges.push_back({tie.a, tie.b});
    return result;
}

}  // namespace

BackEnd::BackEnd(Context& context, const Intrinsics& camera, const SlamConfig& config)
    : context_(context),
      camera_(camera),
      config_(config),
      places_(camera.width / FernConfig::kShrink, camera.height / FernConfig::kShrink, config.preprocess.depth_max,
              config.loops.ferns),
      aligner_(context, camera, config),
      deformer_(context),
      thumbnail_(context, "loops/thumbnail", 7, 0, {FernConfig::kShrink}),
      thumbnails_(device_buffer<std::uint64_t>(context, thumbnail_pixels(), "thumbnail")),
      host_thumbnails_(host_buffer<std::uint64_t>(context, thumbnail_pixels(), "host thumbnail")),
      surfel_samples_(device_buffer<gpu::SurfelSample>(context, kSurfelSamples, "surfel samples")),
      host_surfel_samples_(host_buffer<gpu::SurfelSample>(context, kSurfelSamples, "host surfel samples")) {}

std::uint32_t BackEnd::thumbnail_pixels() const {
    return static_cast<std::uint32_t>((camera_.width / FernConfig::kShrink) * (camera_.height / FernConfig::kShrink));
}

void BackEnd::enqueue_thumbnail(Sequence& sequence, const Buffer& params, const Buffer& record,
                                const Buffer& model_color, const Buffer& model_depth,
                                const Preprocessing& frame) const {
    sequence.dispatch(thumbnail_,
                      {in(params), in(record), in(model_color), in(model_depth), in(frame.color),
                       in(frame.static_depth), out(thumbnails_)},
                      Groups::covering(thumbnail_pixels(), 64));
    sequence.copy(thumbnails_, host_thumbnails_, thumbnails_.bytes());
}

Thumbnail BackEnd::thumbnail() const {
    struct Texel {
        std::uint32_t color;
        float depth;
    };
    Thumbnail view{camera_.width / FernConfig::kShrink, camera_.height / FernConfig::kShrink, {}};
    for (const Texel& texel : host_thumbnails_.host<Texel>()) {
        view.pixels.push_back({static_cast<std::uint8_t>(texel.color), static_cast<std::uint8_t>(texel.color >> 8),
                               static_cast<std::uint8_t>(texel.color >> 16), texel.depth});
    }
    return view;
}

BackEnd::Outcome BackEnd::after_frame(const Tracked& tracked) {
    Outcome outcome;
    outcome.T_world_camera = tracked.T_world_camera;
    information_.push_back(tracked.information);
    const FernCode code = places_.encode(thumbnail());
    if (tracked.failed) {
        ++failures_;
        outcome.state = lost() ? TrackingState::Lost : TrackingState::Failed;
        if (config_.relocalisation.enabled) relocalise(tracked, code, outcome);
    } else {
        failures_ = 0;
        found_.reset();
        if (tracked.params.frame == 0) outcome.state = TrackingState::FirstFrame;
        if (config_.loops.enabled && !config_.localise_only) close_loop(tracked, code, outcome);
        if (!config_.localise_only) places_.add(code, outcome.T_world_camera, tracked.params.frame);
    }
    trajectory_.push_back(outcome.T_world_camera);
    return outcome;
}

/// Proposals in turn: the keyframes that look most like the live image, and between them where the camera was last. One
/// that does not fit is left out for a while. A pose that fits is believed when the next frame fits close to it, too.
void BackEnd::relocalise(const Tracked& tracked, const FernCode& code, Outcome& outcome) {
    const Stopwatch watch;
    const std::uint32_t frame = tracked.params.frame;
    const bool confirming = found_.has_value();
    Eigen::Isometry3d proposal = confirming ? *found_ : tracked.T_world_camera;
    Keyframe* keyframe = nullptr;
    if (!confirming && proposal_++ % (1 + static_cast<std::uint32_t>(config_.relocalisation.proposals)) != 0) {
        const auto matches = places_.query(code, 1, frame, frame);
        if (!matches.empty()) {
            keyframe = &places_.keyframes()[matches[0].keyframe];
            proposal = keyframe->T_world_camera;
        }
    }
    const Alignment alignment = aligner_.align(tracked.params, ModelPart::Whole, RelocalisationConfig::kMinOverlap,
                                               proposal, tracked.frame, tracked.pyramids, tracked.map);
    if (keyframe && !alignment.accepted)
        keyframe->blocked_until = frame + static_cast<std::uint32_t>(RelocalisationConfig::kRetryAfter);
    LoopEvent event = event_of(LoopKind::Relocalisation, frame, alignment);
    event.model_frame = keyframe ? keyframe->frame : frame;
    found_.reset();
    if (alignment.accepted && !(confirming && is_one_step(proposal, alignment.T_world_camera))) {
        event.accepted = false;
        event.reason = "to be confirmed by the next frame";
        found_ = alignment.T_world_camera;
    }
    if (event.accepted) {
        outcome.state = TrackingState::Relocalised;
        outcome.T_world_camera = alignment.T_world_camera;
        outcome.moved = true;
        gpu::Params now = tracked.params;
        now.active_since = now.frame;  // all that is in view becomes active
        if (!config_.localise_only) aligner_.reactivate(now, tracked.map);
        failures_ = 0;
    }
    event.milliseconds = watch.milliseconds();
    outcome.events.push_back(event);
}

/// May a camera move so from one frame to the next?
bool BackEnd::is_one_step(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) const {
    const Eigen::Isometry3d step = from.inverse() * to;
    return step.translation().norm() <= static_cast<double>(config_.tracking.max_translation) &&
           Eigen::AngleAxisd(step.linear()).angle() <=
               static_cast<double>(config_.tracking.max_rotation_deg) * std::numbers::pi / 180;
}

void BackEnd::close_loop(const Tracked& tracked, const FernCode& code, Outcome& outcome) {
    const std::uint32_t frame = tracked.params.frame;
    if (tracked.params.active_since == 0 || frame % static_cast<std::uint32_t>(config_.loops.interval) != 0) return;

    const auto attempt = [&](LoopKind kind, const Eigen::Isometry3d& proposal, std::uint32_t model_frame) {
        const Stopwatch watch;
        const float least = kind == LoopKind::Local ? LoopConfig::kMinOverlap : LoopConfig::kMinOverlapElsewhere;
        const Alignment alignment = aligner_.align(tracked.params, ModelPart::Inactive, least, proposal, tracked.frame,
                                                   tracked.pyramids, tracked.map);
        LoopEvent event = event_of(kind, frame, alignment);
        event.model_frame = kind == LoopKind::Local ? median_created(alignment.samples) : model_frame;
        if (alignment.accepted && !view_is_best(alignment.overlap, frame)) {
            event.accepted = false;
            event.reason = "waiting for a better view";
        }
        if (event.accepted) event.accepted = deform(tracked, alignment, event);
        if (event.accepted) {
            aligner_.reactivate(tracked.params, tracked.map);
            outcome.T_world_camera = alignment.T_world_camera;
            outcome.moved = true;
        }
        event.milliseconds = watch.milliseconds();
        outcome.events.push_back(event);
        return event.accepted;
    };

    const float pixels = static_cast<float>(camera_.width * camera_.height);
    if (static_cast<float>(tracked.inactive_in_view) >= LoopConfig::kMinInactive * pixels &&
        attempt(LoopKind::Local, tracked.T_world_camera, 0)) {
        return;
    }
    const std::vector<FernMatch> matches = places_.query(code, 1, frame, tracked.params.active_since);
    if (matches.empty()) return;
    Keyframe& keyframe = places_.keyframes()[matches[0].keyframe];
    if (!attempt(LoopKind::Global, keyframe.T_world_camera, keyframe.frame)) {
        keyframe.blocked_until = frame + static_cast<std::uint32_t>(LoopConfig::kRetryAfter);
    }
}

bool BackEnd::view_is_best(float overlap, std::uint32_t frame) {
    const bool pending =
        pending_overlap_ > 0 && frame - pending_since_ <= static_cast<std::uint32_t>(2 * config_.loops.interval);
    const bool grows = !pending || overlap > pending_overlap_;
    if (!pending) waiting_since_ = frame;
    pending_overlap_ = overlap;
    pending_since_ = frame;
    const bool patient = frame - waiting_since_ < static_cast<std::uint32_t>(config_.loops.patience);
    const bool fair = overlap >= LoopConfig::kMinOverlapElsewhere;
    return overlap >= LoopConfig::kAmpleOverlap || (fair && !grows) || !patient;
}

FernIdentity BackEnd::fern_identity() const {
    const FernConfig& ferns = config_.loops.ferns;
    return {ferns.ferns, FernConfig::kShrink, ferns.seed, config_.preprocess.depth_max};
}

BackEndState BackEnd::state() const {
    return {fern_identity(), places_.keyframes(), trajectory_,    information_,   relative_constraints_,
            failures_,       pending_overlap_,    pending_since_, waiting_since_, found_,
            proposal_};
}

void BackEnd::restore(const BackEndState& state) {
    if (state.ferns != fern_identity()) {
        throw Error("the keyframes of the map were coded by other ferns; use its loops.ferns = " +
                    std::to_string(state.ferns.ferns) + ", loops.fern_seed = " + std::to_string(state.ferns.seed) +
                    " and preprocess.depth_max = " + std::to_string(state.ferns.depth_max));
    }
    places_.keyframes() = state.keyframes;
    trajectory_ = state.trajectory;
    information_ = state.information;
    relative_constraints_ = state.relative_constraints;
    failures_ = state.failures;
    pending_overlap_ = state.pending_overlap;
    pending_since_ = state.pending_since;
    waiting_since_ = state.waiting_since;
    found_ = state.found;
    proposal_ = state.proposal;
    loop_graph_.reset();
}

void BackEnd::lose_camera() {
    failures_ = std::max(failures_, std::max(1, config_.relocalisation.lost_after));
    pending_overlap_ = 0;
    found_.reset();
    proposal_ = 0;
}

std::vector<GraphSample> BackEnd::sample_map(const SurfelMap& map) const {
    Sequence sequence(context_);
    const std::uint32_t count = map.enqueue_surfel_samples(sequence, surfel_samples_);
    sequence.copy(surfel_samples_, host_surfel_samples_, surfel_samples_.bytes());
    sequence.finish();
    sequence.run();
    std::vector<GraphSample> samples;
    samples.reserve(count);
    for (const auto& s : host_surfel_samples_.host<gpu::SurfelSample>().first(count)) {
        if (s.position.w >= config_.map.predict_confidence)
            samples.push_back({{s.position.x, s.position.y, s.position.z}, s.created, s.last_seen});
    }
    return samples;
}

/// Metres; nullopt where tracking has failed in between, so that nobody knows.
std::optional<double> BackEnd::travelled_since(std::uint32_t frame, const Tracked& tracked) const {
    double way = 0;
    for (std::size_t k = frame + 1; k < information_.size(); ++k) {
        if (information_[k].isZero()) return std::nullopt;
        const Eigen::Isometry3d& to = k < trajectory_.size() ? trajectory_[k] : tracked.T_world_camera;
        way += (to.translation() - trajectory_[k - 1].translation()).norm();
    }
    return way;
}

bool BackEnd::deform(const Tracked& tracked, const Alignment& alignment, LoopEvent& event) {
    // the surface at `point` of the live camera is where tracking put it, and belongs where the alignment puts it
    std::vector<LoopConstraint> constraints;
    double displacement = 0;
    const auto valid =
        std::count_if(alignment.samples.begin(), alignment.samples.end(), [](const auto& s) { return s.valid != 0; });
    const std::ptrdiff_t step = std::max<std::ptrdiff_t>(1, valid / kConstraints);
    std::ptrdiff_t index = 0;
    for (const gpu::LoopSample& sample : alignment.samples) {
        if (!sample.valid || index++ % step != 0) continue;
        const Eigen::Vector3d point(static_cast<double>(sample.point.x), static_cast<double>(sample.point.y),
                                    static_cast<double>(sample.point.z));
        LoopConstraint constraint;
        constraint.source = tracked.T_world_camera * point;
        constraint.source_time = tracked.params.frame;
        constraint.target = alignment.T_world_camera * point;
        constraint.target_time = sample.created;
        constraint.by_camera = true;
        constraint.pin = true;
        displacement += (constraint.source - constraint.target).norm();
        constraints.push_back(constraint);
    }
    event.residual_before_m = event.residual_after_m =
        displacement / static_cast<double>(std::max<std::size_t>(constraints.size(), 1));
    if (event.residual_before_m < static_cast<double>(config_.loops.min_discrepancy)) return true;
    if (const auto way = travelled_since(event.model_frame, tracked)) {
        const double most =
            static_cast<double>(config_.loops.max_drift_at_rest) + static_cast<double>(config_.loops.max_drift) * *way;
        if (event.residual_before_m > most) {
            event.reason = "too far for drift, another place that looks alike";
            return false;
        }
    }

    const Stopwatch solving;
    const std::size_t own = constraints.size();
    std::vector<GraphCamera> cameras;
    for (std::uint32_t frame = 0; frame < trajectory_.size(); ++frame)
        cameras.push_back({trajectory_[frame], frame, information_[frame]});
    cameras.push_back({tracked.T_world_camera, tracked.params.frame, tracked.information});
    constraints.insert(constraints.end(), relative_constraints_.begin(), relative_constraints_.end());
    DeformationGraph graph = DeformationGraph::sample(sample_map(tracked.map), config_.deformation, cameras);
    event.nodes = static_cast<std::uint32_t>(graph.nodes().size());
    const DeformationGraph::SolveResult solution = graph.solve(constraints);
    event.residual_after_m = solution.constraint_error_after_m;
    event.solve_milliseconds = solving.milliseconds();
    if (!solution.accepted) {
        event.reason = solution.reason;
        return false;
    }

    loop_graph_ = loop_graph_of(graph, tracked.params.frame);
    const InfluenceTree tree(graph);
    event.solve_milliseconds = solving.milliseconds();
    deformer_.run(tracked.map, tree);
    for (std::uint32_t frame = 0; frame < trajectory_.size(); ++frame)
        trajectory_[frame] = graph.deform(trajectory_[frame], frame);
    for (Keyframe& keyframe : places_.keyframes())
        keyframe.T_world_camera = graph.deform(keyframe.T_world_camera, keyframe.frame);
    for (LoopConstraint& constraint : relative_constraints_) {
        constraint.source = graph.deform(constraint.source, constraint.source_time);
        constraint.target = graph.deform(constraint.target, constraint.target_time);
    }
    // what is closed stays closed
    const std::size_t spacing =
        std::max<std::size_t>(1, own / static_cast<std::size_t>(std::max(1, config_.loops.relative_constraints)));
    for (std::size_t i = spacing / 2; i < own; i += spacing) {
        LoopConstraint kept = constraints[i];
        kept.source = kept.target;
        kept.relative = true;
        kept.pin = false;
        relative_constraints_.push_back(kept);
    }
    return true;
}

}  // namespace posefusion
