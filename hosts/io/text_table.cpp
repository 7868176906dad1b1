#include "hosts/io/text_table.hpp"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <utility>

#include "engine/core/error.hpp"
#include "hosts/io/text_file.hpp"

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

/// Leaves the stream at its beginning.
bool is_utf16(std::istream& in) {
    char mark[2] = {};
    in.read(mark, sizeof mark);
    const bool wide = in.gcount() == sizeof mark &&
                      (std::string_view(mark, 2) == "\xFF\xFE" || std::string_view(mark, 2) == "\xFE\xFF");
    in.clear();
    in.seekg(0);
    return wide;
}

}  // namespace

std::vector<TextLine> read_text_table(const std::filesystem::path& file, Comments comments) {
    std::error_code error;
    const auto status = std::filesystem::status(file, error);
    if (!std::filesystem::exists(status)) throw Error(file.string() + ": no such file");
    if (std::filesystem::is_directory(status)) throw Error(file.string() + ": is a folder, not a file");
    if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(file, error) > kMaxBytes)
        throw Error(file.string() + ": too large for a list of time stamps");
    std::ifstream bytes(file, std::ios::binary);
    if (!bytes) throw Error(file.string() + ": cannot be read: " + std::strerror(errno));
    std::istringstream converted;
    const bool wide = is_utf16(bytes);
    if (wide) converted.str(to_utf8({std::istreambuf_iterator<char>(bytes), {}}));
    std::istream& in = wide ? static_cast<std::istream&>(converted) : bytes;

    std::vector<TextLine> lines;
    std::string text;
    for (std::size_t number = 1; std::getline(in, text); ++number) {
        if (number == 1) text = to_utf8(std::move(text));  // a mark of UTF-8
        auto fields = split(text);
        if (fields.empty() || (fields.front().front() == '#' && comments == Comments::Drop)) continue;
        const bool commas = text.find(',') != std::string::npos;
        lines.push_back({number, std::move(text), std::move(fields), commas});
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
