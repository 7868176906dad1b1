#pragma once
#include <string>

#include "engine/core/image.hpp"
#include "hosts/io/image_header.hpp"

/// Depth in OpenEXR images, as renderers write it.
namespace posefusion {

[[nodiscard]] bool is_exr(ByteView bytes);

/// Size of the data window. Throws Error: damaged, larger than any camera's.
[[nodiscard]] ImageSize exr_size(ByteView bytes, const std::string& name);

/// The values of the depth channel, unchanged: Z, depth.Z, V, Y, ... or the only one; R of a grey image in R G B.
/// Throws Error: damaged, truncated, or no such channel.
[[nodiscard]] Image<float> decode_exr_depth(ByteView bytes, const std::string& name);

}  // namespace posefusion
