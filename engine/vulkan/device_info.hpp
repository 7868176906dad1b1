#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace posefusion {

/// What a user needs to know to choose a Vulkan device. No Vulkan header is needed to read it.
struct DeviceInfo {
    int index = 0;
    std::string name;
    std::string driver;
    std::string api_version;
    std::string kind;                ///< "discrete", "integrated", "cpu", ...
    std::uint64_t memory_bytes = 0;  ///< device-local
    std::uint32_t subgroup_size = 0;
    bool int64_atomics = false;        ///< without them the two-pass 32-bit depth test is used
    std::vector<std::string> missing;  ///< what PoseFusion needs and the device lacks; empty = usable
};

/// All Vulkan devices of this machine; empty if there is no Vulkan loader or driver.
[[nodiscard]] std::vector<DeviceInfo> list_devices();

}  // namespace posefusion
