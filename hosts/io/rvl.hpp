#pragma once
#include <string>

#include "hosts/io/image_file.hpp"

/// RVL, the lossless compression of depth images of A. Wilson, "Fast Lossless Depth Image Compression" (ISS 2017): runs
/// of zeros and of measurements in turn, each measurement as its difference from the one before.
namespace posefusion {

/// Throws Error: the stream ends early, holds more pixels than `size`, or values out of range.
/// @param name  what the bytes are, for the message
[[nodiscard]] RawDepth decode_rvl(ByteView bytes, ImageSize size, const std::string& name);

}  // namespace posefusion
