#pragma once
#include "engine/slam/slam.hpp"
#include "hosts/io/image_geometry.hpp"
#include "hosts/io/recording.hpp"

namespace posefusion {

/// From now on the device of `slam` undistorts the images of frames, in parallel with tracking. Nothing changes where
/// the camera is not distorted or the images are too large for the device. Throws Error: the device is out of memory.
void undistort_on_device(ImageGeometry& geometry, const Slam& slam);

/// Inserts its time before those of the other stages of the frame.
void add_undistortion_time(const Frame& frame, FrameResult& result);

}  // namespace posefusion
