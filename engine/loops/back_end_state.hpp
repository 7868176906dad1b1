#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/core/matrix6d.hpp"
#include "engine/loops/keyframe.hpp"
#include "engine/loops/loop_constraint.hpp"

namespace posefusion {

/// State of relocalisation.
struct RelocalisationState {
    std::int32_t failures = 0;               ///< consecutive frames on which tracking has failed
    std::optional<Eigen::Isometry3d> found;  ///< pose in the frame before, to be confirmed by the next one
    std::uint32_t proposal = 0;              ///< index of the next proposal to try
};

/// A loop that could be closed but waits for a better view.
struct PendingLoop {
    float overlap = 0;            ///< when it was last seen; 0: there is none
    std::uint32_t last_seen = 0;  ///< frame
    std::uint32_t since = 0;      ///< frame in which it was first seen
};

/// What BackEnd::state() gives and BackEnd::restore() takes.
struct BackEndState {
    FernIdentity ferns;
    std::vector<Keyframe> keyframes;
    std::vector<Eigen::Isometry3d> trajectory;         ///< one pose per frame
    std::vector<Matrix6d> information;                 ///< of the step to each of them: GraphCamera::information
    std::vector<LoopConstraint> relative_constraints;  ///< of the loops so far
    RelocalisationState relocalisation;
    PendingLoop pending_loop;
};

}  // namespace posefusion
