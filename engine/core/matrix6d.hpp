#pragma once
#include <Eigen/Core>

namespace posefusion {

using Matrix6d = Eigen::Matrix<double, 6, 6>;  ///< over (translation, rotation): covariance, information

}  // namespace posefusion
