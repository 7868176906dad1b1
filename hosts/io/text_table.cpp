#include "hosts/io/text_table.hpp"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

/// A list of a day at 1 kHz is smaller; anything larger is not a list.
constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 33;

bool is_separator(char c) { return c == ' ' || c == '\t' || c == ',' || c == '\r' || c == '\v' || c == '\f'; }

std::vector<std::string> split(std::string_view line) {
    std::vector<std::string> fields;
    std::size_t i = 0;
    while (i < line.size()) {
        while (i < line.size() && is_separator(line[i])) ++i;
        const std::size_t begin = i;
        while (i < line.size() && !is_separator(line[i])) ++i;
        if (i > begin) fields.emplace_back(line.substr(begin, i - begin));
    }
    return fields;
}

}  // namespace

std::vector<TextLine> read_text_table(const std::filesystem::path& file) {
    std::error_code error;
    const auto status = std::filesystem::status(file, error);
    if (!std::filesystem::exists(status)) throw Error(file.string() + ": no such file");
    if (std::filesystem::is_directory(status)) throw Error(file.string() + ": is a folder, not a file");
    if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(file, error) > kMaxBytes)
        throw Error(file.string() + ": too large for a list of time stamps");
    std::ifstream in(file, std::ios::binary);
    if (!in) throw Error(file.string() + ": cannot be read: " + std::strerror(errno));

    std::vector<TextLine> lines;
    std::string text;
    for (std::size_t number = 1; std::getline(in, text); ++number) {
        std::string_view line = text;
        if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
        auto fields = split(line);
        if (fields.empty() || fields.front().front() == '#') continue;
        lines.push_back({number, std::move(fields)});
    }
    if (in.bad()) throw Error(file.string() + ": cannot be read to its end");
    return lines;
}

std::optional<double> parse_number(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace posefusion
