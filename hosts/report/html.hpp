#pragma once
#include <string>
#include <string_view>

/// Pieces of HTML.
namespace posefusion {

/// Text escaped for use anywhere in a page.
[[nodiscard]] inline std::string escaped(std::string_view text) {
    std::string html;
    for (const char c : text) {
        switch (c) {
            case '<':
                html += "&lt;";
                break;
            case '>':
                html += "&gt;";
                break;
            case '&':
                html += "&amp;";
                break;
            case '"':
                html += "&quot;";
                break;
            default:
                html += c;
        }
    }
    return html;
}

}  // namespace posefusion
