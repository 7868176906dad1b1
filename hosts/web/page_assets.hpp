#pragma once
#include <span>
#include <string_view>

namespace posefusion {

/// A file of the folder page/, embedded in the program by the build.
struct PageAsset {
    std::string_view name, text;
};

[[nodiscard]] std::span<const PageAsset> web_page_assets();

}  // namespace posefusion
