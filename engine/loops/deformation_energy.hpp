#pragma once
#include "engine/loops/deformation_graph.hpp"

/// The energy of a deformation: sum of squares of terms of three rows each, already scaled by the root of their weight.
namespace posefusion {

/// Residual of a term and its derivative by each node it depends on. A step (w, v) of a node means R <- exp([w]x) R, t
/// <- t + v.
struct EnergyTerm {
    using Block = Eigen::Matrix<double, 3, 6>;
    static constexpr size_t kMaxNodes =
        24;  ///< enough for a relative constraint with ties; further nodes have negligible weight and are left out
    Eigen::Vector3d residual = Eigen::Vector3d::Zero();
    std::array<std::uint32_t, kMaxNodes> node;
    std::array<Block, kMaxNodes> jacobian;
    size_t count = 0;

    void clear();
    /// Adds to the derivative by a node.
    void add(std::uint32_t index, const Block& block);
};

class DeformationEnergy {
public:
    /// The nodes that influence each constraint are determined here, once. Both arguments must outlive the energy.
    DeformationEnergy(const DeformationGraph& graph, std::span<const LoopConstraint> constraints);

    [[nodiscard]] size_t terms() const { return edge_terms() + tie_terms() + 2 * constraints_.size(); }
    /// Term `index` for given transforms of the nodes; zero, without nodes, for the pin of a constraint that has none.
    void evaluate(size_t index, std::span<const GraphNode> nodes, EnergyTerm& term) const;

    [[nodiscard]] double total(std::span<const GraphNode> nodes) const;
    /// Mean distance of the absolute constraints (of all if every one is relative), metres.
    [[nodiscard]] double constraint_error(std::span<const GraphNode> nodes) const;
    /// Largest distance between a node and the position a neighbour predicts for it, metres.
    [[nodiscard]] double edge_error(std::span<const GraphNode> nodes) const;

private:
    struct Anchors {
        std::vector<Influence> source, target;
    };
    static constexpr size_t kEdgeTerms = 5;  // regularisation both ways, three columns of the rotations
    [[nodiscard]] size_t edge_terms() const { return kEdgeTerms * graph_.edges().size(); }
    static constexpr size_t kTieTerms = 2;  // six rows
    [[nodiscard]] size_t tie_terms() const { return kTieTerms * graph_.camera_ties().size(); }
    void evaluate_edge(size_t index, std::span<const GraphNode> nodes, EnergyTerm& term) const;
    void evaluate_tie(size_t index, std::span<const GraphNode> nodes, EnergyTerm& term) const;
    [[nodiscard]] double constraint_distance(size_t index, std::span<const GraphNode> nodes) const;

    const DeformationGraph& graph_;
    std::span<const LoopConstraint> constraints_;
    std::vector<Anchors> anchors_;
    double constraint_;  // root of the weight
};

}  // namespace posefusion
