#include "engine/loops/deformation_energy.hpp"

#include <algorithm>
#include <cmath>

namespace posefusion {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Block = EnergyTerm::Block;

Matrix3d cross_matrix(const Vector3d& v) {
    Matrix3d m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}

/// Derivative of scale * (R a + t) where Ra = R a.
Block moved(const Vector3d& Ra, double scale) {
    Block block;
    block << -scale * cross_matrix(Ra), scale * Matrix3d::Identity();
    return block;
}

Vector3d blended(const std::vector<Influence>& shares, const Vector3d& point, std::span<const GraphNode> nodes) {
    Vector3d result = Vector3d::Zero();
    for (const auto& share : shares) result += share.weight * nodes[share.node].apply(point);
    return result;
}

/// Adds scale times the blended motion of a point to a term.
void add_blended(EnergyTerm& term, const std::vector<Influence>& shares, const Vector3d& point,
                 std::span<const GraphNode> nodes, double scale) {
    term.residual += scale * blended(shares, point, nodes);
    for (const auto& share : shares) {
        const auto& node = nodes[share.node];
        term.add(share.node, moved(node.R * (point - node.position), scale * share.weight));
    }
}

}  // namespace

void EnergyTerm::clear() {
    residual.setZero();
    count = 0;
}

void EnergyTerm::add(std::uint32_t index, const Block& block) {
    const auto end = node.begin() + static_cast<std::ptrdiff_t>(count);
    const auto at = static_cast<size_t>(std::find(node.begin(), end, index) - node.begin());
    if (at < count) {
        jacobian[at] += block;
    } else if (count < kMaxNodes) {
        node[count] = index;
        jacobian[count++] = block;
    }
}

DeformationEnergy::DeformationEnergy(const DeformationGraph& graph, std::span<const LoopConstraint> constraints)
    : graph_(graph),
      constraints_(constraints),
      constraint_(std::sqrt(static_cast<double>(graph.config().constraint_weight))) {
    for (const auto& c : constraints) {
        anchors_.push_back(
            {c.by_camera ? graph.pose_influences(c.source, c.source_time) : graph.influences(c.source, c.source_time),
             {}});
        if (c.relative || c.pin) anchors_.back().target = graph.influences(c.target, c.target_time);
    }
}

void DeformationEnergy::evaluate_edge(size_t index, std::span<const GraphNode> nodes, EnergyTerm& term) const {
    const auto& [a, b, rotation, regularisation] = graph_.edges()[index / kEdgeTerms];
    const size_t kind = index % kEdgeTerms;
    if (kind < 2) {
        // predicted and actual position of the neighbour
        const auto from = kind == 0 ? a : b, to = kind == 0 ? b : a;
        const Vector3d offset = nodes[from].R * (nodes[to].position - nodes[from].position);
        term.residual =
            regularisation * (offset + nodes[from].position + nodes[from].t - nodes[to].position - nodes[to].t);
        term.add(from, moved(offset, regularisation));
        term.add(to, moved(Vector3d::Zero(), -regularisation));
    } else {
        // a column of the difference of the rotations
        const auto column = static_cast<Eigen::Index>(kind - 2);
        const Vector3d of_a = rotation * nodes[a].R.col(column), of_b = rotation * nodes[b].R.col(column);
        term.residual = of_a - of_b;
        Block block = Block::Zero();
        block.leftCols<3>() = -cross_matrix(of_a);
        term.add(a, block);
        block.leftCols<3>() = cross_matrix(of_b);
        term.add(b, block);
    }
}

void DeformationEnergy::evaluate_tie(size_t index, std::span<const GraphNode> nodes, EnergyTerm& term) const {
    const auto& [a, b, root] = graph_.camera_ties()[index / kTieTerms];
    // pose of b as predicted by a, and its actual pose
    const Vector3d offset = nodes[a].R * (nodes[b].position - nodes[a].position);
    const Matrix3d turned = nodes[a].R * nodes[b].R.transpose();
    Eigen::Matrix<double, 6, 1> error;
    error << offset + nodes[a].position + nodes[a].t - nodes[b].position - nodes[b].t,
        0.5 * (turned(2, 1) - turned(1, 2)), 0.5 * (turned(0, 2) - turned(2, 0)), 0.5 * (turned(1, 0) - turned(0, 1));
    Eigen::Matrix<double, 6, 6> by_a, by_b;
    by_a << moved(offset, 1), 0.5 * (turned.trace() * Matrix3d::Identity() - turned), Matrix3d::Zero();
    by_b << moved(Vector3d::Zero(), -1), -0.5 * (turned.trace() * Matrix3d::Identity() - turned.transpose()),
        Matrix3d::Zero();
    const auto rows = root.middleRows<3>(static_cast<Eigen::Index>(3 * (index % kTieTerms)));
    term.residual = rows * error;
    term.add(a, rows * by_a);
    term.add(b, rows * by_b);
}

void DeformationEnergy::evaluate(size_t index, std::span<const GraphNode> nodes, EnergyTerm& term) const {
    term.clear();
    if (index < edge_terms()) return evaluate_edge(index, nodes, term);
    index -= edge_terms();
    if (index < tie_terms()) return evaluate_tie(index, nodes, term);
    index -= tie_terms();
    const size_t k = index / 2;
    const bool is_pin = index % 2 == 1;
    const auto& c = constraints_[k];
    if (is_pin) {
        if (!c.pin) return;
        add_blended(term, anchors_[k].target, c.target, nodes, constraint_);
        term.residual -= constraint_ * c.target;
        return;
    }
    add_blended(term, anchors_[k].source, c.source, nodes, constraint_);
    if (c.relative) {
        add_blended(term, anchors_[k].target, c.target, nodes, -constraint_);
    } else {
        term.residual -= constraint_ * c.target;
    }
}

double DeformationEnergy::total(std::span<const GraphNode> nodes) const {
    double sum = 0;
    EnergyTerm term;
    for (size_t i = 0; i < terms(); ++i) {
        evaluate(i, nodes, term);
        sum += term.residual.squaredNorm();
    }
    return sum;
}

double DeformationEnergy::constraint_distance(size_t index, std::span<const GraphNode> nodes) const {
    const auto& c = constraints_[index];
    const Vector3d target = c.relative ? blended(anchors_[index].target, c.target, nodes) : c.target;
    return (blended(anchors_[index].source, c.source, nodes) - target).norm();
}

double DeformationEnergy::constraint_error(std::span<const GraphNode> nodes) const {
    const bool all_relative =
        std::all_of(constraints_.begin(), constraints_.end(), [](const auto& c) { return c.relative; });
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < constraints_.size(); ++i) {
        if (constraints_[i].relative && !all_relative) continue;
        sum += constraint_distance(i, nodes);
        ++count;
    }
    return count ? sum / static_cast<double>(count) : 0;
}

double DeformationEnergy::edge_error(std::span<const GraphNode> nodes) const {
    double largest = 0;
    EnergyTerm term;
    for (size_t edge = 0; edge < graph_.edges().size(); ++edge) {
        for (size_t way = 0; way < 2; ++way) {
            evaluate(kEdgeTerms * edge + way, nodes, term);
            largest = std::max(largest, term.residual.norm() / graph_.edges()[edge].regularisation);
        }
    }
    return largest;
}

}  // namespace posefusion
