// The motion of the camera from matched features: right within its covariance, whatever the outliers.
#include "hosts/features/rigid_motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "engine/core/pinhole.hpp"

namespace posefusion {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

const Intrinsics kCamera{525, 520, 319.5f, 239.5f, 640, 480};
const DepthNoise kNoise;
constexpr float kSigma = 1.2f;  // pixels

Isometry3d motion(const Vector3d& translation, const Vector3d& axis, double degrees) {
    return Eigen::Translation3d(translation) * Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized());
}

/// Points in view of two cameras, measured with the noise of a depth camera; the last `outliers` are wrong matches.
struct Scene {
    Features earlier, current;
    std::vector<FeatureMatch> matches;

    Scene(const Isometry3d& T_earlier_current, std::uint32_t count, std::uint32_t outliers, unsigned seed) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<float> u(20, 620), v(20, 460), z(0.8f, 3.5f);
        std::normal_distribution<float> normal;
        const auto measured = [&](const Vector3d& p) {
            Feature feature;
            feature.sigma = kSigma;
            feature.pixel =
                project(p, kCamera).cast<float>() + kSigma * Eigen::Vector2f(normal(random), normal(random));
            feature.depth = static_cast<float>(p.z());
            feature.depth += kNoise.sigma(feature.depth) * normal(random);
            return feature;
        };
        const auto any_point = [&] {
            return back_project(u(random), v(random), z(random), kCamera).cast<double>().eval();
        };
        while (matches.size() < count) {
            const bool wrong = matches.size() + outliers >= count;
            const Vector3d p = any_point(), q = T_earlier_current.inverse() * p;
            if (q.z() < 0.5 || !in_image(project(q, kCamera), kCamera)) continue;
            const auto i = static_cast<std::uint32_t>(matches.size());
            matches.push_back({i, i});
            earlier.push_back(measured(p));
            current.push_back(measured(wrong ? any_point() : q));
        }
    }
    [[nodiscard]] std::optional<RigidMotion> estimate() const {
        return motion_between(earlier, current, matches, kCamera, kNoise);
    }
};

/// Error of a motion, (translation, rotation), in the earlier camera's frame.
Vector6d error_of(const RigidMotion& found, const Isometry3d& truth) {
    const Isometry3d error = found.T_earlier_current * truth.inverse();
    const Eigen::AngleAxisd rotation(error.linear());
    Vector6d e;
    e << error.translation(), rotation.angle() * rotation.axis();
    return e;
}

const Isometry3d kMotions[] = {Isometry3d::Identity(), motion({0.02, 0.01, -0.03}, {1, 2, 3}, 2),
                               motion({0.25, -0.05, 0.1}, {0, 1, 0.2}, 12), motion({0, 0, 0.3}, {0, 0, 1}, 40)};

TEST(RigidMotion, IsRightWithinItsCovariance) {
    std::vector<double> distances;  // Mahalanobis, squared: chi-square with 6 degrees of freedom
    for (const Isometry3d& truth : kMotions) {
        for (unsigned seed = 0; seed < 20; ++seed) {
            const auto found = Scene(truth, 200, 60, seed).estimate();
            ASSERT_TRUE(found) << seed;
            const Vector6d e = error_of(*found, truth);
            distances.push_back(e.dot(found->covariance.ldlt().solve(e)));
            EXPECT_LT(e.head<3>().norm(), 0.01) << seed;
            EXPECT_LT(e.tail<3>().norm(), 0.005) << seed;
        }
    }
    const double mean =
        std::accumulate(distances.begin(), distances.end(), 0.0) / static_cast<double>(distances.size());
    EXPECT_LT(mean, 2 * 6.0) << "the covariance promises too much";
    EXPECT_GT(mean, 6.0 / 4) << "the covariance promises too little";
}

TEST(RigidMotion, OutliersDoNotCount) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        const auto found = Scene(kMotions[2], 200, 120, seed).estimate();
        ASSERT_TRUE(found) << seed;
        EXPECT_LT(error_of(*found, kMotions[2]).norm(), 0.02) << seed;
        EXPECT_GT(found->inliers, 55u);
        EXPECT_LT(found->inliers, 100u);
    }
}

TEST(RigidMotion, IsTheSameForTheSameMatches) {
    const Scene scene(kMotions[1], 150, 50, 3);
    const auto a = scene.estimate(), b = scene.estimate();
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->T_earlier_current.matrix(), b->T_earlier_current.matrix());
    EXPECT_EQ(a->covariance, b->covariance);
}

TEST(RigidMotion, IsNotGuessedFromTooFewMatches) {
    EXPECT_FALSE(Scene(kMotions[1], 20, 0, 1).estimate());
    EXPECT_FALSE(Scene(kMotions[1], 0, 0, 1).estimate());
}

TEST(RigidMotion, IsNotGuessedFromWrongMatches) {
    for (unsigned seed = 0; seed < 20; ++seed) EXPECT_FALSE(Scene(kMotions[1], 200, 200, seed).estimate()) << seed;
}

TEST(RigidMotion, NeedsPointsThatFixIt) {
    Scene scene(kMotions[0], 200, 0, 1);  // all at one point
    for (std::size_t i = 0; i < scene.earlier.size(); ++i) {
        scene.earlier[i] = scene.earlier[0];
        scene.current[i] = scene.current[0];
    }
    EXPECT_FALSE(scene.estimate());
}

}  // namespace
}  // namespace posefusion
