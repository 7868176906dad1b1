#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "hosts/synth/synth.hpp"

/// What sets the kinds of depth sensors apart.
namespace posefusion {
namespace {

/// One instant, without distortion of depth: measured and exact depth are of the same rays.
SynthConfig still(const char* sensor) {
    SynthConfig config;
    config.width = 200;
    config.height = 150;
    config.people = 0;
    config.seed = 5;
    config.sensor = synth::sensor_model(sensor);
    config.sensor.shutter = {};
    config.sensor.stamped_delay_ms = 0;
    config.sensor.exposure = {};
    config.sensor.lens = {};
    config.sensor.depth_distortion = {};
    return config;
}

const SynthFrame& exact() {
    static const SynthFrame frame = [] {
        SynthConfig config = still("clean");
        config.noise = false;
        return SynthWorld(config).render(0);
    }();
    return frame;
}

/// Calls visit(u, v, true depth, measured depth, whether the surface is even around the pixel).
template <class Visit>
void compare(const DepthImage& measured, const Visit& visit) {
    const DepthImage& depth = exact().depth;
    for (int v = 2; v < depth.height() - 2; ++v)
        for (int u = 2; u < depth.width() - 2; ++u) {
            float step = 0;
            for (const auto& [du, dv] : {std::pair{2, 0}, {-2, 0}, {0, 2}, {0, -2}})
                step = std::max(step, std::abs(depth(u + du, v + dv) - depth(u, v)));
            visit(u, v, depth(u, v), measured(u, v), step < 0.01f * depth(u, v));
        }
}

TEST(SynthDepthKinds, NoiseOfStereoGrowsWithTheSquareOfDistanceAndIsWorseOnEvenSurfaces) {
    SynthConfig config = still("realsense");
    config.sensor.depth.disparity_step = 0;
    const DepthImage measured = SynthWorld(config).render(0).depth;
    struct Bin {
        double squares = 0;
        int count = 0;
        [[nodiscard]] double rms() const { return std::sqrt(squares / count); }
    };
    std::array<Bin, 5> by_metre;
    int even = 0, even_lost = 0, textured = 0, textured_lost = 0;
    const ColorImage& color = exact().color;
    compare(measured, [&](int u, int v, float z, float seen, bool flat) {
        if (!flat) return;
        int low = 255, high = 0;
        for (int dv = -2; dv <= 2; ++dv)
            for (int du = -2; du <= 2; ++du)
                low = std::min<int>(low, color(u + du, v + dv).g), high = std::max<int>(high, color(u + du, v + dv).g);
        if (high - low < 8) ++even, even_lost += seen == 0;
        if (high - low > 40) ++textured, textured_lost += seen == 0;
        if (seen == 0 || high - low < 25) return;
        Bin& bin = by_metre[std::min(static_cast<std::size_t>(z), by_metre.size() - 1)];
        bin.squares += static_cast<double>((seen - z) * (seen - z)), ++bin.count;
    });
    ASSERT_GT(by_metre[1].count, 100);
    ASSERT_GT(by_metre[3].count, 200);
    const double growth = by_metre[3].rms() / by_metre[1].rms();
    EXPECT_GT(growth, 2.5);
    EXPECT_LT(growth, 8);
    ASSERT_GT(even, 200);
    ASSERT_GT(textured, 300);
    EXPECT_GT(even_lost / static_cast<double>(even), 2 * textured_lost / static_cast<double>(textured));
}

/// What arrives by way of other surfaces, without any noise.
const DepthImage& echoes() {
    static const DepthImage depth = [] {
        SynthConfig config = still("tof");
        config.sensor.depth.aperture = 0;
        config.sensor.depth.axial.a = config.sensor.depth.axial.b = 0;
        return SynthWorld(config).render(0).depth;
    }();
    return depth;
}

TEST(SynthDepthKinds, TimeOfFlightMixesWhatAPixelSeesAtEdges) {
    SynthConfig config = still("tof");
    config.sensor.depth.indirect_albedo = 0;
    config.sensor.depth.edge_dropout = 0;
    const auto hanging = [](const DepthImage& measured) {
        int count = 0;
        compare(measured, [&](int u, int v, float z, float seen, bool) {
            // Something far nearer beside it, and a value that belongs to neither.
            float nearest = z;
            for (const auto& [du, dv] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
                nearest = std::min(nearest, exact().depth(u + du, v + dv));
            count += nearest < 0.7f * z && seen > 1.1f * nearest && seen < 0.93f * z;
        });
        return count;
    };
    EXPECT_GT(hanging(SynthWorld(config).render(0).depth), 100);
    EXPECT_LT(hanging(echoes()), 5) << "each pixel a point";
}

TEST(SynthDepthKinds, LightByWayOfOtherSurfacesMakesCornersRecede) {
    int pixels = 0, far = 0;
    compare(echoes(), [&](int, int, float z, float seen, bool flat) {
        if (seen == 0 || !flat) return;
        ++pixels;
        ASSERT_GT(seen, z - 1e-4f) << "a detour is never shorter";
        ASSERT_LT(seen, z + 0.3f);
        far += seen > z + 0.01f;
    });
    EXPECT_GT(far, pixels / 20);
    EXPECT_LT(far, pixels * 19 / 20);
}

}  // namespace
}  // namespace posefusion
