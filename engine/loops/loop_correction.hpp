#pragma once
#include <optional>
#include <vector>

#include "engine/loops/alignment.hpp"
#include "engine/loops/deformation_graph.hpp"
#include "engine/loops/deformer.hpp"
#include "engine/loops/fern_database.hpp"
#include "engine/loops/loop_graph.hpp"
#include "engine/loops/surfel_sampler.hpp"
#include "engine/loops/tracked_frame.hpp"

namespace posefusion {

/// Corrects the drift that a loop has made visible: bends map, trajectory and keyframes so that the live image lies
/// where its alignment with the older part of the map found it.
class LoopCorrection {
public:
    LoopCorrection(vulkan::Context& context, const LoopConfig& loops, const DeformationConfig& deformation);

    /// @param trajectory  of all frames, this one the last; it is bent except for this one
    /// @param event       of the attempt; its residuals, nodes, times and reason are filled in
    /// @return false: not possible, everything is as it was
    bool correct(const TrackedFrame& frame, const Alignment& alignment, std::vector<GraphCamera>& trajectory,
                 std::vector<Keyframe>& keyframes, LoopEvent& event);

    /// What is closed stays closed: kept from each loop, for the later ones.
    [[nodiscard]] const std::vector<LoopConstraint>& relative_constraints() const { return relative_constraints_; }
    void restore(const std::vector<LoopConstraint>& relative_constraints);
    /// Of the last loop that has bent the map since the start or restore().
    [[nodiscard]] const std::optional<LoopGraph>& loop_graph() const { return loop_graph_; }

private:
    /// Can drift be so large, after the way that the camera has gone since?
    [[nodiscard]] bool can_be_drift(double displacement, std::uint32_t since,
                                    const std::vector<GraphCamera>& trajectory) const;
    void keep(const std::vector<LoopConstraint>& constraints);

    LoopConfig loops_;
    DeformationConfig deformation_;
    SurfelSampler sampler_;
    Deformer deformer_;
    std::vector<LoopConstraint> relative_constraints_;
    std::optional<LoopGraph> loop_graph_;
};

}  // namespace posefusion
