#pragma once
#include <charconv>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>

/// Numbers as text and back, with a decimal point whatever the locale: printf, strtod, std::to_string and streams
/// follow the locale of the process, which belongs to the program that uses this library.
namespace posefusion {

/// The shortest text that reads back as the same number.
template <class Number>
[[nodiscard]] std::string shortest_text(Number value) {
    char text[64];
    return {text, std::to_chars(std::begin(text), std::end(text), value).ptr};
}

/// With this many decimals, rounded, as %f writes it.
[[nodiscard]] inline std::string fixed_text(double value, int decimals) {
    char text[512];  // the largest double has 309 digits before the point
    const auto end = std::to_chars(std::begin(text), std::end(text), value, std::chars_format::fixed, decimals).ptr;
    return {text, end};
}

/// "1 frame", "12 frames"; irregular plurals are given.
template <class Number>
[[nodiscard]] std::string counted(Number count, const std::string& one, const std::string& many = {}) {
    return shortest_text(count) + ' ' + (count == 1 ? one : many.empty() ? one + 's' : many);
}

/// The number that the whole text is; nullopt if it is not one.
template <class Number>
[[nodiscard]] std::optional<Number> number_of(std::string_view text) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace posefusion
