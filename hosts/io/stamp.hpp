#pragma once
#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Time stamps of images and poses, exact to the nanosecond. A double of seconds since 1970 has a resolution of 0.24
/// microseconds: sufficient for intervals, but not for distinguishing stamps, pairing them or writing them out again.
namespace posefusion {

/// Relative to the epoch of the recording: 1970, the start of the device, the first frame ... Limited to 146 years.
using Stamp = std::chrono::nanoseconds;
/// Input is limited to this, so that sums and differences of two stamps do not overflow.
inline constexpr Stamp kFarthestStamp{std::int64_t{1} << 62};

/// The nearest double.
[[nodiscard]] double to_seconds(Stamp stamp);

/// The stamp of a double, by its shortest unique decimal representation: 1305031102.175304 s keeps these six decimals,
/// without the rounding error of the double. Throws Error: not finite, or out of reach.
[[nodiscard]] Stamp stamp_of(double seconds);

/// Seconds with six decimals, or nine if six are not exact: "1305031102.175304", "1403636579.763555584".
[[nodiscard]] std::string seconds_text(Stamp stamp);

enum class TimeUnit { Seconds, Milliseconds, Microseconds, Nanoseconds };
inline constexpr std::array kTimeUnits{TimeUnit::Seconds, TimeUnit::Milliseconds, TimeUnit::Microseconds,
                                       TimeUnit::Nanoseconds};
[[nodiscard]] const char* symbol_of(TimeUnit unit);  ///< "s", "ms", "us", "ns"
/// nullopt if it is none of these symbols.
[[nodiscard]] std::optional<TimeUnit> time_unit(std::string_view symbol);

/// A decimal number, also one like 1.403636579763555584e+18, in that unit, parsed without rounding to a double; rounded
/// to nanoseconds. nullopt: not a number, not finite, or out of reach.
[[nodiscard]] std::optional<Stamp> parse_stamp(std::string_view text, TimeUnit unit = TimeUnit::Seconds);

/// The median interval of the numbers among the texts, sorted and without repetitions; 0 for fewer than two.
[[nodiscard]] double median_interval(const std::vector<std::string_view>& numbers);

/// The time unit of a file. Stamps do not state it, but
///   - numbers of 13, 16 or 19 digits before the point count milli-, micro- or nanoseconds since 1970 (years 2001 to
///     2286) if that makes the median interval less than 5 s;
///   - otherwise, a fraction is one of seconds;
///   - otherwise, whole numbers count in the unit that makes the median interval at least 5 ms and less than 5 s, or in
///     seconds where it is shorter than five.
/// @param stamps  as written, in any order; texts that are not numbers are ignored
/// @param given   the user's choice: precedes the last two rules
/// @param where   the file, for the message
/// Throws Error where stamps since 1970 with long intervals cannot be distinguished from stamps of the next smaller
/// unit since a device was switched on.
[[nodiscard]] TimeUnit recognise_time_unit(const std::vector<std::string_view>& stamps, std::optional<TimeUnit> given,
                                           const std::string& where);

}  // namespace posefusion
