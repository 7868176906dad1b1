#pragma once
#include <optional>
#include <span>
#include <vector>

#include "engine/loops/alignment.hpp"
#include "engine/loops/deformation_graph.hpp"
#include "engine/loops/deformer.hpp"
#include "engine/loops/fern_database.hpp"
#include "engine/loops/loop_graph.hpp"
#include "engine/loops/surfel_sampler.hpp"
#include "engine/loops/tracked_frame.hpp"

namespace posefusion {

/// Corrects the drift that a loop reveals: deforms map, trajectory and keyframes so that the live image coincides with
/// the older part of the map it was aligned with.
class LoopCorrection {
public:
    LoopCorrection(vulkan::Context& context, const LoopConfig& loops, const DeformationConfig& deformation);

    /// @param trajectory  of all frames, this one the last; deformed except for this one
    /// @param event       of the attempt; residuals, nodes, times and reason are filled in
    /// @return false: no acceptable deformation, everything is unchanged
    bool correct(const TrackedFrame& frame, const Alignment& alignment, std::vector<GraphCamera>& trajectory,
                 std::vector<Keyframe>& keyframes, LoopEvent& event);

    /// The poses of all frames are known better: map and keyframes follow them.
    /// @param poses  T_world_camera of each frame of `trajectory`, which takes them over
    void follow(const SurfelMap& map, std::span<const Eigen::Isometry3d> poses, std::vector<GraphCamera>& trajectory,
                std::vector<Keyframe>& keyframes);

    /// Constraints kept from each loop so that later ones do not open it again.
    [[nodiscard]] const std::vector<LoopConstraint>& relative_constraints() const { return relative_constraints_; }
    void restore(const std::vector<LoopConstraint>& relative_constraints);
    /// The graph of the last loop that deformed the map since the start or restore().
    [[nodiscard]] const std::optional<LoopGraph>& loop_graph() const { return loop_graph_; }

private:
    /// Whether a correction is plausible as drift, given the distance travelled since.
    [[nodiscard]] bool can_be_drift(double displacement, std::uint32_t since,
                                    const std::vector<GraphCamera>& trajectory) const;
    void deform_constraints(const DeformationGraph& graph);
    void keep(const std::vector<LoopConstraint>& constraints);

    LoopConfig loops_;
    DeformationConfig deformation_;
    SurfelSampler sampler_;
    Deformer deformer_;
    std::vector<LoopConstraint> relative_constraints_;
    std::optional<LoopGraph> loop_graph_;
};

}  // namespace posefusion
