#pragma once
#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "pose/joints.hpp"

/// Joints of eq. (1) lifted to 3-D with the depth image.
namespace posefusion {

/// How the depth of a joint was found.
enum class JointSource {
    Missing,   ///< neither seen nor inferred
    Inferred,  ///< seen in colour, but the depth there is a hole, an occluder or background: taken from the bones
    Measured,  ///< seen and its depth read
    Carried,   ///< not seen in this frame: propagated from an earlier one
};

/// One person in camera coordinates, metres. Joints lie inside the body, not on its surface.
struct Skeleton {
    std::array<Eigen::Vector3f, kJointCount> joint{};
    std::array<JointSource, kJointCount> source{};
    std::array<int, kJointCount> age{};  ///< frames since the joint was seen
    /// p of eq. (1), [0, 1]; 0 if the joint was not seen in this frame.
    std::array<float, kJointCount> confidence{};
    PixelBox box{};                          ///< of the detection; empty when there was none
    std::vector<Eigen::Vector3f> occluders;  ///< points of surfaces that hide joints, camera coordinates, metres
    [[nodiscard]] bool has(int j) const { return source[j] != JointSource::Missing; }
};

/// How joints are lifted.
struct LiftingConfig {
    float window = 0.05f;        ///< half width of the depth window around a joint at the person's distance, metres
    float cluster_gap = 0.10f;   ///< depths farther apart than this belong to different surfaces, metres
    float torso_spread = 0.25f;  ///< expected deviation of torso and head from the person's distance, metres
    float limb_spread = 0.50f;   ///< same for arms and legs, metres
    float bone_slack = 0.08f;    ///< by how much a bone may be longer than anatomy allows, metres
    float hidden_cost = 1.0f;    ///< cost of declaring a joint hidden, so that its depth cannot be read
    float surface_gap = 0.06f;   ///< a larger step in depth along a bone is the edge of another surface, metres
    float occluder_cost = 1.2f;  ///< cost of a joint on a surface in front of that of the previous joint
    float behind_cost = 0.3f;    ///< the same behind it: an arm half hidden by the trunk, or background
    float min_extent = 0.12f;    ///< a skeleton smaller than this in the image plane is not a person, metres
    float max_extent = 2.6f;     ///< nor one larger than this
    int min_joints = 3;          ///< nor one with fewer joints with depth than this
};

/// Reads the depth of every joint: the clusters of depths around it are candidates, and the choice minimises, over the
/// tree of bones, deviation from the person's distance plus bones longer than anatomy allows (exact, by dynamic
/// programming). Returns nothing if what remains cannot be a person.
[[nodiscard]] std::optional<Skeleton> lift_skeleton(const Person& person, const DepthImage& depth,
                                                    const Intrinsics& camera, const LiftingConfig& config);

/// Median distance between the joints that both have, else between their centres, metres.
[[nodiscard]] float distance_between(const Skeleton& a, const Skeleton& b);

/// How far a joint lies behind the surface that the camera sees there, metres.
[[nodiscard]] float joint_inset(int joint);

}  // namespace posefusion
