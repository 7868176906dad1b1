#include "hosts/io/listed_path.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

#include "hosts/io/image_header.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr char kQuote = '"';

/// Where the fields of a line begin in its text.
std::vector<std::size_t> beginnings(const TextLine& line) {
    std::vector<std::size_t> begin;
    std::size_t at = 0;
    for (const std::string& field : line.fields) {
        at = line.text.find(field, at);
        begin.push_back(at);
        at += field.size();
    }
    return begin;
}

}  // namespace

ListedPath take_path(const TextLine& line, std::size_t first) {
    const std::vector<std::size_t> begin = beginnings(line);
    const std::string_view text = line.text;
    if (text[begin[first]] == kQuote) {
        const std::size_t inside = begin[first] + 1, end = text.find(kQuote, inside);
        if (end != std::string_view::npos) {
            const auto next = std::upper_bound(begin.begin(), begin.end(), end);
            return {std::string(text.substr(inside, end - inside)), static_cast<std::size_t>(next - begin.begin())};
        }
    }
    const auto named = std::find_if(line.fields.begin() + static_cast<std::ptrdiff_t>(first), line.fields.end(),
                                    [](const std::string& field) { return has_image_ending(field); });
    if (named == line.fields.end()) return {line.fields[first], first + 1};
    const auto last = static_cast<std::size_t>(named - line.fields.begin());
    const std::size_t end = begin[last] + named->size();
    return {std::string(text.substr(begin[first], end - begin[first])), last + 1};
}

fs::path resolve_path(const fs::path& folder, const std::string& path) {
    fs::path file = folder / path;
    std::error_code error;
    if (path.find('\\') == std::string::npos || fs::exists(file, error)) return file;
    std::string with_slashes = path;
    std::replace(with_slashes.begin(), with_slashes.end(), '\\', '/');
    return folder / with_slashes;
}

}  // namespace posefusion
