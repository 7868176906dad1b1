#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace posefusion {

/// Description of a Vulkan device, for choosing one. No Vulkan header is needed to read it.
struct DeviceInfo {
    int index = 0;
    std::string name;
    std::string driver;                ///< name and version in words
    std::uint32_t driver_version = 0;  ///< from the driver's description, larger = newer; 0 if there is none
    std::string api_version;
    std::string kind;                ///< "discrete", "integrated", "cpu", ...
    std::uint64_t memory_bytes = 0;  ///< device-local
    std::uint32_t subgroup_size = 0;
    bool int64_atomics = false;        ///< without them the two-pass 32-bit depth test is used
    std::vector<std::string> missing;  ///< required features that the device lacks; empty = usable
};

/// All Vulkan devices of this machine; empty if there is no Vulkan loader or driver.
[[nodiscard]] std::vector<DeviceInfo> list_devices();

/// The chosen device, and why.
struct DeviceChoice {
    std::size_t index = 0;  ///< into the devices
    std::string reason;     ///< e.g. "the newest software driver"
};
/// Discrete before integrated, virtual and software devices; of software devices the one of the newest driver.
/// @param wanted  part of a device's name or driver (any case), or its index; empty = the best one
/// Throws Error that lists the devices if no usable one matches.
[[nodiscard]] DeviceChoice choose_device(const std::vector<DeviceInfo>& devices, const std::string& wanted);

}  // namespace posefusion
