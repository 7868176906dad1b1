#pragma once
#include <cstdint>
#include <vector>

#include "segmentation/body_volume.hpp"
#include "segmentation/mask_memory.hpp"
#include "segmentation/node_grid.hpp"
#include "segmentation/person_tracker.hpp"
#include "segmentation/support_planes.hpp"

/// The unary term: what speaks at each node for person and for static.
namespace posefusion {

/// Weights are in units of one edge between equal neighbours (SmoothnessConfig::weight).
struct EvidenceConfig {
    // Distance to the body, eq. (3)'s part in three dimensions: (border - distance) / scale within the limits.
    float border = 0.05f;       ///< distance from the body at which person and static are equally likely, metres
    float scale = 0.06f;        ///< distance per unit of weight, metres
    float person_limit = 1.5f;  ///< most that distance can say for a person
    float static_limit = 3.0f;  ///< and for static
    float ends = 0.2f;          ///< weight where feet and hair may be, unless a support plane is there
    float reach = -0.01f;       ///< weight in the space that the body may also take: the surface decides
    float margin = 0.3f;        ///< nodes farther than this from the sphere around a body are static, metres

    // Nodes without depth: the outline of the body in the picture, and the depth left and right of the hole.
    float outline_inset = 0.08f;  ///< the outline is drawn in by this, metres
    float outline_scale = 0.04f;  ///< metres per unit of weight
    float outline_limit = 1.0f;   ///< most that each of the two can say

    // Surfaces that carry people.
    float support = 1.5f;       ///< weight for static on a support plane
    float hiding = 1.5f;        ///< weight for static of surfaces that hide joints, as far as they hang together
    float hiding_step = 0.02f;  ///< a larger step in depth from node to node is their end, metres, beyond noise
    float away = 0.15f;         ///< planes are estimated from nodes farther than this from every body, metres

    // Memory of earlier frames; weights for people detected in this frame and for carried ones.
    float person_tolerance = 0.08f;  ///< a remembered person is still there within this, metres, beyond noise
    float static_tolerance = 0.03f;  ///< same for a static surface, metres, beyond noise
    float step_in_front = 0.08f;     ///< nearer than the static surface by this is something that has come, metres
    float color_changed = 0.15f;     ///< same for nodes without depth: colour unlike the static one, of 0..1
    float color_same = 0.06f;        ///< nodes without depth whose colour is this like the static one show it, of 0..1
    float motion_near = 0.4f;        ///< what has come belongs to a body this near, metres
    float motion_reach = 1.0f;       ///< and, if it hangs together with that, this near
    float motion = 1.2f;             ///< weight for person of what has come and is joined to a body
    float motion_floor = -0.8f;      ///< distance says no more than this against it
    float memory_detected = 0.4f;    ///< weight of memory, person or static, for detected people
    float memory_carried = 1.5f;     ///< same for carried people
    float memory_floor = -0.3f;      ///< distance says no more than this against a remembered person
};

struct Evidence {
    std::vector<float> preference;     ///< per node: > 0 person, < 0 static
    std::vector<std::uint8_t> person;  ///< per node: the track it would belong to, 1..n in the order given; 0 = none
};

[[nodiscard]] Evidence gather_evidence(const NodeGrid& grid, const std::vector<PersonTrack>& tracks,
                                       const std::vector<Memory>& memory, const EvidenceConfig& config,
                                       const SupportConfig& support);

}  // namespace posefusion
