#pragma once
#include <optional>
#include <string>
#include <vector>

#include "hosts/io/depth_registration.hpp"
#include "hosts/io/sources/bags/bag_topics.hpp"

/// The cameras of the chosen topics of a bag.
namespace posefusion {

struct BagCamera {
    Camera camera;                                  ///< of colour, with the depth unit
    std::optional<DepthRegistration> registration;  ///< for depth that is not registered or has another size
};

/// options.camera_file, else the camera_info of the topics. Depth of another camera is registered by its own
/// camera_info and the motion between the two, as RealSense writes it or as /tf_static and /tf tell it; without that,
/// both are assumed to be at the same place, with a warning. The depth unit is a millimetre for 16-bit images (or what
/// RealSense's option says, or the camera file) and a metre for float ones. Throws Error.
[[nodiscard]] BagCamera find_bag_camera(const MessageBag& bag, const BagTopics& topics, const SourceOptions& options,
                                        std::vector<std::string>& warnings);

}  // namespace posefusion
