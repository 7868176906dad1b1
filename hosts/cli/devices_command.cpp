#include <fmt/format.h>

#include "engine/core/error.hpp"
#include "engine/vulkan/device_info.hpp"
#include "hosts/cli/commands.hpp"

namespace posefusion {

int devices_command() {
    const std::vector<DeviceInfo> devices = list_devices();
    if (devices.empty()) {
        throw Error("no Vulkan device found; install a driver (Debian: mesa-vulkan-drivers works without a GPU)");
    }
    for (const DeviceInfo& device : devices) {
        fmt::print("{}  {}\n   {}, Vulkan {}, {}, {:.1f} GiB, subgroups of {}, 64-bit atomics: {}\n", device.index,
                   device.name, device.kind, device.api_version, device.driver,
                   static_cast<double>(device.memory_bytes) / (1024.0 * 1024.0 * 1024.0), device.subgroup_size,
                   device.int64_atomics ? "yes" : "no (two 32-bit passes instead)");
        if (device.missing.empty()) fmt::print("   usable\n");
        for (const std::string& lack : device.missing) fmt::print("   lacks {}\n", lack);
    }
    const DeviceChoice choice = choose_device(devices, "");
    const DeviceInfo& chosen = devices[choice.index];
    fmt::print("Without --device: {} ({}), {}.\n", chosen.index, chosen.driver, choice.reason);
    return kExitOk;
}

}  // namespace posefusion
