#pragma once
#include <dlfcn.h>
#include <link.h>

#include <filesystem>
#include <optional>

namespace posefusion {

/// A data file of an installed PoseFusion: share/posefusion/NAME in a folder above the program or shared library that
/// holds the code or constant at `inside` (PREFIX/bin, PREFIX/lib, PREFIX/lib/x86_64-linux-gnu, ...). The installation
/// may be moved.
/// @return nullopt where there is no such file, for example in a build tree
[[nodiscard]] inline std::optional<std::filesystem::path> installed_file(const void* inside,
                                                                         const std::filesystem::path& name) {
    constexpr int kLevels = 5;  // PREFIX/lib/python3/dist-packages/posefusion
    Dl_info info{};
    link_map* object = nullptr;
    if (dladdr1(inside, &info, reinterpret_cast<void**>(&object), RTLD_DL_LINKMAP) == 0 || object == nullptr)
        return std::nullopt;
    const bool program = object->l_name == nullptr || *object->l_name == '\0';
    std::error_code failed;
    std::filesystem::path folder = std::filesystem::canonical(program ? "/proc/self/exe" : object->l_name, failed);
    for (int level = 0; level < kLevels && folder.has_relative_path() && !failed; ++level) {
        folder = folder.parent_path();
        const std::filesystem::path file = folder / "share" / "posefusion" / name;
        if (std::filesystem::is_regular_file(file, failed)) return file;
        failed.clear();
    }
    return std::nullopt;
}

}  // namespace posefusion
