#include "hosts/io/stamp.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "engine/core/error.hpp"
#include "hosts/io/text_table.hpp"

namespace posefusion {
namespace {

constexpr std::int64_t kPerSecond = 1'000'000'000, kPerMicrosecond = 1'000;
constexpr int kDecimals = 9;          ///< of a second in nanoseconds
constexpr int kMostDigits = 19;       ///< of a 64-bit number
constexpr int kFarthestPoint = 1000;  ///< more digits before or behind the point are no stamp

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// A decimal number taken apart: 0.DIGITS times 10 to the power of `point`.
struct Decimal {
    bool negative = false;
    std::string digits;  ///< without leading zeros; empty = zero
    int point = 0;
};

std::optional<Decimal> take_apart(std::string_view text) {
    Decimal number;
    if (!text.empty() && (text.front() == '+' || text.front() == '-')) {
        number.negative = text.front() == '-';
        text.remove_prefix(1);
    }
    bool any = false, behind_point = false;
    std::size_t i = 0;
    for (; i < text.size() && (is_digit(text[i]) || (text[i] == '.' && !behind_point)); ++i) {
        if (text[i] == '.') {
            behind_point = true;
            continue;
        }
        any = true;
        if (text[i] != '0' || !number.digits.empty()) {
            number.digits += text[i];
            if (!behind_point) ++number.point;
        } else if (behind_point) {
            --number.point;  // a zero between the point and the first digit
        }
    }
    if (!any || text.size() > kFarthestPoint) return std::nullopt;
    if (i == text.size()) return number;
    if (text[i] != 'e' && text[i] != 'E') return std::nullopt;
    text.remove_prefix(i + 1);
    if (text.starts_with('+')) text.remove_prefix(1);
    int exponent = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), exponent);
    if (error != std::errc{} || end != text.data() + text.size() || std::abs(exponent) > kFarthestPoint)
        return std::nullopt;
    number.point += exponent;
    return number;
}

/// Decimals of a second that a whole number of the unit has.
int decimals_of(TimeUnit unit) {
    constexpr int kStep = 3;
    return kStep * static_cast<int>(unit);
}

std::vector<double> numbers_of(const std::vector<std::string_view>& texts) {
    std::vector<double> numbers;
    for (const std::string_view text : texts)
        if (const auto number = parse_number(text); number && std::isfinite(*number)) numbers.push_back(*number);
    return numbers;
}

double count_per_second(TimeUnit unit) { return std::pow(10.0, decimals_of(unit)); }

/// The unit in which the largest number is a time since 1970 in the years 2001 to 2286, if any.
std::optional<TimeUnit> unit_since_1970(const std::vector<double>& numbers) {
    double largest = 0;
    for (const double number : numbers) largest = std::max(largest, std::abs(number));
    for (const TimeUnit unit : kTimeUnits) {
        const double from = 1e9 * count_per_second(unit);
        if (largest >= from && largest < 10 * from) return unit;
    }
    return std::nullopt;
}

/// For messages.
const char* name_of(TimeUnit unit) {
    constexpr std::array<const char*, kTimeUnits.size()> kNames{"seconds", "milliseconds", "microseconds",
                                                                "nanoseconds"};
    return kNames[static_cast<std::size_t>(unit)];
}

}  // namespace

double to_seconds(Stamp stamp) {
    // Via the digits: the same double as parsing a text with these digits.
    return *parse_number(seconds_text(stamp));
}

Stamp stamp_of(double seconds) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), seconds).ptr;
    const std::string_view digits(text.data(), end);
    const auto stamp = parse_stamp(digits);
    if (!stamp) throw Error("time stamp " + std::string(digits) + " s is no time; give seconds");
    return *stamp;
}

std::string seconds_text(Stamp stamp) {
    const std::int64_t count = stamp.count();
    // Of the remainder, because the smallest number has no negative.
    const std::int64_t whole = count / kPerSecond, rest = std::abs(count % kPerSecond);
    const bool fine = rest % kPerMicrosecond != 0;
    const std::string decimals = std::to_string(fine ? rest : rest / kPerMicrosecond);
    std::string text = std::to_string(whole);
    if (count < 0 && whole == 0) text.insert(text.begin(), '-');
    text += '.';
    text.append((fine ? 9 : 6) - decimals.size(), '0');
    return text += decimals;
}

const char* symbol_of(TimeUnit unit) {
    constexpr std::array<const char*, kTimeUnits.size()> kSymbols{"s", "ms", "us", "ns"};
    return kSymbols[static_cast<std::size_t>(unit)];
}

std::optional<TimeUnit> time_unit(std::string_view symbol) {
    for (const TimeUnit unit : kTimeUnits)
        if (symbol == symbol_of(unit)) return unit;
    return std::nullopt;
}

std::optional<Stamp> parse_stamp(std::string_view text, TimeUnit unit) {
    auto number = take_apart(text);
    if (!number) return std::nullopt;
    const int count = number->point + kDecimals - decimals_of(unit);  // number of digits in nanoseconds
    if (number->digits.empty() || count < 0) return Stamp{0};
    if (count > kMostDigits) return std::nullopt;
    std::string& digits = number->digits;
    digits.resize(std::max(digits.size(), static_cast<std::size_t>(count) + 1), '0');
    std::uint64_t value = 0;
    for (int i = 0; i < count; ++i)
        value = 10 * value + static_cast<std::uint64_t>(digits[static_cast<std::size_t>(i)] - '0');
    if (digits[static_cast<std::size_t>(count)] >= '5') ++value;
    if (value > static_cast<std::uint64_t>(kFarthestStamp.count())) return std::nullopt;
    const auto nanoseconds = static_cast<std::int64_t>(value);
    return Stamp{number->negative ? -nanoseconds : nanoseconds};
}

double median_interval(const std::vector<std::string_view>& texts) {
    std::vector<double> numbers = numbers_of(texts), intervals;
    std::sort(numbers.begin(), numbers.end());
    for (std::size_t i = 1; i < numbers.size(); ++i)
        if (numbers[i] > numbers[i - 1]) intervals.push_back(numbers[i] - numbers[i - 1]);
    if (intervals.empty()) return 0;
    const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
    std::nth_element(intervals.begin(), middle, intervals.end());
    return *middle;
}

TimeUnit recognise_time_unit(const std::vector<std::string_view>& stamps, std::optional<TimeUnit> given,
                             const std::string& where) {
    const std::vector<double> numbers = numbers_of(stamps);
    if (numbers.empty()) return given.value_or(TimeUnit::Seconds);
    constexpr double kLongestInterval = 5;  // seconds
    const double interval = median_interval(stamps);
    const auto dense = [&](TimeUnit unit) { return interval < kLongestInterval * count_per_second(unit); };
    const auto since_1970 = unit_since_1970(numbers);
    if (since_1970 && since_1970 != TimeUnit::Seconds && dense(*since_1970)) return *since_1970;
    if (given) return *given;
    if (std::any_of(numbers.begin(), numbers.end(), [](double number) { return number != std::floor(number); }))
        return since_1970.value_or(TimeUnit::Seconds);

    const auto by_interval = std::find_if(kTimeUnits.begin(), kTimeUnits.end() - 1, dense);  // the last takes the rest
    const auto of_1970 = std::find(kTimeUnits.begin(), kTimeUnits.end(), since_1970.value_or(*by_interval));
    if (by_interval - of_1970 == 1)
        throw Error(where + ": the time stamps may be " + name_of(*of_1970) + " since 1970, far apart, or " +
                    name_of(*by_interval) + "; say which with --time-unit");
    return *by_interval;
}

}  // namespace posefusion
