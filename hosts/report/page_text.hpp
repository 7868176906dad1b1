#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// How pages that need no network are put together: a template, values for its placeholders, and bytes as text.
namespace posefusion {

/// Names of placeholders and what takes their place.
using PageFields = std::vector<std::pair<std::string, std::string>>;

/// Replaces the @name@ placeholders of the page. Values are not searched for placeholders.
[[nodiscard]] std::string fill(std::string_view page, const PageFields& values);

/// RFC 4648.
[[nodiscard]] std::string base64(std::string_view bytes);

/// JSON for a <script> element, which "</script>" or "<!--" within a string would end.
[[nodiscard]] std::string script_json(std::string json);

}  // namespace posefusion
