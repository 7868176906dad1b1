#pragma once
#include "engine/core/image.hpp"
#include "hosts/evaluate/evaluation.hpp"

namespace posefusion {

/// Two views of the aligned paths along the axes of the ground truth's world (first the two axes with the greatest
/// extent), and the error over time, or over the number of the pose where there are no stamps.
[[nodiscard]] ColorImage evaluation_picture(const Trajectory& groundtruth, const Trajectory& estimate,
                                            const Evaluation& evaluation);

}  // namespace posefusion
