#pragma once
#include <array>
#include <cstdio>
#include <string>
#include <string_view>

/// Pieces of HTML.
namespace posefusion {

/// printf into a string of up to 127 characters.
template <class... Values>
std::string format(const char* pattern, Values... values) {
    std::array<char, 128> text{};
    std::snprintf(text.data(), text.size(), pattern, values...);
    return text.data();
}

/// Text that may stand anywhere in a page.
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
