#pragma once
#include <cstdint>
#include <vector>

#include "segmentation/body_volume.hpp"
#include "segmentation/mask_memory.hpp"
#include "segmentation/node_grid.hpp"
#include "segmentation/person_tracker.hpp"
#include "segmentation/support_planes.hpp"

/// The unary term of the cut: at each node the evidence for person and for static.
namespace posefusion {

/// Weights are in units of one edge between equal neighbours (SmoothnessConfig::weight).
struct EvidenceConfig {
    // Distance to the body, eq. (3) in three dimensions: (border - distance) / scale within the limits. The three
    // lengths are given at the default SegmentationConfig::radius and grow in proportion to it.
    float border = 0.05f;       ///< distance from the body at which person and static are equally likely, metres
    float scale = 0.06f;        ///< distance per unit of weight, metres
    float margin = 0.3f;        ///< nodes farther than this from the sphere around a body are static, metres
    float person_limit = 1.5f;  ///< largest weight that distance gives to person
    float static_limit = 3.0f;  ///< and to static
    float ends = 0.2f;          ///< weight for person where feet and hair may be, unless there is a support plane
    float reach = -0.01f;  ///< weight in the volume of undetected parts: nearly neutral, so that smoothness decides

    // Nodes without depth: the outline of the body in the image, and the depth left and right of the hole.
    float outline_inset = 0.08f;  ///< the outline is shrunk by this, metres
    float outline_scale = 0.04f;  ///< metres per unit of weight
    float outline_limit = 1.0f;   ///< largest weight of each of the two

    // Surfaces that carry people or hide parts of them.
    float support = 1.5f;       ///< weight for static on a support plane
    float hiding = 1.5f;        ///< weight for static on surfaces that hide joints, throughout the connected surface
    float hiding_step = 0.02f;  ///< such a surface ends at a larger step in depth between nodes, metres, beyond noise
    float away = 0.15f;         ///< planes are estimated from nodes farther than this from every body, metres

    // Memory of earlier frames; weights for people detected in this frame and for those carried over from earlier ones.
    float person_tolerance = 0.08f;  ///< a remembered person is still there within this, metres, beyond noise
    float static_tolerance = 0.03f;  ///< same for a static surface, metres, beyond noise
    float step_in_front = 0.08f;     ///< a node nearer than the static surface by this is a newcomer, metres
    float color_changed = 0.15f;     ///< same for nodes without depth: difference from the static colour, 0..1
    float color_same = 0.06f;        ///< nodes without depth that differ less from the static colour show it, 0..1
    float motion_near = 0.4f;        ///< newcomers this near a body belong to it, metres
    float motion_reach = 1.0f;       ///< and those connected to them, if this near
    float motion = 1.2f;             ///< weight for person of newcomers that belong to a body
    float motion_floor = -0.8f;      ///< lowest weight that distance gives to newcomers
    float memory_detected = 0.4f;    ///< weight of memory, person or static, for detected people
    float memory_carried = 1.5f;     ///< same for carried people
    float memory_floor = -0.3f;      ///< lowest weight that distance gives to a remembered person
};

struct Evidence {
    std::vector<float> preference;     ///< per node: > 0 person, < 0 static
    std::vector<std::uint8_t> person;  ///< per node: the track it would belong to, 1..n in the given order; 0 = none
};

[[nodiscard]] Evidence gather_evidence(const NodeGrid& grid, const std::vector<PersonTrack>& tracks,
                                       const std::vector<Memory>& memory, const EvidenceConfig& config,
                                       const SupportConfig& support);

}  // namespace posefusion
