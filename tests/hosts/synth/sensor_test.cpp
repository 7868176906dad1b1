#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "hosts/synth/depth_sensor.hpp"
#include "hosts/synth/synth.hpp"

/// The depth images are as noisy as the model says.
namespace posefusion {
namespace {

struct Pair {
    DepthImage exact, measured;
    ColorImage clean, noisy;
};

const Pair& empty_room() {
    static const Pair pair = [] {
        SynthConfig config;
        config.people = 0;
        config.seed = 5;
        config.noise = false;
        const SynthFrame exact = SynthWorld(config).render(0);
        config.noise = true;
        const SynthFrame noisy = SynthWorld(config).render(0);
        return Pair{exact.depth, noisy.depth, exact.color, noisy.color};
    }();
    return pair;
}

/// Largest difference to the depth of the pixels around: small on surfaces that face the camera.
float slope(const DepthImage& depth, int u, int v) {
    float most = 0;
    for (int dv = -3; dv <= 3; ++dv)
        for (int du = -3; du <= 3; ++du)
            most =
                std::max(most, depth.contains(u + du, v + dv) ? std::abs(depth(u + du, v + dv) - depth(u, v)) : 1.0f);
    return most / 3;
}

TEST(SynthSensor, AxialNoiseGrowsWithDistanceAsInTheModel) {
    const auto& [exact, measured, clean, noisy] = empty_room();
    const synth::DepthSensorModel model;
    struct Bin {
        double squares = 0, expected = 0, sum = 0;
        int count = 0;
    };
    std::array<Bin, 3> bins;  // 1-2, 2-3, 3-4 m
    for (int v = 0; v < exact.height(); ++v)
        for (int u = 0; u < exact.width(); ++u) {
            const float z = exact(u, v);
            if (measured(u, v) == 0 || z < 1 || z >= 4 || slope(exact, u, v) > 0.0012f * z) continue;
            Bin& bin = bins[static_cast<std::size_t>(z) - 1];
            const double error = measured(u, v) - z, sigma = model.axial.sigma(z);
            const double step = z * z / (model.disparity_focal * model.baseline) * model.disparity_step;
            bin.sum += error;
            bin.squares += error * error;
            bin.expected += sigma * sigma + step * step / 12;
            ++bin.count;
        }
    int judged = 0;
    for (const Bin& bin : bins) {
        // Neighbours share their noise: this many pixels count as one draw.
        const double draws = bin.count / static_cast<double>(model.axial_correlation * model.axial_correlation);
        if (draws < 150) continue;
        ++judged;
        EXPECT_NEAR(std::sqrt(bin.squares / bin.expected), 1.0, 0.15);
        EXPECT_LT(std::abs(bin.sum / bin.count), (0.05 + 4 / std::sqrt(draws)) * std::sqrt(bin.expected / bin.count))
            << "no bias";
    }
    EXPECT_GE(judged, 2);
}

TEST(SynthSensor, DepthComesInStepsOfDisparityAndWithinItsRange) {
    const auto& [exact, measured, clean, noisy] = empty_room();
    const synth::DepthSensorModel model;
    for (const float z : measured) {
        if (z == 0) continue;
        ASSERT_GE(z, model.nearest);
        ASSERT_LE(z, model.farthest);
        const float steps = model.disparity_focal * model.baseline / z / model.disparity_step;
        ASSERT_NEAR(steps, std::round(steps), 0.01f);
    }
}

TEST(SynthSensor, LosesValuesBesideEdgesAndInTheProjectorsShadowButFewElsewhere) {
    const auto& [exact, measured, clean, noisy] = empty_room();
    int left_edges = 0, left_lost = 0, right_edges = 0, right_lost = 0, smooth = 0, smooth_lost = 0;
    for (int v = 2; v < exact.height() - 2; ++v)
        for (int u = 6; u < exact.width() - 6; ++u) {
            const float z = exact(u, v);
            const bool lost = measured(u, v) == 0;
            // The projector sits to the right of the camera: shadows fall on the background left of near things.
            if (exact(u + 3, v) < 0.75f * z && exact(u - 3, v) > 0.97f * z) ++left_edges, left_lost += lost;
            if (exact(u - 3, v) < 0.75f * z && exact(u + 3, v) > 0.97f * z) ++right_edges, right_lost += lost;
            if (slope(exact, u, v) < 0.002f * z) ++smooth, smooth_lost += lost;
        }
    ASSERT_GT(left_edges, 300);
    ASSERT_GT(right_edges, 300);
    EXPECT_GT(left_lost, left_edges * 8 / 10);
    EXPECT_LT(right_lost, right_edges * 6 / 10);
    EXPECT_LT(smooth_lost, smooth / 20);
}

TEST(SynthSensor, ColourNoiseIsAboutAGreyLevel) {
    const auto& [exact, measured, clean, noisy] = empty_room();
    double squares = 0;
    int count = 0;
    for (int v = 1; v + 1 < clean.height(); ++v)
        for (int u = 1; u + 1 < clean.width(); ++u) {
            // Where the clean picture is even, blur changes nothing and only noise remains.
            int low = 255, high = 0;
            for (int dv = -1; dv <= 1; ++dv)
                for (int du = -1; du <= 1; ++du) {
                    low = std::min<int>(low, clean(u + du, v + dv).g);
                    high = std::max<int>(high, clean(u + du, v + dv).g);
                }
            if (high - low > 1) continue;
            const double error = noisy(u, v).g - clean(u, v).g;
            squares += error * error;
            ++count;
        }
    ASSERT_GT(count, 3000);
    EXPECT_GT(std::sqrt(squares / count), 0.5);
    EXPECT_LT(std::sqrt(squares / count), 1.2);
}

}  // namespace
}  // namespace posefusion
