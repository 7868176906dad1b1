#pragma once
#include <string>
#include <vector>

namespace posefusion {

/// What somebody who draws with the engine's device asks of it. The engine itself draws nothing and knows no window.
struct DeviceSharing {
    std::vector<std::string> instance_extensions;  ///< Vulkan's names; those of a window's surface
    std::vector<std::string> device_extensions;    ///< a device without them cannot be used
    bool graphics = false;                         ///< the queue must draw, too, and points may be of any size
};

}  // namespace posefusion
