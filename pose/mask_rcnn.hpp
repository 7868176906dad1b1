#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "pose/person_masker.hpp"

namespace posefusion {

struct MaskRcnnConfig {
    std::filesystem::path model;  ///< .onnx
    float threshold = 0.5f;       ///< detections with a lower score are dropped, [0, 1]
    std::vector<int> classes;     ///< class numbers of people; empty = 1, as in COCO
    int threads = 2;              ///< CPU threads of the network
};

/// An instance segmentation network in ONNX Runtime, in the format to which torchvision exports Mask R-CNN. One
/// input: float R G B in 0..1, [3, height, width] or [1, 3, height, width], of any or of a fixed size. Outputs by name:
/// `labels` [n] (integers), `scores` [n] (0..1), `masks` [n, 1, height, width] or [n, height, width] (0..1, inside
/// where >= 0.5); others are ignored. Where people overlap, the one with the higher score is in front.
/// Throws Error if the model is missing, damaged or of another format.
[[nodiscard]] std::unique_ptr<PersonMasker> make_mask_rcnn(const MaskRcnnConfig& config);

}  // namespace posefusion
