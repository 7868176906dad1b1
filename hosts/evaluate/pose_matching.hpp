#pragma once
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "hosts/io/association.hpp"
#include "hosts/io/trajectory.hpp"

/// Matching of poses of the estimate and of the ground truth by time.
namespace posefusion {

enum class MatchingRule {
    ClosestFirst,  ///< associate.py of the TUM benchmark: each pose once, the closest pairs first, closer than the
                   ///< limit
    Nearest,       ///< evo: for each pose of the shorter trajectory the nearest of the longer, at most the limit apart
};

inline constexpr std::array kMatchingRules{MatchingRule::ClosestFirst, MatchingRule::Nearest};
[[nodiscard]] const char* name_of(MatchingRule rule);  ///< "tum", "evo"

struct MatchingConfig {
    Stamp max_difference = kMaxStampDifference;
    MatchingRule rule = MatchingRule::ClosestFirst;
};

/// Indices of poses of the ground truth and of the estimate, in ascending order of time.
using PoseMatches = std::vector<std::pair<std::size_t, std::size_t>>;
[[nodiscard]] PoseMatches match_poses(const Trajectory& groundtruth, const Trajectory& estimate,
                                      const MatchingConfig& config = {});

[[nodiscard]] std::vector<Stamp> stamps_of(const Trajectory& trajectory);
/// Shifts all stamps, for clocks that differ. @param offset  added to all stamps
[[nodiscard]] Trajectory shifted(Trajectory trajectory, Stamp offset);

}  // namespace posefusion
