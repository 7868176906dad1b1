#pragma once
#include "hosts/io/frame_source.hpp"

namespace posefusion {

/// A camera that OpenNI2 knows (PrimeSense, Kinect-like, Orbbec), colour and depth registered to each other and paired
/// within 20 ms. The camera comes from options.camera_file, else from the fields of view that the device reports, with
/// a warning. Its frames have the stamps of the device.
/// @param uri  as OpenNI2 names devices; empty = the first one
[[nodiscard]] std::unique_ptr<FrameSource> open_openni_camera(const std::string& uri, const SourceOptions& options);

/// Whether this program was built with it.
[[nodiscard]] bool has_openni();

}  // namespace posefusion
