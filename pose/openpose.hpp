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
    float person_threshold =
        0.28f;                     ///< minimum score: sqrt(mean certainty of the best joints * mean of the best links)
    float joint_threshold = 0.2f;  ///< less certain joints get p = 0
    float peak_threshold = 0.1f;   ///< minimum heat of a candidate joint; links may confirm a weak one
    int peaks_per_joint = 2 * kMaxPeople;  ///< only the strongest are looked at
    int link_samples = 10;                 ///< points on the line between two joints at which the field is read
    float sample_threshold = 0.05f;        ///< a point agrees if the field along the line is at least this, [0, 1]
    float agreeing_share = 0.7f;  ///< minimum share of points that must agree; below 1, as limbs may be half hidden
    float longest_limb = 0.5f;    ///< longer limbs, as share of the map's larger side, lose score
    int min_joints = 3;           ///< people with fewer joints found are dropped
    int score_joints = 5;         ///< the score is the mean of this many best joints (and one link less)
    DuplicateRule duplicate{};
};

/// People in pixels of an image of image_width x image_height, most certain first. Pure function.
/// Links are made in the order of their scores over all limbs at once (the ear to shoulder links included), so that a
/// missing joint, a hidden neck for example, does not disconnect what other links connect.
[[nodiscard]] People decode_openpose(const OpenPoseMaps& maps, int image_width, int image_height,
                                     const OpenPoseDecoding& decoding);

}  // namespace posefusion
