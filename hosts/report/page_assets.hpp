#pragma once
#include <string_view>

/// The files page.html, page.css and page.js of this folder, embedded in the program by the build.
namespace posefusion {

extern const std::string_view kPage_html;
extern const std::string_view kPage_css;
extern const std::string_view kPage_js;

}  // namespace posefusion
