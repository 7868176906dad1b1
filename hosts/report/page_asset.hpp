#pragma once
#include <algorithm>
#include <span>
#include <string_view>

namespace posefusion {

/// A file of a page, embedded in the program by the build (embed_page.cmake).
struct PageAsset {
    std::string_view name, text;
};

/// @param name  of one of the files
[[nodiscard]] inline std::string_view text_of(std::span<const PageAsset> assets, std::string_view name) {
    return std::find_if(assets.begin(), assets.end(), [&](const PageAsset& a) { return a.name == name; })->text;
}

}  // namespace posefusion
