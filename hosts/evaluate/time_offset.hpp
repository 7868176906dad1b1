#pragma once
#include "hosts/evaluate/alignment.hpp"

namespace posefusion {

struct TimeOffsetConfig {
    Stamp range = std::chrono::seconds(1);      ///< how far the clocks may be apart
    Stamp step = std::chrono::milliseconds(5);  ///< of the search over the range; what is best there is refined
    bool scale = false;                         ///< see TrajectoryAlignmentConfig
};

/// What is to be added to the stamps of the estimate so that its positions fit those of the ground truth best (least
/// absolute trajectory error, rigid alignment, between the poses of the ground truth linearly interpolated), to a tenth
/// of a millisecond. Throws Error where the trajectories do not tell: too few poses at the same time, hardly any
/// motion, or the best fit at the end of the range.
[[nodiscard]] Stamp find_time_offset(const Trajectory& groundtruth, const Trajectory& estimate,
                                     const TimeOffsetConfig& config = {});

}  // namespace posefusion
