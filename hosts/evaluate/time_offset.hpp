#pragma once
#include "hosts/evaluate/alignment.hpp"

namespace posefusion {

struct TimeOffsetConfig {
    Stamp range = std::chrono::seconds(1);      ///< largest offset of the clocks
    Stamp step = std::chrono::milliseconds(5);  ///< of the search over the range; the best one is refined
    bool scale = false;                         ///< see TrajectoryAlignmentConfig
};

/// The offset to be added to the stamps of the estimate for the smallest absolute trajectory error (rigid alignment;
/// the ground truth is interpolated linearly), to a tenth of a millisecond. Throws Error where the trajectories do not
/// determine it: too few poses at the same time, hardly any motion, or the best fit at an end of the range.
[[nodiscard]] Stamp find_time_offset(const Trajectory& groundtruth, const Trajectory& estimate,
                                     const TimeOffsetConfig& config = {});

}  // namespace posefusion
