#include "hosts/synth/skeleton.hpp"

#include <algorithm>
#include <cmath>

#include "hosts/synth/random.hpp"

namespace posefusion::synth {
namespace {

using Eigen::AngleAxisf;

constexpr float kBindAbduction = 24.0f * kPi / 180;

Matrix3f rotation(float angle, const Vector3f& axis) { return AngleAxisf(angle, axis).toRotationMatrix(); }

Isometry3f transform(const Matrix3f& rotation, const Vector3f& origin) {
    Isometry3f t = Isometry3f::Identity();
    t.linear() = rotation;
    t.translation() = origin;
    return t;
}

/// A bone that points along `direction` (its -z) with `forward` as its front (its x).
Matrix3f bone_frame(const Vector3f& direction, const Vector3f& forward) {
    const Vector3f z = -direction.normalized();
    const Vector3f x = (forward - z * z.dot(forward)).normalized();
    Matrix3f frame;
    frame << x, z.cross(x), z;
    return frame;
}

void solve_arm(const Proportions& body, const ArmPosture& arm, int side, const Isometry3f& chest,
               BoneTransforms& bones) {
    const float s = sign(side);
    const Vector3f shoulder =
        chest * Vector3f(0, s * body.shoulder_half_width, body.shoulder_height - body.chest_height);
    const Vector3f hanging(0, s * std::sin(arm.abduction), -std::cos(arm.abduction));
    const Matrix3f flex = rotation(-arm.flexion, Vector3f::UnitY());
    const Vector3f upper = chest.linear() * (flex * hanging);
    const Vector3f bend = rotation(s * arm.twist, upper) * (chest.linear() * (flex * Vector3f::UnitX()));
    const Vector3f fore = std::cos(arm.elbow) * upper + std::sin(arm.elbow) * bend;
    const Vector3f fore_front = std::cos(arm.elbow) * bend - std::sin(arm.elbow) * upper;
    const Vector3f elbow = shoulder + body.upper_arm * upper, wrist = elbow + body.forearm * fore;
    bones[upper_arm(side)] = transform(bone_frame(upper, bend), shoulder);
    bones[upper_arm(side) + 1] = transform(bone_frame(fore, fore_front), elbow);
    bones[upper_arm(side) + 2] = transform(bone_frame(fore, fore_front), wrist);
}

/// Two-bone inverse kinematics: the knee lies in the plane of hip, ankle and `forward`.
void solve_leg(const Proportions& body, const FootPosture& foot, int side, const Isometry3f& pelvis,
               BoneTransforms& bones) {
    const Vector3f hip = pelvis * Vector3f(0, sign(side) * body.hip_half_width, 0);
    const Vector3f reach = foot.ankle - hip;
    const float length = std::clamp(reach.norm(), 0.2f * body.thigh, 0.999f * (body.thigh + body.shin));
    const Vector3f axis = reach.normalized();
    const Vector3f foot_front(std::cos(foot.yaw), std::sin(foot.yaw), 0);
    const Vector3f pole = pelvis.linear().col(0) + foot_front + Vector3f(0, 0, 0.3f);
    const Vector3f out = (pole - axis * axis.dot(pole)).normalized();
    const float along = (body.thigh * body.thigh - body.shin * body.shin + length * length) / (2 * length);
    const float aside = std::sqrt(std::max(body.thigh * body.thigh - along * along, 0.0f));
    const Vector3f knee = hip + along * axis + aside * out, ankle = hip + length * axis;
    bones[thigh(side)] = transform(bone_frame(knee - hip, out), hip);
    bones[thigh(side) + 1] = transform(bone_frame(ankle - knee, out), knee);
    const Matrix3f heading = rotation(foot.yaw, Vector3f::UnitZ());
    const Matrix3f sole = heading * rotation(foot.pitch, Vector3f::UnitY());
    bones[thigh(side) + 2] = transform(sole, ankle);
    const Vector3f ball = ankle + sole * Vector3f(body.ball_ahead, 0, -body.ankle_height);
    bones[thigh(side) + 3] = transform(heading * rotation(foot.toe_pitch, Vector3f::UnitY()), ball);
}

}  // namespace

Proportions::Proportions(float stature, bool woman)
    : height(stature),
      hip_height(0.522f * stature),
      hip_half_width(0.053f * stature),
      spine_height(0.575f * stature),
      chest_height(0.650f * stature),
      neck_height(0.828f * stature),
      head_height(0.885f * stature),
      shoulder_height(0.790f * stature),
      shoulder_half_width((woman ? 0.090f : 0.102f) * stature),
      upper_arm(0.168f * stature),
      forearm(0.146f * stature),
      hand(0.100f * stature),
      thigh(0.240f * stature),
      shin(0.237f * stature),
      ankle_height(0.045f * stature),
      heel_back(0.035f * stature),
      ball_ahead(0.075f * stature),
      toe_ahead(0.115f * stature) {}

BoneTransforms solve_pose(const Proportions& body, const Posture& posture) {
    BoneTransforms bones;
    const Matrix3f heading = rotation(posture.yaw, Vector3f::UnitZ());
    bones[Pelvis] = transform(
        heading * rotation(posture.pelvis_roll, Vector3f::UnitX()) * rotation(posture.pelvis_pitch, Vector3f::UnitY()),
        posture.pelvis);
    // The trunk's own motion is shared by the two joints of the spine.
    const Matrix3f half = rotation(0.5f * posture.spine_yaw, Vector3f::UnitZ()) *
                          rotation(0.5f * posture.spine_roll, Vector3f::UnitX()) *
                          rotation(0.5f * posture.spine_pitch, Vector3f::UnitY());
    bones[Spine] = bones[Pelvis] * transform(half, {0, 0, body.spine_height - body.hip_height});
    bones[Chest] = bones[Spine] * transform(half, {0, 0, body.chest_height - body.spine_height});
    const Matrix3f neck =
        rotation(0.4f * posture.head_yaw, Vector3f::UnitZ()) * rotation(0.4f * posture.head_pitch, Vector3f::UnitY());
    const Matrix3f head =
        rotation(0.6f * posture.head_yaw, Vector3f::UnitZ()) * rotation(0.6f * posture.head_pitch, Vector3f::UnitY());
    bones[NeckBone] = bones[Chest] * transform(neck, {-0.010f * body.height, 0, body.neck_height - body.chest_height});
    bones[Head] = bones[NeckBone] * transform(head, {0.010f * body.height, 0, body.head_height - body.neck_height});
    for (const int side : {Left, Right}) {
        solve_arm(body, posture.arms[side], side, bones[Chest], bones);
        solve_leg(body, posture.feet[side], side, bones[Pelvis], bones);
    }
    return bones;
}

BoneTransforms bind_pose(const Proportions& body) {
    Posture posture;
    posture.pelvis = {0, 0, body.hip_height};
    for (const int side : {Left, Right}) {
        posture.arms[side].abduction = kBindAbduction;
        posture.feet[side].ankle = {0, sign(side) * body.hip_half_width, body.ankle_height};
    }
    return solve_pose(body, posture);
}

std::array<Vector3f, kJointCount> body_joints(const Proportions& body, const BoneTransforms& bones) {
    std::array<Vector3f, kJointCount> joints;
    const float h = body.height;
    const auto on_head = [&](float x, float y, float z) { return bones[Head] * Vector3f(x * h, y * h, z * h); };
    joints[Nose] = on_head(0.071f, 0, 0.026f);
    joints[RightEye] = on_head(0.056f, -0.018f, 0.048f);
    joints[LeftEye] = on_head(0.056f, 0.018f, 0.048f);
    joints[RightEar] = on_head(0.000f, -0.043f, 0.037f);
    joints[LeftEar] = on_head(0.000f, 0.043f, 0.037f);
    const auto limb = [&](int shoulder, int hip, int side) {
        for (int i = 0; i < 3; ++i) joints[shoulder + i] = bones[upper_arm(side) + i].translation();
        for (int i = 0; i < 3; ++i) joints[hip + i] = bones[thigh(side) + i].translation();
    };
    limb(RightShoulder, RightHip, Right);
    limb(LeftShoulder, LeftHip, Left);
    joints[Neck] = 0.5f * (joints[RightShoulder] + joints[LeftShoulder]);
    return joints;
}

}  // namespace posefusion::synth
