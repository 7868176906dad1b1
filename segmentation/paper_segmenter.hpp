#pragma once
#include <memory>

#include "segmentation/segmenter.hpp"

namespace posefusion {

/// The paper's own step 2, the reference: SegmentationMode::Paper. One cut for all people over the points of the
/// depth image thinned out to SegmentationConfig::paper_step pixels; seeds are the joints and points along the limbs
/// with the depth read there. Every frame is segmented on its own: no mask without joints.
[[nodiscard]] std::unique_ptr<Segmenter> make_paper_segmenter(const SegmentationConfig& config,
                                                              const Intrinsics& camera);

}  // namespace posefusion
