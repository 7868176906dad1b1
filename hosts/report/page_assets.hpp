#pragma once
#include "hosts/report/page_asset.hpp"

namespace posefusion {

/// page.html, page.css and page.js of this folder.
[[nodiscard]] std::span<const PageAsset> report_page_assets();

}  // namespace posefusion
