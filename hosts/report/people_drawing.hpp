#pragma once
#include "engine/core/image.hpp"
#include "pose/joints.hpp"

namespace posefusion {

/// The image with people tinted and outlined (one colour per label) and their joints and limbs drawn over it.
/// @param labels  of the size of `color`, or empty
[[nodiscard]] ColorImage draw_people(const ColorImage& color, const LabelImage& labels, const People& people);

}  // namespace posefusion
