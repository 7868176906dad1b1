#pragma once
#include <string>
#include <vector>

#include "pose/joints.hpp"
#include "pose/people.hpp"
#include "pose/tensor.hpp"

/// MoveNet MultiPose (Google, a CenterNet: Zhou et al., Objects as Points, 2019): decoding of its six heads.
namespace posefusion {

/// The heads, raw (before the sigmoid). One cell covers 4 x 4 pixels of the input; pairs of channels are (y, x), in
/// cells.
struct MoveNetMaps {
    Tensor center;       ///< [1] a person's centre is here
    Tensor box_scale;    ///< [2] height and width of the person's box
    Tensor box_offset;   ///< [2] from the cell to the centre of the box
    Tensor kpt_heatmap;  ///< [17] a joint of any person is here
    Tensor kpt_regress;  ///< [34] from a centre's cell to its 17 joints
    Tensor kpt_offset;   ///< [34] from a joint's cell to the joint
};

/// Names of the heads in the ONNX model, in the order of MoveNetMaps; tools/convert_movenet gives them.
[[nodiscard]] const std::vector<std::string>& movenet_outputs();

/// Takes the outputs of the network, in the order of movenet_outputs(). Throws Error if the shapes are not MoveNet's.
[[nodiscard]] MoveNetMaps movenet_maps(std::vector<Tensor> outputs);

inline constexpr int kMoveNetInputStride = 32;  ///< sides of the input are multiples of this, pixels

struct MoveNetDecoding {
    float center_threshold =
        0.1f;  ///< minimum sigmoid(center) of a candidate; furniture may pass here, but is rejected by its joints
    float person_threshold = 0.28f;  ///< minimum score: sqrt(sigmoid(center) * mean certainty of the best joints)
    float joint_threshold = 0.2f;    ///< less certain joints get p = 0
    int min_joints = 3;              ///< people with fewer joints are dropped: mostly furniture
    int peak_window = 5;             ///< a centre is the maximum of this many cells squared
    int score_joints =
        5;  ///< the score is the mean of this many best joints: few enough for people who are partly out of view
    /// Trust in a heat map fades with the distance d (cells) from the regressed joint as exp(-d^2 / fade),
    /// fade = max(joint_spread * min(height, width), (box_spread * diagonal of the person's box)^2).
    /// The first is the network's own; it is too narrow for people who fill the image.
    float joint_spread = 0.3f;
    float box_spread = 0.15f;
    DuplicateRule duplicate{};
};

/// People in pixels of an image of image_width x image_height, most certain first. Pure function.
[[nodiscard]] People decode_movenet(const MoveNetMaps& maps, int image_width, int image_height,
                                    const MoveNetDecoding& decoding);

}  // namespace posefusion
