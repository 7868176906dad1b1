#pragma once
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

/// Pairing of time stamps, as the tools of the TUM RGB-D benchmark do it.
namespace posefusion {

/// Largest difference of the stamps of a pair, seconds (default of associate.py and evaluate_ate.py).
inline constexpr double kMaxStampDifference = 0.02;

/// associate.py: of all pairs closer than `max_difference` the closest is taken first, each stamp once.
/// Input in any order, without duplicates. @return index pairs (into a, into b) in ascending order of a's stamps
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> associate(const std::vector<double>& a,
                                                                         const std::vector<double>& b,
                                                                         double max_difference = kMaxStampDifference);

/// Index of the stamp nearest to `stamp` in ascending `stamps`, if it is closer than `max_difference`.
[[nodiscard]] std::optional<std::size_t> nearest_stamp(const std::vector<double>& stamps, double stamp,
                                                       double max_difference = kMaxStampDifference);

}  // namespace posefusion
