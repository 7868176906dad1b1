#pragma once
#include "engine/loops/deformation_graph.hpp"

/// The energy of a deformation: sum of squares of terms of three rows each, already scaled by the root of their weight.
namespace posefusion {

/// Residual of a term and its derivative by each node it depends on. A step (w, v) of a node means R <- exp([w]x) R, t
/// <- t + v.
struct EnergyTerm {
    using Block = Eigen::Matrix<double, 3, 6>;
    static constexpr size_t kMaxNodes =
        24;  ///< a relative constraint with ties: more are left out, their share is negligible
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
    /// Which nodes move a constraint's points is decided here, once. Both arguments must outlive the energy.
    DeformationEnergy(const DeformationGraph& graph, std::span<const LoopConstraint> constraints);

    [[nodiscard]] size_t terms() const { return edge_terms() + tie_terms() + 2 * constraints_.size(); }
    /// Term `index` for given transforms of the nodes; zero, without nodes, for a pin that is none.
    void evaluate(size_t index, std::span<const GraphNode> nodes, EnergyTerm& term) const;

    [[nodiscard]] double total(std::span<const GraphNode> nodes) const;
    /// Mean distance of the constraints that are not relative (if all are: of all), metres.
    [[nodiscard]] double constraint_error(std::span<const GraphNode> nodes) const;
    /// Largest distance between a node and where a neighbour expects it, metres.
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
