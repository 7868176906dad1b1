#pragma once
#include "engine/loops/deformation_graph.hpp"
#include "engine/vulkan/shared_types.hpp"

/// A deformation graph prepared for millions of points: a binary tree over space and time whose leaves list the nodes
/// that can be among the nearest of any point in them. The result is exact everywhere; lists are short where there were
/// samples.
namespace posefusion {

class InfluenceTree {
public:
    explicit InfluenceTree(const DeformationGraph& graph);

    /// Candidates for the nodes that influence a point; all of DeformationGraph::influences() are among them.
    [[nodiscard]] std::span<const gpu::DeformCandidate> candidates(const Eigen::Vector3d& point,
                                                                   std::uint32_t time) const;

    /// In the layout of shaders/loops/deform.comp. The root is branch 0. All empty for a graph without nodes.
    [[nodiscard]] const std::vector<gpu::DeformNode>& nodes() const { return nodes_; }
    [[nodiscard]] const std::vector<gpu::DeformBranch>& branches() const { return branches_; }
    [[nodiscard]] const std::vector<gpu::DeformLeaf>& leaves() const { return leaves_; }
    [[nodiscard]] const std::vector<gpu::DeformCandidate>& candidates() const { return candidates_; }
    [[nodiscard]] double metres_per_frame() const { return metres_per_frame_; }
    [[nodiscard]] double temporal_window() const { return temporal_window_; }  ///< frames

private:
    struct NodeExtents;
    struct Box;
    void build(const DeformationGraph& graph, Box root);
    void add_candidate(const DeformationGraph& graph, std::uint32_t index, double bound);
    void add_leaf(const DeformationGraph& graph, std::size_t branch, const Box& box);

    double metres_per_frame_ = 0, temporal_window_ = 0;
    std::vector<gpu::DeformNode> nodes_;
    std::vector<gpu::DeformBranch> branches_;
    std::vector<gpu::DeformLeaf> leaves_;
    std::vector<gpu::DeformCandidate> candidates_;
};

}  // namespace posefusion
