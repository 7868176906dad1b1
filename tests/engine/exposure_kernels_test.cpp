#include <algorithm>
#include <array>
#include <cmath>

#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"
#include "tests/engine/support/tracking_reference.hpp"

// What estimates the exposure of a frame, against its CPU reference.
namespace posefusion::test {
namespace {

constexpr std::size_t kColumns = gpu::REDUCTION_COLUMNS;

std::uint32_t groups_of(const Camera& c) {
    const auto block = static_cast<int>(gpu::EXPOSURE_BLOCK);
    return vulkan::ceil_div(static_cast<std::uint32_t>((c.width / block) * (c.height / block)),
                            gpu::REDUCTION_PIXELS_PER_GROUP);
}

class ExposureKernel : public DeviceTest, public testing::WithParamInterface<std::size_t> {
protected:
    const gpu::Params params = make_params(test_cameras()[GetParam()]);
    const Camera camera = camera_at(params);
    const std::size_t n = static_cast<std::size_t>(camera.pixels());
    gpu::TrackingRecord record = tracking_record(motion({0.01, 0.004, -0.006}, {1, -2, 0.5}, 0.7));
    ImagePair images = wavy_pair(params, 0, 51);
    std::vector<float> live_depth;
    std::vector<std::uint32_t> color, model_color;

    ExposureKernel() {
        for (const auto& g : images.live_geometry) live_depth.push_back(g.w);
        Random random(52);
        for (std::size_t i = 0; i < n; ++i) {
            const Vector3d base(0.35 + 0.3 * std::sin(0.05 * static_cast<double>(i)), 0.5, 0.4);
            const auto noisy = [&] {
                if (random.chance(0.03)) return Vector3d(1, 1, 1);  // clipped
                return (base + 0.05 * random.direction()).eval();
            };
            color.push_back(pack(noisy()) | (random.chance(0.05) ? 1u << 24 : 0u));
            model_color.push_back(pack(noisy()));
        }
        record.exposure = {1.1f, 0.95f, 0.9f, 0};
    }
    [[nodiscard]] std::vector<double> kernel_sums() const {
        const std::uint32_t groups = groups_of(camera);
        Launch launch("tracking/exposure_reduce");
        launch.input("params", params).input("record", record);
        launch.input("live_depth", live_depth).input("model_geometry", images.model_geometry);
        launch.input("color", color).input("model_color", model_color);
        launch.output<float>("rows", groups * gpu::REDUCTION_MAX_ROWS * kColumns);
        launch.output<std::uint32_t>("row_counts", groups).run(groups);
        const auto rows = launch.read<float>("rows");
        const auto counts = launch.read<std::uint32_t>("row_counts");
        std::vector<double> sums(kColumns, 0.0);
        for (std::size_t g = 0; g < groups; ++g) {
            for (std::size_t r = 0; r < counts[g]; ++r) {
                for (std::size_t k = 0; k < kColumns; ++k)
                    sums[k] += static_cast<double>(rows[(g * gpu::REDUCTION_MAX_ROWS + r) * kColumns + k]);
            }
        }
        return sums;
    }
    [[nodiscard]] std::vector<double> reference_sums() const {
        const Isometry3d T = from_device(record.model_live);
        const double cut = params.photometric_robust * record.photometric_scale;
        constexpr int kBlock = gpu::EXPOSURE_BLOCK;
        std::vector<double> sums(kColumns, 0.0);
        for (int v = kBlock / 2; v < camera.height / kBlock * kBlock; v += kBlock) {
            for (int u = kBlock / 2; u < camera.width / kBlock * kBlock; u += kBlock) {
                const auto i = static_cast<std::size_t>(camera.index(u, v));
                if (live_depth[i] <= 0 || color[i] >> 24 != 0) continue;
                const Vector3d q = T * camera.back_project(u, v, live_depth[i]);
                const Vector2d at = camera.project(q);
                const int mu = static_cast<int>(std::floor(at.x() + 0.5)),
                          mv = static_cast<int>(std::floor(at.y() + 0.5));
                if (!camera.contains(mu, mv)) continue;
                const auto j = static_cast<std::size_t>(camera.index(mu, mv));
                const double model_z = images.model_geometry[j].w, gap = std::abs(q.z() - model_z);
                if (model_z <= 0 || gap >= gpu::SAME_SURFACE_SIGMAS * depth_sigma(params, q.z())) continue;
                const Vector3d live = color_of(color[i]), model = color_of(model_color[j]);
                if (std::max(live.maxCoeff(), model.maxCoeff()) >= static_cast<double>(gpu::CLIPPED_COLOR)) continue;
                const double corrected = luma(live.cwiseProduct(xyz(record.exposure)).eval());
                const double r = luma(model) - static_cast<double>(record.photometric_gain) * corrected;
                const double w = 1 / (1 + r * r / (cut * cut));
                sums[gpu::COLUMN_EXPOSURE_WEIGHT] += w;
                for (int k = 0; k < 3; ++k) {
                    sums[gpu::COLUMN_EXPOSURE_LIVE + static_cast<unsigned>(k)] += w * live(k);
                    sums[gpu::COLUMN_EXPOSURE_MODEL + static_cast<unsigned>(k)] += w * model(k);
                }
            }
        }
        return sums;
    }
    [[nodiscard]] gpu::TrackingRecord solve(const std::vector<float>& sums) const {
        std::vector<float> rows(gpu::REDUCTION_MAX_ROWS * kColumns, 0.0f);
        std::copy(sums.begin(), sums.end(), rows.begin());
        Launch launch("tracking/exposure_solve");
        launch.input("rows", rows).input("row_counts", std::vector<std::uint32_t>{1}).inout("record", record);
        launch.run(1, {{"groups", 1}});
        return launch.read<gpu::TrackingRecord>("record")[0];
    }
};

INSTANTIATE_TEST_SUITE_P(Sizes, ExposureKernel, testing::Range(std::size_t{0}, test_cameras().size()),
                         [](const auto& test) {
                             const auto camera = test_cameras()[test.param];
                             return std::to_string(camera.width) + "x" + std::to_string(camera.height);
                         });

TEST_P(ExposureKernel, AddsUpColoursOfTheSameSurfaceByRobustWeights) {
    const auto expected = reference_sums(), actual = kernel_sums();
    const auto blocks = static_cast<double>(n) / (gpu::EXPOSURE_BLOCK * gpu::EXPOSURE_BLOCK);
    ASSERT_GT(expected[gpu::COLUMN_EXPOSURE_WEIGHT], 0.2 * blocks);
    // a tie at one of the gates may fall either way: one pixel
    for (std::size_t k = 0; k < kColumns; ++k) EXPECT_NEAR(actual[k], expected[k], 1.0 + 1e-4 * expected[k]) << k;
}

TEST_P(ExposureKernel, IsTheRatioOfTheMeansPerChannel) {
    const auto result = solve({100, 40, 50, 20, 44, 48, 21});
    EXPECT_NEAR(result.exposure.x, 1.1, 1e-6);
    EXPECT_NEAR(result.exposure.y, 0.96, 1e-6);
    EXPECT_NEAR(result.exposure.z, 1.05, 1e-6);
}

TEST_P(ExposureKernel, StaysWhereThereIsTooLittleToCompareOrTrackingFailed) {
    const std::vector<float> few = {0.9f * gpu::MIN_EXPOSURE_PIXELS, 40, 50, 20, 44, 48, 21};
    EXPECT_EQ(xyz(solve(few).exposure), xyz(record.exposure));
    EXPECT_EQ(xyz(solve({100, 0, 0, 0, 0, 0, 0}).exposure), xyz(record.exposure)) << "black";
    record.failed = 1;
    EXPECT_EQ(xyz(solve({100, 40, 50, 20, 44, 48, 21}).exposure), xyz(record.exposure));
}

}  // namespace
}  // namespace posefusion::test
