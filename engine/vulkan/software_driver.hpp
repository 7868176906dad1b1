#pragma once
#include <filesystem>
#include <optional>
#include <string>

/// The software Vulkan driver that tools/setup fetched and an installation carries: newer than a distribution's, and
/// faster on processors without AVX-512. It is added to the system's drivers and replaces none of them.
namespace posefusion {

/// Its manifest (lvp_icd.json) in this build or installation; nullopt if there is none.
[[nodiscard]] std::optional<std::filesystem::path> software_driver();

/// The environment variables by which the Vulkan loader selects drivers; empty where not set.
struct DriverVariables {
    std::string driver_files;      ///< VK_DRIVER_FILES
    std::string icd_filenames;     ///< VK_ICD_FILENAMES, its older name
    std::string add_driver_files;  ///< VK_ADD_DRIVER_FILES
};
/// VK_ADD_DRIVER_FILES with `manifest` appended; nullopt if it must not change, because the user has chosen the drivers
/// or it contains the manifest already.
[[nodiscard]] std::optional<std::string> with_driver(const DriverVariables& variables, const std::string& manifest);

/// Offers software_driver() to the loader, once per process and before the first Vulkan call: by VK_ADD_DRIVER_FILES,
/// never against the user's own VK_DRIVER_FILES or VK_ICD_FILENAMES. The engine calls it itself; code that calls Vulkan
/// before the engine does (a window library) must call it first.
void offer_software_driver();

}  // namespace posefusion
