#pragma once
#include "hosts/report/page_asset.hpp"

namespace posefusion {

/// The files of the folder page/.
[[nodiscard]] std::span<const PageAsset> web_page_assets();

}  // namespace posefusion
