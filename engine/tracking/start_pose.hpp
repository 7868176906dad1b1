#pragma once
#include <Eigen/Geometry>
#include <cstdint>

#include "engine/core/matrix6d.hpp"

namespace posefusion {

/// How the camera moved since an earlier frame, as found by other means than dense tracking: by features, say, which
/// need no start of their own. Tracking begins there when its own start would miss.
struct StartPose {
    std::uint32_t age = 1;  ///< frames since the earlier one; 1: it is the previous frame
    Eigen::Isometry3d T_earlier_current = Eigen::Isometry3d::Identity();
    Matrix6d covariance = Matrix6d::Zero();  ///< (translation, rotation) in the earlier camera's frame, m^2 and rad^2
    std::uint32_t inliers = 0;               ///< features that agree with it
};

}  // namespace posefusion
