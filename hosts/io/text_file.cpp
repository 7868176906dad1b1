#include "hosts/io/text_file.hpp"

#include <cstddef>
#include <string_view>

#include "engine/core/error.hpp"
#include "hosts/io/input_file.hpp"

namespace posefusion {
namespace {

constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF", kLittleEndianMark = "\xFF\xFE", kBigEndianMark = "\xFE\xFF";
constexpr char32_t kReplacement = 0xFFFD;  ///< stands for what is no character

void append_utf8(std::string& text, char32_t c) {
    const auto put = [&](char32_t byte) { text.push_back(static_cast<char>(byte)); };
    const auto rest = [&](int shift) { put(0x80 | (c >> shift & 0x3F)); };
    if (c < 0x80) {
        put(c);
    } else if (c < 0x800) {
        put(0xC0 | c >> 6);
        rest(0);
    } else if (c < 0x10000) {
        put(0xE0 | c >> 12);
        rest(6);
        rest(0);
    } else {
        put(0xF0 | c >> 18);
        rest(12);
        rest(6);
        rest(0);
    }
}

std::string from_utf16(std::string_view bytes, bool big_endian) {
    const auto unit = [&](std::size_t i) {
        const auto first = static_cast<unsigned char>(bytes[i]), second = static_cast<unsigned char>(bytes[i + 1]);
        return static_cast<char32_t>(big_endian ? first << 8 | second : second << 8 | first);
    };
    const auto is_high = [](char32_t c) { return c >= 0xD800 && c < 0xDC00; };
    const auto is_low = [](char32_t c) { return c >= 0xDC00 && c < 0xE000; };
    std::string text;
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
        char32_t c = unit(i);
        if (is_high(c) && i + 3 < bytes.size() && is_low(unit(i + 2))) {
            c = 0x10000 + ((c - 0xD800) << 10) + (unit(i + 2) - 0xDC00);
            i += 2;
        } else if (is_high(c) || is_low(c)) {
            c = kReplacement;
        }
        append_utf8(text, c);
    }
    return text;
}

}  // namespace

std::string to_utf8(std::string bytes) {
    const std::string_view view(bytes);
    if (view.starts_with(kUtf8Mark)) return bytes.substr(kUtf8Mark.size());
    if (view.starts_with(kLittleEndianMark)) return from_utf16(view.substr(2), false);
    if (view.starts_with(kBigEndianMark)) return from_utf16(view.substr(2), true);
    return bytes;
}

std::string read_text_file(const std::filesystem::path& file, std::uintmax_t max_bytes) {
    const InputFile input(file);
    if (input.size() > max_bytes)
        throw Error(file.string() + ": is too large (" + std::to_string(input.size()) + " bytes) for what it is to be");
    const ByteBuffer bytes = input.read(0, static_cast<std::size_t>(input.size()));
    return to_utf8({bytes.begin(), bytes.end()});
}

}  // namespace posefusion
