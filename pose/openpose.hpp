#pragma once
#include <vector>

#include "pose/joints.hpp"
#include "pose/people.hpp"
#include "pose/tensor.hpp"

/// Networks of the OpenPose format with the 18 COCO joints (Cao et al., Realtime Multi-Person 2D Pose Estimation using
/// Part Affinity Fields, CVPR 2017): decoding of heat maps and part affinity fields (PAF).
namespace posefusion {

inline constexpr int kOpenPoseInputStride = 8;  ///< sides of the input are multiples of this, pixels

struct OpenPoseMaps {
    Tensor heat;  ///< [19] one map per joint, in the order of Joint, and the background
    Tensor paf;   ///< [38] 19 fields of unit vectors (x, y) that point along a limb, in the order of OpenPose
};

/// Finds the maps in a network's outputs: two outputs of 19 and 38 channels in any order (of several stages the last),
/// or one of 57 with either first; the background, which is near 1 almost everywhere, tells which. Throws Error if
/// there is no such pair.
[[nodiscard]] OpenPoseMaps openpose_maps(std::vector<Tensor> outputs);

struct OpenPoseDecoding {
    float person_threshold = 0.28f;  ///< least score: sqrt(mean certainty of the best joints * mean of the best links)
    float joint_threshold = 0.2f;    ///< joints less certain get p = 0
    float peak_threshold = 0.1f;     ///< least heat of a candidate joint; links may confirm a weak one
    int peaks_per_joint = 2 * kMaxPeople;  ///< only the strongest are looked at
    int link_samples = 10;                 ///< points on the line between two joints at which the field is read
    float sample_threshold = 0.05f;        ///< a point agrees if the field along the line is at least this, [0, 1]
    float agreeing_share = 0.7f;  ///< least share of points that must agree; below 1, as limbs may be half hidden
    float longest_limb = 0.5f;    ///< longer limbs, as share of the map's larger side, lose score
    int least_joints = 3;         ///< people with fewer joints found are dropped
    int score_joints = 5;         ///< how many of the best joints (and one link less) speak for a person
    DuplicateRule duplicate{};
};

/// People in pixels of an image of image_width x image_height, most certain first. Pure function.
/// Joints are linked best link first over all limbs at once (the ear to shoulder links included), so that a missing
/// link or joint, a hidden neck say, does not cut off what other links hold.
[[nodiscard]] People decode_openpose(const OpenPoseMaps& maps, int image_width, int image_height,
                                     const OpenPoseDecoding& decoding);

}  // namespace posefusion
