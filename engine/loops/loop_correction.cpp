#include "engine/loops/loop_correction.hpp"

#include <algorithm>

#include "engine/core/stopwatch.hpp"

namespace posefusion {

namespace {

constexpr std::ptrdiff_t kConstraints = 100;  // of one loop, about

/// The surface at a sample of the live camera lies where tracking placed it, and belongs where the alignment places it.
std::vector<LoopConstraint> constraints_of(const TrackedFrame& frame, const Alignment& alignment) {
    std::vector<LoopConstraint> constraints;
    const auto valid =
        std::count_if(alignment.samples.begin(), alignment.samples.end(), [](const auto& s) { return s.valid != 0; });
    const std::ptrdiff_t step = std::max<std::ptrdiff_t>(1, valid / kConstraints);
    std::ptrdiff_t index = 0;
    for (const gpu::LoopSample& sample : alignment.samples) {
        if (!sample.valid || index++ % step != 0) continue;
        const Eigen::Vector3d point = Eigen::Vector3f(sample.point.x, sample.point.y, sample.point.z).cast<double>();
        LoopConstraint constraint;
        constraint.source = frame.T_world_camera * point;
        constraint.source_time = frame.number();
        constraint.target = alignment.T_world_camera * point;
        constraint.target_time = sample.created;
        constraint.by_camera = true;
        constraint.pin = true;
        constraints.push_back(constraint);
    }
    return constraints;
}

double mean_displacement(const std::vector<LoopConstraint>& constraints) {
    double sum = 0;
    for (const LoopConstraint& constraint : constraints) sum += (constraint.source - constraint.target).norm();
    return sum / static_cast<double>(std::max<std::size_t>(constraints.size(), 1));
}

/// Distance travelled from frame `since` to the last one, metres; nullopt (unknown) where tracking failed in between.
std::optional<double> distance_travelled(std::uint32_t since, const std::vector<GraphCamera>& trajectory) {
    double way = 0;
    for (std::size_t k = since + 1; k < trajectory.size(); ++k) {
        if (trajectory[k].information.isZero()) return std::nullopt;
        way += (trajectory[k].T_world_camera.translation() - trajectory[k - 1].T_world_camera.translation()).norm();
    }
    return way;
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

LoopCorrection::LoopCorrection(vulkan::Context& context, const LoopConfig& loops, const DeformationConfig& deformation)
    : loops_(loops), deformation_(deformation), sampler_(context), deformer_(context) {}

bool LoopCorrection::correct(const TrackedFrame& frame, const Alignment& alignment,
                             std::vector<GraphCamera>& trajectory, std::vector<Keyframe>& keyframes, LoopEvent& event) {
    const std::vector<LoopConstraint> own = constraints_of(frame, alignment);
    event.residual_before_m = event.residual_after_m = mean_displacement(own);
    if (event.residual_before_m < static_cast<double>(loops_.min_discrepancy)) return true;
    if (!can_be_drift(event.residual_before_m, event.model_frame, trajectory)) {
        event.reason = "too far for drift, another place that looks alike";
        return false;
    }

    const Stopwatch solving;
    std::vector<LoopConstraint> constraints = own;
    constraints.insert(constraints.end(), relative_constraints_.begin(), relative_constraints_.end());
    DeformationGraph graph = DeformationGraph::sample(sampler_.sample(frame.map), deformation_, trajectory);
    event.nodes = static_cast<std::uint32_t>(graph.nodes().size());
    const DeformationGraph::SolveResult solution = graph.solve(constraints);
    event.residual_after_m = solution.constraint_error_after_m;
    event.solve_milliseconds = solving.milliseconds();
    if (!solution.accepted) {
        event.reason = solution.reason;
        return false;
    }

    loop_graph_ = loop_graph_of(graph, frame.number());
    const InfluenceTree tree(graph);
    event.solve_milliseconds = solving.milliseconds();
    deformer_.run(frame.map, tree);
    for (std::size_t k = 0; k + 1 < trajectory.size(); ++k)
        trajectory[k].T_world_camera = graph.deform(trajectory[k].T_world_camera, trajectory[k].frame);
    for (Keyframe& keyframe : keyframes)
        keyframe.T_world_camera = graph.deform(keyframe.T_world_camera, keyframe.frame);
    deform_constraints(graph);
    keep(own);
    return true;
}

void LoopCorrection::follow(const SurfelMap& map, std::span<const Eigen::Isometry3d> poses,
                            std::vector<GraphCamera>& trajectory, std::vector<Keyframe>& keyframes) {
    DeformationGraph graph = DeformationGraph::sample(sampler_.sample(map), deformation_, trajectory);
    graph.follow(trajectory, poses);
    deformer_.run(map, InfluenceTree(graph));
    deform_constraints(graph);
    for (std::size_t k = 0; k < trajectory.size(); ++k) trajectory[k].T_world_camera = poses[k];
    for (Keyframe& keyframe : keyframes) {
        const auto at =
            std::lower_bound(trajectory.begin(), trajectory.end(), keyframe.frame,
                             [](const GraphCamera& camera, std::uint32_t frame) { return camera.frame < frame; });
        if (at != trajectory.end()) keyframe.T_world_camera = at->T_world_camera;
    }
}

void LoopCorrection::deform_constraints(const DeformationGraph& graph) {
    for (LoopConstraint& constraint : relative_constraints_) {
        constraint.source = graph.deform(constraint.source, constraint.source_time);
        constraint.target = graph.deform(constraint.target, constraint.target_time);
    }
}

bool LoopCorrection::can_be_drift(double displacement, std::uint32_t since,
                                  const std::vector<GraphCamera>& trajectory) const {
    const auto way = distance_travelled(since, trajectory);
    return !way ||
           displacement <= static_cast<double>(loops_.max_drift_at_rest) + static_cast<double>(loops_.max_drift) * *way;
}

void LoopCorrection::keep(const std::vector<LoopConstraint>& constraints) {
    const std::size_t spacing = std::max<std::size_t>(
        1, constraints.size() / static_cast<std::size_t>(std::max(1, loops_.relative_constraints)));
    for (std::size_t i = spacing / 2; i < constraints.size(); i += spacing) {
        LoopConstraint kept = constraints[i];
        kept.source = kept.target;
        kept.relative = true;
        kept.pin = false;
        relative_constraints_.push_back(kept);
    }
}

void LoopCorrection::restore(const std::vector<LoopConstraint>& relative_constraints) {
    relative_constraints_ = relative_constraints;
    loop_graph_.reset();
}

}  // namespace posefusion
