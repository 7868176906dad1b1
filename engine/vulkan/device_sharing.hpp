#pragma once
#include <string>
#include <vector>

namespace posefusion {

/// Requirements of a renderer that shares the engine's device. The engine itself draws nothing and knows no window.
struct DeviceSharing {
    std::vector<std::string> instance_extensions;  ///< names of Vulkan instance extensions, those of a window's surface
    std::vector<std::string> device_extensions;    ///< a device without them cannot be used
    bool graphics = false;                         ///< the queue must support graphics, and points may have any size
};

}  // namespace posefusion
