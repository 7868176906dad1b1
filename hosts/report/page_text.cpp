#include "hosts/report/page_text.hpp"

#include <algorithm>

namespace posefusion {

std::string base64(std::string_view bytes) {
    static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto byte = [&](std::size_t j) {
            return j < bytes.size() ? static_cast<unsigned>(static_cast<unsigned char>(bytes[j])) : 0u;
        };
        const unsigned block = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
        text += kDigits[block >> 18];
        text += kDigits[block >> 12 & 63];
        text += i + 1 < bytes.size() ? kDigits[block >> 6 & 63] : '=';
        text += i + 2 < bytes.size() ? kDigits[block & 63] : '=';
    }
    return text;
}

std::string fill(std::string_view page, const PageFields& values) {
    std::string result;
    for (std::size_t at = 0; at < page.size();) {
        const std::size_t open = page.find('@', at);
        if (open == std::string_view::npos) return result.append(page.substr(at));
        result.append(page.substr(at, open - at));
        const std::size_t close = page.find('@', open + 1);
        const auto name =
            close == std::string_view::npos ? std::string_view{} : page.substr(open + 1, close - open - 1);
        const auto value = std::find_if(values.begin(), values.end(), [&](const auto& v) { return v.first == name; });
        if (value != values.end())
            result += value->second;
        else
            result += '@';
        at = value != values.end() ? close + 1 : open + 1;
    }
    return result;
}

std::string script_json(std::string json) {
    for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos;) json.replace(at, 1, "\\u003c");
    return json;
}

}  // namespace posefusion
