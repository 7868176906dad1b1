#pragma once
#include <Eigen/Geometry>
#include <array>

#include "hosts/synth/mesh.hpp"
#include "pose/joints.hpp"

/// Bones of a person, and the conversion of a posture to bone transforms.
/// Body frame: x forward, y left, z up, origin on the floor below the pelvis, metres.
namespace posefusion::synth {

using Eigen::Isometry3f;
using Eigen::Matrix3f;

enum Bone : int {
    Pelvis,
    Spine,
    Chest,
    NeckBone,
    Head,
    UpperArmL,
    ForearmL,
    HandL,
    UpperArmR,
    ForearmR,
    HandR,
    ThighL,
    ShinL,
    FootL,
    ToeL,
    ThighR,
    ShinR,
    FootR,
    ToeR,
    kBoneCount,
};
enum Side : int { Left = 0, Right = 1 };
[[nodiscard]] constexpr float sign(int side) { return side == Left ? 1.0f : -1.0f; }
[[nodiscard]] constexpr int upper_arm(int side) { return side == Left ? UpperArmL : UpperArmR; }
[[nodiscard]] constexpr int thigh(int side) { return side == Left ? ThighL : ThighR; }

/// Lengths of a body, metres; from its height by the usual anthropometric proportions (Drillis and Contini 1966),
/// varied by sex.
struct Proportions {
    explicit Proportions(float stature = 1.75f, bool woman = false);
    float height;
    float hip_height, hip_half_width;
    float spine_height, chest_height, neck_height, head_height;  ///< of the joints, standing
    float shoulder_height, shoulder_half_width;
    float upper_arm, forearm, hand;
    float thigh, shin, ankle_height;
    float heel_back, ball_ahead, toe_ahead;  ///< of the ankle, along the foot
};

struct ArmPosture {
    float flexion = 0;    ///< upper arm forward, rad
    float abduction = 0;  ///< upper arm away from the body, rad
    float twist = 0;      ///< forearm towards the middle of the body, rad
    float elbow = 0;      ///< 0 = straight, rad
};

struct FootPosture {
    Vector3f ankle = Vector3f::Zero();  ///< world
    float yaw = 0;                      ///< world
    float pitch = 0;                    ///< toes down positive, rad
    float toe_pitch = 0;                ///< of the toes in the world, rad
};

/// The posture of a body at one instant, as determined by a motion.
struct Posture {
    Vector3f pelvis = Vector3f::Zero();  ///< middle between the hip joints, world
    float yaw = 0;                       ///< of the pelvis, world, rad
    float pelvis_pitch = 0, pelvis_roll = 0;
    float spine_pitch = 0, spine_yaw = 0, spine_roll = 0;  ///< of the chest relative to the pelvis
    float head_yaw = 0, head_pitch = 0;                    ///< relative to the chest
    std::array<ArmPosture, 2> arms{};
    std::array<FootPosture, 2> feet{};
};

using BoneTransforms = std::array<Isometry3f, kBoneCount>;

/// The posture in which bodies are modelled: upright at the origin, arms 24 degrees off the trunk.
[[nodiscard]] BoneTransforms bind_pose(const Proportions& body);
/// Forward kinematics for trunk and arms, inverse kinematics for the legs; world frame.
[[nodiscard]] BoneTransforms solve_pose(const Proportions& body, const Posture& posture);
/// The 18 joints in the world. Nose, eyes and ears sit on the head's surface, the others inside the limbs.
[[nodiscard]] std::array<Vector3f, kJointCount> body_joints(const Proportions& body, const BoneTransforms& bones);

}  // namespace posefusion::synth
