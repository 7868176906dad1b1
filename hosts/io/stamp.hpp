#pragma once
#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Time stamps of images and poses, exact to the nanosecond. A double of seconds since 1970 steps by 0.24 microseconds:
/// it is good for intervals, but not for telling stamps apart, pairing them or writing them down again.
namespace posefusion {

/// Since whatever the recording counts from: 1970, the start of the device, its first frame ... Reaches 146 years.
using Stamp = std::chrono::nanoseconds;
/// What is read is no farther from 0, so that sums and differences of two stamps can be had.
inline constexpr Stamp kFarthestStamp{std::int64_t{1} << 62};

/// The nearest double.
[[nodiscard]] double to_seconds(Stamp stamp);

/// The number with the fewest digits that is this double and no other, as a stamp: of 1305031102.175304 s it keeps
/// these six decimals and not what the double adds to them. Throws Error: not finite, or out of reach.
[[nodiscard]] Stamp stamp_of(double seconds);

/// Seconds with six decimals, or nine where six do not say it: "1305031102.175304", "1403636579.763555584".
[[nodiscard]] std::string seconds_text(Stamp stamp);

enum class TimeUnit { Seconds, Milliseconds, Microseconds, Nanoseconds };
inline constexpr std::array kTimeUnits{TimeUnit::Seconds, TimeUnit::Milliseconds, TimeUnit::Microseconds,
                                       TimeUnit::Nanoseconds};
[[nodiscard]] const char* symbol_of(TimeUnit unit);  ///< "s", "ms", "us", "ns"
/// nullopt if it is none of these symbols.
[[nodiscard]] std::optional<TimeUnit> time_unit(std::string_view symbol);

/// A decimal number, also one like 1.403636579763555584e+18, in that unit, without a detour over a double; what is
/// below a nanosecond is rounded. nullopt: not a number, not finite, or out of reach.
[[nodiscard]] std::optional<Stamp> parse_stamp(std::string_view text, TimeUnit unit = TimeUnit::Seconds);

/// Of the numbers among the texts, sorted, those that repeat left out; 0 for fewer than two.
[[nodiscard]] double median_interval(const std::vector<std::string_view>& numbers);

/// The unit in which a file counts time. Stamps do not say it, but
///   - numbers of 13, 16 or 19 digits before the point count milli-, micro- or nanoseconds since 1970 (years 2001 to
///     2286) if that makes the median interval less than 5 s;
///   - otherwise, a fraction is one of seconds;
///   - otherwise, whole numbers count in the unit that makes the median interval at least 5 ms and less than 5 s, or in
///     seconds where it is shorter than five.
/// @param stamps  as they are written, in any order; what is no number does not count
/// @param given   where the user says it: goes before the last two rules
/// @param where   the file, for the message
/// Throws Error where stamps since 1970 that are far apart cannot be told from those of the next smaller unit since a
/// device was switched on.
[[nodiscard]] TimeUnit recognise_time_unit(const std::vector<std::string_view>& stamps, std::optional<TimeUnit> given,
                                           const std::string& where);

}  // namespace posefusion
