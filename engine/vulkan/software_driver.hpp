#pragma once
#include <filesystem>
#include <optional>
#include <string>

/// The software Vulkan driver that tools/setup fetched and an installation carries: newer than a distribution's, and
/// faster on processors without AVX-512. It stands beside the drivers of the system and replaces none of them.
namespace posefusion {

/// Its manifest (lvp_icd.json) in this build or installation; nullopt: there is none.
[[nodiscard]] std::optional<std::filesystem::path> software_driver();

/// What the Vulkan loader has been told of drivers: the variables of these names, empty where not set.
struct DriverVariables {
    std::string driver_files;      ///< VK_DRIVER_FILES
    std::string icd_filenames;     ///< VK_ICD_FILENAMES, its older name
    std::string add_driver_files;  ///< VK_ADD_DRIVER_FILES
};
/// VK_ADD_DRIVER_FILES with `manifest` after what is there; nullopt: it stays as it is, since the user has chosen the
/// drivers or it names the manifest already.
[[nodiscard]] std::optional<std::string> with_driver(const DriverVariables& variables, const std::string& manifest);

/// Tells the loader of software_driver(), once per process and before Vulkan's first call: by VK_ADD_DRIVER_FILES,
/// never against the user's own VK_DRIVER_FILES or VK_ICD_FILENAMES. The engine calls it itself; who calls Vulkan
/// before the engine does (a window's library) calls it first.
void offer_software_driver();

}  // namespace posefusion
