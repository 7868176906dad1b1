#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/core/byte_stream.hpp"
#include "engine/core/intrinsics.hpp"
#include "engine/loops/deformation_graph.hpp"
#include "engine/loops/fern_database.hpp"

/// All that the next frame depends on, as plain values: what Slam::state() gives and Slam::restore() takes. ByteArray
/// are those of the device's buffers (shaders/include/shared_types.h, surfel.glsl).
namespace posefusion {

struct MapState {
    std::uint32_t capacity = 0;  ///< slots: when it is full, dead ones are dropped
    std::uint32_t slots = 0;     ///< in use, dead ones included: their order decides the order of later surfels
    std::uint32_t alive = 0;     ///< as counted after the last frame
    ByteArray counters;          ///< gpu::MapRecord
    ByteArray position_confidence, normal_radius, appearance;  ///< kSurfelStreamBytes per slot
};
inline constexpr std::size_t kSurfelStreamBytes = 16;

/// What the next frame is tracked against.
struct TrackerState {
    ByteArray record;         ///< gpu::TrackingRecord
    ByteArray previous_live;  ///< image of the rotation-only pre-alignment
    ByteArray model;          ///< the levels' geometry from fine to coarse, then their photometric
};

/// What keyframe codes were made with; others mean something else.
struct FernIdentity {
    std::int32_t ferns = 0, shrink = 0;
    std::uint32_t seed = 0;
    float depth_max = 0;  ///< metres
    friend bool operator==(const FernIdentity&, const FernIdentity&) = default;
};

struct BackEndState {
    FernIdentity ferns;
    std::vector<Keyframe> keyframes;
    std::vector<Eigen::Isometry3d> trajectory;  ///< one pose per frame
    std::vector<Matrix6d> information;          ///< of the step to each of them: GraphCamera::information
    std::vector<LoopConstraint> relative_constraints;
    std::int32_t failures = 0;               ///< frames without tracking up to now
    float pending_overlap = 0;               ///< of the loop that waits for a better view; 0: none
    std::uint32_t pending_since = 0;         ///< frame in which it was last seen
    std::uint32_t waiting_since = 0;         ///< frame in which it was first seen
    std::optional<Eigen::Isometry3d> found;  ///< by relocalisation, to be confirmed
    std::uint32_t proposal = 0;              ///< of relocalisation, next one to try
};

struct SlamState {
    Intrinsics camera;
    std::uint32_t frames = 0;  ///< processed so far; number of the next one
    MapState map;
    TrackerState tracking;
    BackEndState back_end;
};

}  // namespace posefusion
