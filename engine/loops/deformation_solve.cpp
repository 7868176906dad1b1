#include <algorithm>
#include <cmath>

#include "engine/core/number_text.hpp"
#include "engine/loops/normal_equations.hpp"

namespace posefusion {
namespace {

// Damping relative to the mean of the diagonal. The least keeps the system regular where nothing ties the map to the
// world; it slows convergence by as much.
constexpr double kLeastDamping = 1e-9, kMostDamping = 1e2;
constexpr double kMoreDamping = 100, kLessDamping = 0.01;
constexpr double kRelativeDecrease = 1e-9;  // of the energy; a smaller decrease means convergence

std::string millimetres(double metres) { return fixed_text(1000 * metres, 1) + " mm"; }

/// The reason why there is nothing to solve; empty if there is something.
std::string obstacle(const DeformationGraph& graph, std::span<const LoopConstraint> constraints,
                     const std::vector<bool>& is_free) {
    if (graph.nodes().empty()) return "the graph has no nodes";
    if (constraints.empty()) return "there are no constraints";
    if (std::none_of(is_free.begin(), is_free.end(), [](bool f) { return f; })) return "all nodes are fixed";
    for (size_t i = 0; i < constraints.size(); ++i) {
        if (!constraints[i].source.allFinite() || !constraints[i].target.allFinite()) {
            return "constraint " + std::to_string(i) + " is not finite";
        }
    }
    return {};
}

void take_step(std::vector<GraphNode>& nodes, const std::vector<Eigen::Matrix<double, 6, 1>>& step) {
    for (size_t i = 0; i < nodes.size(); ++i) {
        const Eigen::Vector3d w = step[i].head<3>();
        const double angle = w.norm();
        if (angle > 0)
            nodes[i].R =
                (Eigen::AngleAxisd(angle, w / angle) * Eigen::Quaterniond(nodes[i].R)).normalized().toRotationMatrix();
        nodes[i].t += step[i].tail<3>();
    }
}

double longest(const std::vector<Eigen::Matrix<double, 6, 1>>& step) {
    double result = 0;
    for (const auto& s : step) result = std::max({result, s.head<3>().norm(), s.tail<3>().norm()});
    return result;
}

}  // namespace

DeformationGraph::SolveResult DeformationGraph::solve(std::span<const LoopConstraint> constraints,
                                                      std::uint32_t fixed_before) {
    std::vector<bool> is_free;
    for (const auto& node : nodes_) is_free.push_back(node.time >= fixed_before);
    SolveResult result;
    result.reason = obstacle(*this, constraints, is_free);
    if (!result.reason.empty()) return result;

    const DeformationEnergy energy(*this, constraints);
    result.constraint_error_before_m = result.constraint_error_after_m = energy.constraint_error(nodes_);
    result.energy_before = result.energy_after = energy.total(nodes_);
    if (!std::isfinite(result.energy_before)) {
        result.reason = "the transforms of the graph are not finite";
        return result;
    }
    if (result.constraint_error_before_m < static_cast<double>(DeformationConfig::kMaxConstraintError)) {
        result.reason =
            "nothing to do: the constraints are off by " + millimetres(result.constraint_error_before_m) + " only";
        return result;
    }

    NormalEquations equations(energy, nodes_, is_free);
    std::vector<GraphNode> current = nodes_, candidate;
    std::vector<Eigen::Matrix<double, 6, 1>> step(nodes_.size());
    double damping = kLeastDamping;
    bool converged = false;
    equations.assemble(energy, current);
    while (!converged && result.iterations < config_.iterations && damping <= kMostDamping) {
        ++result.iterations;
        if (!equations.solve(damping, step)) {
            damping *= kMoreDamping;
            continue;
        }
        candidate = current;
        take_step(candidate, step);
        const double found = energy.total(candidate);
        const bool is_short = longest(step) < static_cast<double>(DeformationConfig::kConvergedStep);
        if (!(found <= result.energy_after)) {
            // near the minimum this is rounding; elsewhere the step was too long
            converged = is_short;
            damping *= kMoreDamping;
            continue;
        }
        converged = is_short || result.energy_after - found <= kRelativeDecrease * result.energy_after;
        current.swap(candidate);
        result.energy_after = found;
        damping = std::max(damping * kLessDamping, kLeastDamping);
        if (!converged) equations.assemble(energy, current);
    }
    result.constraint_error_after_m = energy.constraint_error(current);
    result.edge_error_m = energy.edge_error(current);
    if (!converged) {
        result.reason = "not converged after " + std::to_string(result.iterations) + " iterations";
    } else if (!(result.constraint_error_after_m <= static_cast<double>(DeformationConfig::kMaxConstraintError))) {
        result.reason = "the constraints contradict each other or the map: they are still off by " +
                        millimetres(result.constraint_error_after_m);
    } else if (!(result.edge_error_m <= static_cast<double>(config_.max_edge_error))) {
        result.reason = "the map would be torn apart by " + millimetres(result.edge_error_m);
    } else {
        result.accepted = true;
        nodes_ = std::move(current);
    }
    return result;
}

}  // namespace posefusion
