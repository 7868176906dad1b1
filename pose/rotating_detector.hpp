#pragma once
#include <memory>
#include <optional>

#include "pose/detector.hpp"

namespace posefusion {

/// Looks at images in another rotation than `detector`, which finds people who are upright.
/// @param rotation  nullopt: the one in which people are seen best (RotationSearch)
[[nodiscard]] std::unique_ptr<JointDetector> make_rotating_detector(std::unique_ptr<JointDetector> detector,
                                                                    std::optional<ImageRotation> rotation);

}  // namespace posefusion
