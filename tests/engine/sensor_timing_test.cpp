#include "engine/tracking/sensor_timing.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "engine/core/matrix6d.hpp"
#include "engine/vulkan/shared_types.hpp"

// The times of a sensor from the systems of many pairs of frames.
namespace posefusion {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Residuals of pairs of frames that depend linearly on a pose and the times.
class Pairs {
public:
    /// @param times  as they are  @param used  as the images were corrected by  @param speed  0: the camera stands
    /// still
    std::vector<float> sums(const SensorTimes& times, const SensorTimes& used, double speed = 1) {
        constexpr int kResiduals = 2000;
        constexpr double kNoise = 0.5;  // whitened
        std::array<double, gpu::TIMING_COLUMNS> sums{};
        const Vector6d pose = Vector6d::NullaryExpr([&] { return 0.01 * normal_(random_); });
        for (int i = 0; i < kResiduals; ++i) {
            const Vector6d J = Vector6d::NullaryExpr([&] { return 30 * normal_(random_); });
            const double share = uniform_(random_), slope = speed * 100 * normal_(random_);
            const bool geometric = i % 2 == 0;
            const SensorTimes slopes =
                geometric ? SensorTimes(slope, share * slope, 0) : SensorTimes(0, 0, share * slope);
            // zero at the true pose and times
            const double r = J.dot(pose) + slopes.dot(used - times) + kNoise * normal_(random_);
            std::size_t k = gpu::COLUMN_HESSIAN;
            for (int a = 0; a < 6; ++a) {
                for (int b = a; b < 6; ++b) sums[k++] += J(a) * J(b);
                const auto row = static_cast<std::size_t>(a);
                sums[gpu::COLUMN_GRADIENT + row] += J(a) * r;
                sums[gpu::COLUMN_POSE_DELAY + row] += J(a) * slopes(0);
                sums[gpu::COLUMN_POSE_DEPTH_READOUT + row] += J(a) * slopes(1);
                sums[gpu::COLUMN_POSE_COLOR_READOUT + row] += J(a) * slopes(2);
            }
            sums[gpu::COLUMN_TIMES] += slopes(0) * slopes(0);
            sums[gpu::COLUMN_TIMES + 1] += slopes(0) * slopes(1);
            sums[gpu::COLUMN_TIMES + 2] += slopes(1) * slopes(1);
            sums[gpu::COLUMN_TIMES + 3] += slopes(2) * slopes(2);
            for (std::size_t t = 0; t < 3; ++t)
                sums[gpu::COLUMN_TIMES_GRADIENT + t] += slopes(static_cast<Eigen::Index>(t)) * r;
        }
        return {sums.begin(), sums.end()};
    }

private:
    std::mt19937 random_{7};
    std::normal_distribution<double> normal_{0, 1};
    std::uniform_real_distribution<double> uniform_{-0.5, 0.5};
};

TEST(SensorTiming, ComesOutWhateverTheImagesWereCorrectedBy) {
    const SensorTimes truth(-0.008, 0.030, 0.026);
    for (const SensorTimes& used : {SensorTimes(0, 0, 0), SensorTimes(-0.004, 0.02, 0.03)}) {
        Pairs pairs;
        SensorTiming timing;
        for (int i = 0; i < 60; ++i) timing.add(pairs.sums(truth, used), used);
        const auto estimate = timing.estimate();
        EXPECT_EQ(estimate.pairs, 60);
        for (int t = 0; t < 3; ++t) {
            EXPECT_NEAR(estimate.times(t), truth(t), 0.001) << t;
            EXPECT_GT(estimate.sigma(t), 0.0005) << "pairs are not better than their systematic errors";
            EXPECT_LT(estimate.sigma(t), 0.002);
        }
    }
}

TEST(SensorTiming, ACameraThatStandsStillSaysNothing) {
    Pairs pairs;
    SensorTiming timing;
    for (int i = 0; i < 60; ++i) timing.add(pairs.sums({-0.008, 0.030, 0.026}, {0, 0, 0}, 0), {0, 0, 0});
    const auto estimate = timing.estimate();
    EXPECT_LT(estimate.times.cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_NEAR(estimate.sigma(0), SensorTiming::kDelaySigma, 1e-6);
    EXPECT_NEAR(estimate.sigma(1), SensorTiming::kReadoutSigma, 1e-6);
}

TEST(SensorTiming, ASystemThatCannotBeSolvedIsLeftOut) {
    SensorTiming timing;
    timing.add(std::vector<float>(gpu::TIMING_COLUMNS, 0.0f), {0, 0, 0});
    EXPECT_EQ(timing.estimate().pairs, 0);
}

}  // namespace
}  // namespace posefusion
