#pragma once
#include "engine/core/image.hpp"
#include "hosts/evaluate/evaluation.hpp"

namespace posefusion {

/// The paths, aligned, from two sides along the axes of the ground truth's world (the two along which the path is
/// longest first), and the error over time; over the number of the pose where the evaluation knows of no time.
[[nodiscard]] ColorImage evaluation_picture(const Trajectory& groundtruth, const Trajectory& estimate,
                                            const Evaluation& evaluation);

}  // namespace posefusion
