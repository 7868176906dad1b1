#pragma once
#include <string>

#include "hosts/io/camera_file.hpp"
#include "hosts/io/image_header.hpp"

namespace posefusion {

/// What calibration.json of an Azure Kinect says of the cameras with images of these sizes: the lens of colour, and
/// depth beside it. Sizes are those of the modes of the device: colour is a strip of the middle of the sensor's 4:3,
/// depth a part of its 1024x1024, whole or with pixels joined by fours.
/// Throws Error: it is damaged, of another lens model, or the depth image of an unknown mode.
/// @param name  of where it comes from, for messages
/// Source: k4atypes.h of the Azure Kinect Sensor SDK (parameters in units of the sensor's size, p2 before p1).
[[nodiscard]] CameraDescription parse_azure_calibration(const std::string& text, ImageSize color, ImageSize depth,
                                                        const std::string& name);

}  // namespace posefusion
