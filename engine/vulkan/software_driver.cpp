#include "engine/vulkan/software_driver.hpp"

#include <cstdlib>
#include <mutex>

#include "engine/core/installed_file.hpp"

namespace posefusion {
namespace {

constexpr const char* kManifest = "lvp_icd.json";
constexpr char kSeparator = ':';  // between the loader's file names

std::string variable(const char* name) {
    const char* value = std::getenv(name);
    return value == nullptr ? "" : value;
}

}  // namespace

std::optional<std::filesystem::path> software_driver() {
    static const char anchor = 0;
    if (auto installed = installed_file(&anchor, std::filesystem::path("driver") / kManifest)) return installed;
    std::filesystem::path built = std::filesystem::path(POSEFUSION_DRIVER_DIR) / kManifest;
    std::error_code failed;
    if (std::filesystem::is_regular_file(built, failed)) return built;
    return std::nullopt;
}

std::optional<std::string> with_driver(const DriverVariables& variables, const std::string& manifest) {
    if (!variables.driver_files.empty() || !variables.icd_filenames.empty()) return std::nullopt;
    const std::string& added = variables.add_driver_files;
    if (added.empty()) return manifest;
    const bool there = (kSeparator + added + kSeparator).find(kSeparator + manifest + kSeparator) != std::string::npos;
    if (there) return std::nullopt;
    return added + kSeparator + manifest;
}

void offer_software_driver() {
    static std::once_flag once;
    std::call_once(once, [] {
        const auto manifest = software_driver();
        if (!manifest) return;
        const auto files =
            with_driver({variable("VK_DRIVER_FILES"), variable("VK_ICD_FILENAMES"), variable("VK_ADD_DRIVER_FILES")},
                        manifest->string());
        if (files) setenv("VK_ADD_DRIVER_FILES", files->c_str(), 1);
    });
}

}  // namespace posefusion
