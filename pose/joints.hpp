#pragma once
#include <array>
#include <vector>

/// Body joints as the paper's eq. (1) writes them: for each person a row of 18 OpenPose (COCO) joints (u, v, p).
namespace posefusion {

enum Joint : int {
    Nose,
    Neck,
    RightShoulder,
    RightElbow,
    RightWrist,
    LeftShoulder,
    LeftElbow,
    LeftWrist,
    RightHip,
    RightKnee,
    RightAnkle,
    LeftHip,
    LeftKnee,
    LeftAnkle,
    RightEye,
    LeftEye,
    RightEar,
    LeftEar,
};
inline constexpr int kJointCount = 18;
inline constexpr int kMaxPeople = 15;

/// One entry of eq. (1). (u, v) in pixels of the FULL colour image, p in [0, 1]; p = 0 means "not found".
struct JointObservation {
    float u = 0, v = 0, p = 0;
};

/// Axis-aligned box in pixels of the full colour image.
struct PixelBox {
    float u_min = 0, v_min = 0, u_max = 0, v_max = 0;
    [[nodiscard]] bool empty() const { return u_max <= u_min || v_max <= v_min; }
};

struct Person {
    std::array<JointObservation, kJointCount> joints{};
    float score = 0;  ///< confidence that this is a person, [0, 1]
    PixelBox box{};   ///< extent of the body where the network gives one (MoveNet), else the box of the joints
};

/// At most kMaxPeople, most confident first.
using People = std::vector<Person>;

/// Pairs of joints that a limb connects (the 17 edges drawn by OpenPose plus the two shoulder-to-ear links left out).
inline constexpr std::array<std::array<int, 2>, 17> kLimbs{{
    {Neck, RightShoulder},
    {Neck, LeftShoulder},
    {RightShoulder, RightElbow},
    {RightElbow, RightWrist},
    {LeftShoulder, LeftElbow},
    {LeftElbow, LeftWrist},
    {Neck, RightHip},
    {RightHip, RightKnee},
    {RightKnee, RightAnkle},
    {Neck, LeftHip},
    {LeftHip, LeftKnee},
    {LeftKnee, LeftAnkle},
    {Neck, Nose},
    {Nose, RightEye},
    {RightEye, RightEar},
    {Nose, LeftEye},
    {LeftEye, LeftEar},
}};

}  // namespace posefusion
