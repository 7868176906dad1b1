#pragma once
#include <memory>

#include "segmentation/segmenter.hpp"

namespace posefusion {

/// Min-cut on the organised image with the 3-D distance to the body: SegmentationMode::Image.
[[nodiscard]] std::unique_ptr<Segmenter> make_image_segmenter(const SegmentationConfig& config,
                                                              const Intrinsics& camera, const DepthNoise& noise);

}  // namespace posefusion
