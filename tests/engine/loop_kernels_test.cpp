#include <bit>
#include <cmath>

#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"

// The kernels of the back end against plain C++ written from their header comments.
namespace posefusion::test {
namespace {

using gpu::LoopSample;
using gpu::MapRecord;
using gpu::Params;
using gpu::SurfelSample;
using gpu::TrackingRecord;
using gpu::vec4;
using std::size_t;
using uint = std::uint32_t;

struct Appearance {
    uint red_green, blue_weight, created, last_seen;
};

class LoopKernel : public DeviceTest, public testing::WithParamInterface<size_t> {
protected:
    Params params = [] {
        Params p = make_params(test_cameras()[GetParam()]);
        p.frame = 63;
        p.active_since = 30;
        return p;
    }();
    const Camera camera = camera_at(params);
    const size_t n = static_cast<size_t>(camera.pixels());
};

INSTANTIATE_TEST_SUITE_P(Sizes, LoopKernel, testing::Range(size_t{0}, test_cameras().size()), [](const auto& test) {
    const auto camera = test_cameras()[test.param];
    return std::to_string(camera.width) + "x" + std::to_string(camera.height);
});

TEST_P(LoopKernel, ThumbnailAveragesWhatIsKnownOfTheModelOrWhenLostOfTheLiveImage) {
    constexpr int kShrink = 8;
    const auto model_depth = rough_depth(camera, 1), static_depth = rough_depth(camera, 2);
    const auto model_color = smooth_colors(camera, 3), color = smooth_colors(camera, 4);
    const int width = camera.width / kShrink, height = camera.height / kShrink;
    for (const bool failed : {false, true}) {
        TrackingRecord record{};
        record.failed = failed;
        Launch launch("loops/thumbnail", {{"SHRINK", kShrink}});
        launch.input("params", params).input("record", record);
        launch.input("model_color", model_color).input("model_depth", model_depth);
        launch.input("color", color).input("static_depth", static_depth);
        const auto pixels = static_cast<size_t>(width * height);
        launch.output<std::uint64_t>("thumbnail", pixels).run_over(pixels);
        const auto texels = launch.read<std::uint64_t>("thumbnail");
        const auto& depth = failed ? static_depth : model_depth;
        const auto& colors = failed ? color : model_color;
        std::vector<float> depths;
        std::vector<double> expected;
        for (int v = 0; v < height; ++v) {
            for (int u = 0; u < width; ++u) {
                Vector3d sum = Vector3d::Zero();
                double z = 0;
                int count = 0;
                for (const int dv : {2, 6}) {
                    for (const int du : {2, 6}) {
                        const auto i = static_cast<size_t>(camera.index(u * kShrink + du, v * kShrink + dv));
                        if (!(depth[i] > 0)) continue;
                        sum += Vector3d(colors[i] & 255u, colors[i] >> 8 & 255u, colors[i] >> 16 & 255u);
                        z += depth[i];
                        ++count;
                    }
                }
                const std::uint64_t texel = texels[static_cast<size_t>(v * width + u)];
                depths.push_back(std::bit_cast<float>(static_cast<uint>(texel >> 32)));
                expected.push_back(count ? z / count : 0);
                for (int k = 0; k < 3; ++k) {
                    const double mean = count ? sum[k] / count : 0;
                    ASSERT_NEAR(static_cast<double>(texel >> (8 * k) & 255u), mean, 0.51)
                        << u << ' ' << v;  // rounded to a byte
                }
            }
        }
        expect_near(depths, expected, 2e-6);  // a mean of four floats of a few metres
    }
}

TEST_P(LoopKernel, LoopSamplesTellWhatTheModelShowsWhereLivePixelsProjectTo) {
    constexpr uint kGridWidth = gpu::LOOP_GRID_WIDTH, kGridHeight = gpu::LOOP_GRID_HEIGHT;
    const auto live_depth = rough_depth(camera, 11);
    TrackingRecord record{};
    const Isometry3d model_live = motion({0.01, -0.02, 0.015}, {1, -1, 2}, 1.5);
    record.model_live = to_device(model_live);
    Random random(12);
    const uint surfels = 500;
    std::vector<float> model_depth(n);
    std::vector<uint> indices(n), keys(n), interleaved;
    for (size_t i = 0; i < n; ++i) {
        indices[i] = random.chance(0.2) ? gpu::EMPTY_CELL : random.below(surfels);
        keys[i] = indices[i] == gpu::EMPTY_CELL ? gpu::EMPTY_CELL : 1;
        model_depth[i] =
            indices[i] == gpu::EMPTY_CELL ? 0.0f : live_depth[i] * static_cast<float>(random.uniform(0.95, 1.05));
        interleaved.push_back(indices[i]), interleaved.push_back(keys[i]);
    }
    std::vector<Appearance> appearances;
    for (uint i = 0; i < surfels; ++i) appearances.push_back({0, 0, random.below(60), 0});
    const Camera quarter = camera_at(params, 2);
    std::vector<vec4> live_photometric, model_photometric;
    for (int i = 0; i < quarter.pixels(); ++i) {
        live_photometric.push_back(vec4_of({random.chance(0.1) ? -1 : random.uniform(0, 1), 9, 9}, 9));
        model_photometric.push_back(vec4_of({random.chance(0.1) ? -1 : random.uniform(0, 1), 9, 9}, 9));
    }
    for (const bool wide : {true, false}) {
        Launch launch("loops/loop_samples", {{"CELL_STRIDE", wide ? 2 : 1}}, wide);
        launch.input("params", params).input("record", record);
        launch.input("live_depth", live_depth).input("model_depth", model_depth);
        launch.input("cell_indices", wide ? interleaved : indices).input("appearance", appearances);
        launch.input("live_photometric", live_photometric).input("model_photometric", model_photometric);
        launch.output<LoopSample>("samples", kGridWidth * kGridHeight).run_over(kGridWidth * kGridHeight);
        const auto samples = launch.read<LoopSample>("samples");
        size_t ties = 0, valid = 0;
        for (uint row = 0; row < kGridHeight; ++row) {
            for (uint column = 0; column < kGridWidth; ++column) {
                const auto u = static_cast<int>((2 * column + 1) * params.width / (2 * kGridWidth)),
                           v = static_cast<int>((2 * row + 1) * params.height / (2 * kGridHeight));
                const double z = static_cast<double>(live_depth[static_cast<size_t>(camera.index(u, v))]);
                const Vector3d p = camera.back_project(u, v, z), q = model_live * p;
                const LoopSample& sample = samples[row * kGridWidth + column];
                ASSERT_LT((xyz(sample.point) - p).norm(), 1e-5) << u << ' ' << v;
                ASSERT_EQ(sample.live_intensity, live_photometric[static_cast<size_t>(quarter.index(u / 4, v / 4))].x);
                double depth = 0;
                float intensity = -1;
                uint created = 0, agrees = 0;
                if (z > 0 && q.z() > gpu::NEAR_PLANE) {
                    const Vector2d at = camera.project(q);
                    const int mu = static_cast<int>(std::floor(at.x() + 0.5)),
                              mv = static_cast<int>(std::floor(at.y() + 0.5));
                    if (camera.contains(mu, mv) &&
                        indices[static_cast<size_t>(camera.index(mu, mv))] != gpu::EMPTY_CELL) {
                        const auto j = static_cast<size_t>(camera.index(mu, mv));
                        depth = static_cast<double>(model_depth[j]);
                        if (depth > 0) {
                            intensity = model_photometric[static_cast<size_t>(quarter.index(mu / 4, mv / 4))].x;
                            created = appearances[indices[j]].created;
                            const double gate = std::max(static_cast<double>(params.association_depth),
                                                         params.association_sigmas * depth_sigma(params, z));
                            agrees = std::abs(depth - q.z()) < gate;
                        }
                    }
                }
                const bool same = std::abs(static_cast<double>(sample.point.w) - depth) < 1e-6 &&
                                  sample.created == created && sample.valid == agrees &&
                                  sample.model_intensity == intensity;
                ties += !same;
                valid += sample.valid;
            }
        }
        EXPECT_LE(ties, 2u);  // a projection within rounding of a pixel's border
        EXPECT_GT(valid, kGridWidth * kGridHeight / 20);
    }
}

TEST_P(LoopKernel, SampleSurfelsCopiesEveryStridethSlot) {
    Random random(21);
    const uint slots = 1000;
    std::vector<vec4> positions;
    std::vector<Appearance> appearances;
    for (uint i = 0; i < slots; ++i) {
        positions.push_back(vec4_of(random.direction(), random.uniform(0, 20)));
        appearances.push_back({0, 0, random.below(100), random.below(100)});
    }
    for (const uint stride : {1u, 3u, 7u}) {
        const uint count = slots / stride;
        Launch launch("loops/sample_surfels");
        launch.input("position_confidence", positions).input("appearance", appearances);
        launch.output<SurfelSample>("samples", count).run_over(count, {{"stride", stride}, {"count", count}});
        const auto samples = launch.read<SurfelSample>("samples");
        for (uint i = 0; i < count; ++i) {
            ASSERT_EQ(std::memcmp(&samples[i].position, &positions[i * stride], sizeof(vec4)), 0);
            ASSERT_EQ(samples[i].created, appearances[i * stride].created);
            ASSERT_EQ(samples[i].last_seen, appearances[i * stride].last_seen);
        }
    }
}

TEST_P(LoopKernel, ReactivateTakesTheOldSurfaceUpAndRemovesItsRecentDuplicate) {
    const Isometry3d world_live = motion({0.3, -0.2, 0.5}, {1, 2, 0.3}, 25);
    TrackingRecord record{};
    record.world_live = to_device(world_live);
    auto inactive_depth = rough_depth(camera, 31);
    Random random(32);
    const uint count = 3000;
    std::vector<vec4> positions;
    std::vector<Appearance> appearances;
    for (uint i = 0; i < count; ++i) {
        const double u = random.uniform(-5, camera.width + 5), v = random.uniform(-5, camera.height + 5);
        const bool inside = camera.contains(static_cast<int>(u), static_cast<int>(v)) && u >= 0 && v >= 0;
        double z =
            inside ? static_cast<double>(
                         inactive_depth[static_cast<size_t>(camera.index(static_cast<int>(u), static_cast<int>(v)))])
                   : 1.0;
        z = (z > 0 ? z : 1.0) + random.uniform(-0.15, 0.15);
        positions.push_back(
            vec4_of(world_live * camera.back_project(u, v, z), random.chance(0.1) ? 0 : random.uniform(0.5, 20)));
        const uint last_seen = random.below(63);
        appearances.push_back({1, 2, random.below(last_seen + 1), last_seen});
    }
    Launch launch("loops/reactivate");
    launch.input("params", params).input("record", record).input("counters", MapRecord{count, 0, 0, 0, 0});
    launch.input("inactive_depth", inactive_depth);
    launch.inout("position_confidence", positions).inout("appearance", appearances);
    launch.run(vulkan::ceil_div(count, gpu::SURFELS_PER_GROUP));
    const auto new_positions = launch.read<vec4>("position_confidence");
    const auto looks = launch.read<Appearance>("appearance");
    size_t differing = 0, removed = 0, revived = 0;
    for (uint i = 0; i < count; ++i) {
        bool remove = false, revive = false;
        const Vector3d p = world_live.inverse() * xyz(positions[i]);
        if (positions[i].w > 0 && p.z() >= gpu::NEAR_PLANE) {
            const Vector2d at = camera.project(p);
            const int u = static_cast<int>(std::floor(at.x() + 0.5)), v = static_cast<int>(std::floor(at.y() + 0.5));
            if (camera.contains(u, v)) {
                const double model = static_cast<double>(inactive_depth[static_cast<size_t>(camera.index(u, v))]);
                const double gate = std::max(static_cast<double>(params.association_depth),
                                             params.association_sigmas * depth_sigma(params, p.z()));
                if (model > 0 && std::abs(p.z() - model) < gate) {
                    const bool active = appearances[i].last_seen >= params.active_since;
                    remove = active && appearances[i].created >= params.active_since;
                    revive = !active && positions[i].w >= params.stable_confidence;
                }
            }
        }
        const float confidence = remove ? 0.0f : positions[i].w;
        const uint last_seen = revive ? params.frame : appearances[i].last_seen;
        differing += new_positions[i].w != confidence || looks[i].last_seen != last_seen;
        ASSERT_EQ(xyz(new_positions[i]), xyz(positions[i]));
        ASSERT_EQ(looks[i].created, appearances[i].created);
        removed += remove, revived += revive;
    }
    EXPECT_LE(differing, 3u);  // gates and pixel borders are decided by rounding
    EXPECT_GT(removed, 20u);
    EXPECT_GT(revived, 20u);
}

}  // namespace
}  // namespace posefusion::test
