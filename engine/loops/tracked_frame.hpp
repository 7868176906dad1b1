#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "engine/core/matrix6d.hpp"
#include "engine/map/surfel_map.hpp"
#include "engine/preprocess/preprocessing.hpp"
#include "engine/vulkan/shared_types.hpp"

namespace posefusion {

/// Where the camera may be, and from which earlier frame that is known.
struct PoseProposal {
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    std::uint32_t frame = 0;
};

/// A frame that has just been tracked and fused, as the back end sees it. Its images and the map are on the device.
struct TrackedFrame {
    gpu::Params params;
    Eigen::Isometry3d T_world_camera;
    Matrix6d information;  ///< of the step from the previous frame (see GraphCamera); zero if tracking failed
    bool failed = false;
    std::uint32_t inactive_in_view = 0;  ///< stable inactive surfels near the surface this frame saw
    const Preprocessing& images;
    const PyramidBuilder& pyramids;
    SurfelMap& map;
    std::optional<PoseProposal> proposal;  ///< from outside: of the StartPoses offered

    [[nodiscard]] std::uint32_t number() const { return params.frame; }
};

}  // namespace posefusion
