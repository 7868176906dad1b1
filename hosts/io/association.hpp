#pragma once
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "hosts/io/stamp.hpp"

/// Pairing of time stamps, as the tools of the TUM RGB-D benchmark do it.
namespace posefusion {

/// Largest difference of the stamps of a pair (default of associate.py and evaluate_ate.py).
inline constexpr Stamp kMaxStampDifference = std::chrono::milliseconds(20);

/// associate.py: of all pairs closer than `max_difference`, the closest is matched first, each stamp once.
/// Input in any order, without duplicates. @return index pairs (into a, into b) in ascending order of a's stamps
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> associate(const std::vector<Stamp>& a,
                                                                         const std::vector<Stamp>& b,
                                                                         Stamp max_difference = kMaxStampDifference);

/// Index of the stamp nearest to `stamp` in ascending `stamps`, if it is closer than `max_difference`.
[[nodiscard]] std::optional<std::size_t> nearest_stamp(const std::vector<Stamp>& stamps, Stamp stamp,
                                                       Stamp max_difference = kMaxStampDifference);

}  // namespace posefusion
