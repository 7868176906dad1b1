#pragma once
#include <memory>

#include "hosts/io/frame_source.hpp"

namespace posefusion {

/// The selected frames of a source as a source of their own: of a recording by number and stamp, of a camera as they
/// arrive. Throws Error when none is left.
[[nodiscard]] std::unique_ptr<FrameSource> select_frames(std::unique_ptr<FrameSource> source,
                                                         const FrameSelection& selection);

}  // namespace posefusion
