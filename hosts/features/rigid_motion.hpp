#pragma once
#include <Eigen/Geometry>
#include <optional>
#include <span>

#include "engine/core/depth_noise.hpp"
#include "engine/core/intrinsics.hpp"
#include "engine/core/matrix6d.hpp"
#include "hosts/features/features.hpp"

namespace posefusion {

/// The motion of the camera between two frames.
struct RigidMotion {
    Eigen::Isometry3d T_earlier_current = Eigen::Isometry3d::Identity();
    Matrix6d covariance = Matrix6d::Zero();  ///< (translation, rotation) in the earlier camera's frame, m^2 and rad^2
    std::uint32_t inliers = 0;               ///< matches that agree with it
};

/// The motion that most matches agree with: RANSAC on triples of points (Fischler & Bolles 1981) aligned in closed form
/// (Umeyama 1991), then Gauss-Newton with Cauchy weights on the errors of reprojection and of depth, each divided by
/// its standard deviation. The same result for the same matches. nullopt if too few agree (FeatureConfig).
[[nodiscard]] std::optional<RigidMotion> motion_between(const Features& earlier, const Features& current,
                                                        std::span<const FeatureMatch> matches, const Intrinsics& camera,
                                                        const DepthNoise& noise);

}  // namespace posefusion
