#include <algorithm>
#include <array>
#include <cmath>

#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"

// The preprocessing kernels against their header comments, written down once more in plain C++.
namespace posefusion::test {
namespace {

using gpu::Params;
using gpu::vec4;
using std::size_t;

/// Of pixels on which a kernel may decide otherwise than the reference because a comparison is a tie to the last bits:
/// with random depths the chance is about 1e-6 per comparison, so 0.1 % is far above it and far below any fault.
size_t ties(size_t pixels) { return pixels / 1000; }

constexpr double kSumRounding = 1e-5;  // metres, of weighted means of at most 49 floats of a few metres each

class PreprocessKernel : public DeviceTest, public testing::WithParamInterface<size_t> {
protected:
    const Intrinsics intrinsics = test_cameras()[GetParam()];
    const Params params = make_params(intrinsics);
    const Camera camera = camera_at(params);
    const size_t n = static_cast<size_t>(camera.pixels());

    [[nodiscard]] size_t row_words() const {
        return (static_cast<size_t>(camera.width) + gpu::MASK_WORD - 1) / gpu::MASK_WORD;
    }
    [[nodiscard]] size_t words() const { return row_words() * static_cast<size_t>(camera.height); }
    [[nodiscard]] std::vector<std::uint32_t> packed(const std::vector<std::uint8_t>& labels) const {
        std::vector<std::uint32_t> mask(words(), 0);
        for (size_t i = 0; i < n; ++i) {
            const size_t v = i / static_cast<size_t>(camera.width), u = i % static_cast<size_t>(camera.width);
            if (labels[i]) mask[v * row_words() + u / gpu::MASK_WORD] |= 1u << (u % gpu::MASK_WORD);
        }
        return mask;
    }
    [[nodiscard]] std::vector<float> run_bilateral(int radius, const std::vector<float>& depth) const {
        Launch launch("preprocess/bilateral", {{"RADIUS", radius}});
        launch.input("params", params).input("static_depth", depth).output<float>("filtered_depth", n);
        launch.run_over(static_cast<size_t>(camera.width) / gpu::PIXELS_PER_INVOCATION,
                        static_cast<size_t>(camera.height));
        return launch.read<float>("filtered_depth");
    }
    /// The bits of pixels; those behind the end of a row mean nothing.
    [[nodiscard]] std::vector<int> bits(const std::vector<std::uint32_t>& mask) const {
        std::vector<int> result;
        for (size_t i = 0; i < n; ++i) {
            const size_t v = i / static_cast<size_t>(camera.width), u = i % static_cast<size_t>(camera.width);
            result.push_back(static_cast<int>(mask[v * row_words() + u / gpu::MASK_WORD] >> (u % gpu::MASK_WORD) & 1u));
        }
        return result;
    }
};

INSTANTIATE_TEST_SUITE_P(Sizes, PreprocessKernel, testing::Range(size_t{0}, test_cameras().size()),
                         [](const auto& test) {
                             const auto camera = test_cameras()[test.param];
                             return std::to_string(camera.width) + "x" + std::to_string(camera.height);
                         });

// ---------------------------------------------------------------------------------------------------------- masks

TEST_P(PreprocessKernel, MaskPackSetsOneBitPerLabelledPixel) {
    const auto labels = blobs(camera, 1);
    auto colors = smooth_colors(camera, 2);
    for (size_t i = 0; i < n; ++i) colors[i] |= std::uint32_t{labels[i]} << 24;
    Launch launch("preprocess/mask_pack");
    launch.input("params", params).input("color", colors).output<std::uint32_t>("mask", words()).run_over(words());
    EXPECT_EQ(bits(launch.read<std::uint32_t>("mask")), bits(packed(labels)));
}

TEST_P(PreprocessKernel, MaskDilateGrowsByADisc) {
    const auto labels = blobs(camera, 3);
    for (const int radius : {0, 1, 4, 5, 13, 31}) {
        Params p = params;
        p.dilation = static_cast<gpu::uint>(radius);
        Launch launch("preprocess/mask_dilate");
        launch.input("params", p).input("mask", packed(labels)).output<std::uint32_t>("dilated_mask", words());
        launch.run_over(words());
        std::vector<int> expected(n, 0);
        for (int v = 0; v < camera.height; ++v) {
            for (int u = 0; u < camera.width; ++u) {
                if (!labels[static_cast<size_t>(camera.index(u, v))]) continue;
                for (int dv = -radius; dv <= radius; ++dv) {
                    for (int du = -radius; du <= radius; ++du) {
                        if (du * du + dv * dv <= radius * radius && camera.contains(u + du, v + dv)) {
                            expected[static_cast<size_t>(camera.index(u + du, v + dv))] = 1;
                        }
                    }
                }
            }
        }
        EXPECT_EQ(bits(launch.read<std::uint32_t>("dilated_mask")), expected) << "radius " << radius;
    }
}

TEST_P(PreprocessKernel, MaskPackAndDilateIgnoreWhatLiesBehindTheEndOfARow) {
    // a mask whose padding bits are set must not leak into the image when packed by the project's own kernel
    std::vector<std::uint32_t> colors(n, 0);
    for (int v = 0; v < camera.height; ++v) colors[static_cast<size_t>(camera.index(camera.width - 1, v))] = 1u << 24;
    Launch pack("preprocess/mask_pack");
    pack.input("params", params).input("color", colors).output<std::uint32_t>("mask", words()).run_over(words());
    Params p = params;
    p.dilation = 3;
    Launch dilate("preprocess/mask_dilate");
    dilate.input("params", p).input("mask", pack.read<std::uint32_t>("mask"));
    dilate.output<std::uint32_t>("dilated_mask", words()).run_over(words());
    const auto result = bits(dilate.read<std::uint32_t>("dilated_mask"));
    for (int v = 0; v < camera.height; ++v) {
        for (int u = 0; u < camera.width; ++u) {
            ASSERT_EQ(result[static_cast<size_t>(camera.index(u, v))], u >= camera.width - 4) << u << ' ' << v;
        }
    }
}

// ----------------------------------------------------------------------------------------------------- static depth

void expect_static_depth(const Params& params, const std::vector<float>& depth,
                         const std::vector<std::uint32_t>& colors, const std::vector<std::uint32_t>& mask,
                         const std::vector<int>& person) {
    const size_t n = depth.size();
    gpu::TrackingRecord record{};
    record.exposure = {1.1f, 0.9f, 1.3f, 0};
    Launch launch("preprocess/static_depth");
    launch.input("params", params)
        .input("record", record)
        .input("depth", depth)
        .input("color", colors)
        .input("dilated_mask", mask);
    launch.output<float>("static_depth", n).output<float>("intensity", n);
    launch.run_over(vulkan::ceil_div(static_cast<std::uint32_t>(n), gpu::PIXELS_PER_INVOCATION));
    std::vector<double> expected_depth(n), expected_intensity(n);
    for (size_t i = 0; i < n; ++i) {
        const bool usable = !person[i] && depth[i] >= params.depth_min && depth[i] <= params.depth_max;
        expected_depth[i] = usable ? static_cast<double>(depth[i]) : 0.0;
        expected_intensity[i] = person[i] ? -1.0 : luma(in_map_exposure(record, colors[i]));
    }
    expect_near(launch.read<float>("static_depth"), expected_depth, 0.0);    // copied
    expect_near(launch.read<float>("intensity"), expected_intensity, 5e-7);  // three products of floats below 1
}

TEST_P(PreprocessKernel, StaticDepthKeepsDepthInRangeOutsideTheMask) {
    const auto labels = blobs(camera, 4);
    expect_static_depth(params, rough_depth(camera, 5), smooth_colors(camera, 6), packed(labels), bits(packed(labels)));
}

TEST_P(PreprocessKernel, StaticDepthWithoutAnyDepthIsEmpty) {
    expect_static_depth(params, std::vector<float>(n, 0.0f), smooth_colors(camera, 6),
                        std::vector<std::uint32_t>(words(), 0), std::vector<int>(n, 0));
}

TEST_P(PreprocessKernel, StaticDepthOfAFullyMaskedImageIsEmpty) {
    expect_static_depth(params, rough_depth(camera, 5), smooth_colors(camera, 6),
                        std::vector<std::uint32_t>(words(), ~0u), std::vector<int>(n, 1));
}

// --------------------------------------------------------------------------------------------------------- bilateral

std::vector<double> reference_bilateral(const Camera& c, const Params& params, const SlamConfig& config,
                                        const std::vector<float>& depth) {
    const int radius = config.preprocess.bilateral_radius;
    std::vector<double> filtered(depth.size(), 0.0);
    const auto kernel = [](double d2, double sigma) {  // as at BILATERAL_SPREAD
        const double x = 1 - d2 / (2 * gpu::BILATERAL_SPREAD * sigma * sigma);
        return x > 0 ? x * x : 0.0;
    };
    for (int v = 0; v < c.height; ++v) {
        for (int u = 0; u < c.width; ++u) {
            const double z = static_cast<double>(depth[static_cast<size_t>(c.index(u, v))]);
            if (z <= 0) continue;
            const double sigma = PreprocessConfig::kBilateralRange * depth_sigma(params, z);
            double sum = 0, weights = 0;
            for (int dv = -radius; dv <= radius; ++dv) {
                for (int du = -radius; du <= radius; ++du) {
                    const double zn = static_cast<double>(depth[static_cast<size_t>(c.clamped_index(u + du, v + dv))]);
                    if (zn <= 0) continue;
                    const double w = kernel(du * du + dv * dv, PreprocessConfig::kBilateralSpace) *
                                     kernel((zn - z) * (zn - z), sigma);
                    sum += w * zn;
                    weights += w;
                }
            }
            filtered[static_cast<size_t>(c.index(u, v))] = sum / weights;
        }
    }
    return filtered;
}

TEST_P(PreprocessKernel, BilateralSmoothsNoiseAndKeepsSteps) {
    const auto depth = rough_depth(camera, 7);
    for (const int radius : {1, 3, 6}) {
        SlamConfig config;
        config.preprocess.bilateral_radius = radius;
        expect_near(run_bilateral(radius, depth), reference_bilateral(camera, params, config, depth), kSumRounding);
    }
}

TEST_P(PreprocessKernel, BilateralOfNoDepthIsNoDepth) {
    expect_near(run_bilateral(3, std::vector<float>(n, 0.0f)), std::vector<double>(n, 0.0), 0.0);
}

// ---------------------------------------------------------------------------------------------------------- pyramid

TEST_P(PreprocessKernel, DownsampleAveragesTheNearestSurfaceAndBlursIntensity) {
    Random random(8);
    for (const int level : {0, 1}) {
        const Camera fine = camera_at(params, level), half = camera_at(params, level + 1);
        const auto depth = rough_depth(fine, 9);
        const auto colors = smooth_colors(fine, 10);
        std::vector<float> intensity;
        for (const auto color : colors)
            intensity.push_back(random.chance(0.05) ? -1.0f : static_cast<float>(luma(color)));
        const auto m = static_cast<size_t>(half.pixels());
        Launch launch("preprocess/downsample");
        launch.input("params", params).input("depth", depth).input("intensity", intensity);
        launch.output<float>("half_depth", m).output<float>("half_intensity", m).run_over(m, {{"level", level}});

        std::vector<double> expected_depth(m), expected_intensity(m);
        for (int v = 0; v < half.height; ++v) {
            for (int u = 0; u < half.width; ++u) {
                const auto i = static_cast<size_t>(half.index(u, v));
                double nearest = 1e9, sum = 0, count = 0;
                std::vector<double> block;
                for (int k = 0; k < 4; ++k) {
                    const float z = depth[static_cast<size_t>(fine.index(2 * u + k % 2, 2 * v + k / 2))];
                    if (z > 0) block.push_back(static_cast<double>(z));
                }
                for (const double z : block) nearest = std::min(nearest, z);
                for (const double z : block) {
                    if (z <= nearest + gpu::SAME_SURFACE_SIGMAS * depth_sigma(params, nearest)) sum += z, ++count;
                }
                expected_depth[i] = count > 0 ? sum / count : 0.0;

                const double binomial[] = {1, 3, 3, 1};
                double value = 0, weights = 0;
                bool unknown = false;
                for (int dv = 0; dv < 4; ++dv) {
                    for (int du = 0; du < 4; ++du) {
                        const auto s = static_cast<double>(
                            intensity[static_cast<size_t>(fine.clamped_index(2 * u - 1 + du, 2 * v - 1 + dv))]);
                        const bool inner = (du == 1 || du == 2) && (dv == 1 || dv == 2);
                        if (s < 0)
                            unknown = unknown || inner;
                        else
                            value += binomial[du] * binomial[dv] * s, weights += binomial[du] * binomial[dv];
                    }
                }
                expected_intensity[i] = unknown ? -1.0 : value / weights;
            }
        }
        expect_near(launch.read<float>("half_depth"), expected_depth, kSumRounding, ties(m));
        expect_near(launch.read<float>("half_intensity"), expected_intensity, 1e-6);  // mean of 16 floats below 1
    }
}

TEST_P(PreprocessKernel, GradientsAreCentralDifferencesOfKnownIntensity) {
    Random random(11);
    for (const int level : {0, 1, 2}) {
        const Camera c = camera_at(params, level);
        const auto m = static_cast<size_t>(c.pixels());
        std::vector<float> intensity;
        for (const auto color : smooth_colors(c, 12))
            intensity.push_back(random.chance(0.03) ? -1.0f : static_cast<float>(luma(color)));
        Launch launch("preprocess/gradients");
        launch.input("params", params).input("intensity", intensity).output<vec4>("photometric", m);
        launch.run_over(m, {{"level", level}});
        const auto result = launch.read<vec4>("photometric");
        std::vector<vec4> known;
        std::vector<Eigen::Vector4d> expected;
        for (int v = 0; v < c.height; ++v) {
            for (int u = 0; u < c.width; ++u) {
                const auto at = [&](int x, int y) {
                    return static_cast<double>(intensity[static_cast<size_t>(c.clamped_index(x, y))]);
                };
                const bool border = u == 0 || v == 0 || u + 1 == c.width || v + 1 == c.height;
                const bool unknown =
                    border || std::min({at(u, v), at(u - 1, v), at(u + 1, v), at(u, v - 1), at(u, v + 1)}) < 0;
                const auto& pixel = result[static_cast<size_t>(c.index(u, v))];
                if (unknown) {
                    ASSERT_EQ(pixel.x, -1.0f);  // the gradient means nothing there
                    ASSERT_TRUE(std::isfinite(pixel.y) && std::isfinite(pixel.z));
                } else {
                    known.push_back(pixel);
                    expected.emplace_back(at(u, v), 0.5 * (at(u + 1, v) - at(u - 1, v)),
                                          0.5 * (at(u, v + 1) - at(u, v - 1)), 0.0);
                }
            }
        }
        EXPECT_GT(known.size(), m / 3);
        expect_near(known, expected, 1e-7);  // one subtraction of floats below 1
    }
}

// ---------------------------------------------------------------------------------------------------------- normals

/// Bilinear mean of the coarse normals on the surface of a pixel.
Vector3d upsampled_normal(const Params& params, int u, int v, const Camera& fine, double z,
                          const std::vector<vec4>& coarse) {
    const int width = fine.width / 2, height = fine.height / 2;
    const double limit = gpu::SAME_SURFACE_SIGMAS * depth_sigma(params, z) + gpu::STEEPEST_SLOPE * z / fine.fx;
    Vector3d n = Vector3d::Zero();
    for (int k = 0; k < 4; ++k) {
        const bool next_u = k % 2, next_v = k / 2;
        const int cu = std::clamp(u / 2 + (next_u ? (u % 2 ? 1 : -1) : 0), 0, width - 1);
        const int cv = std::clamp(v / 2 + (next_v ? (v % 2 ? 1 : -1) : 0), 0, height - 1);
        const auto& g = coarse[static_cast<size_t>(cv * width + cu)];
        const double weight = (next_u ? 0.25 : 0.75) * (next_v ? 0.25 : 0.75);
        if (std::abs(static_cast<double>(g.w) - z) < limit) n += weight * xyz(g);
    }
    return n;
}

Eigen::Vector4d normalised_or_zero(const Vector3d& n, double z) {
    Eigen::Vector4d result = Eigen::Vector4d::Zero();
    if (z > 0 && n.squaredNorm() > gpu::MIN_NORMAL_LENGTH2) result.head<3>() = n.normalized();
    result(3) = z;
    return result;
}

TEST_P(PreprocessKernel, NormalsUpBlendsCoarseNormalsOfTheSameSurface) {
    const Camera half = camera_at(params, 1);
    const auto depth = rough_depth(camera, 13);
    const auto coarse = rough_geometry(half, rough_depth(half, 13), 14);
    Launch launch("preprocess/normals_up");
    launch.input("params", params).input("depth", depth).input("coarse_geometry", coarse);
    launch.output<vec4>("geometry", n).run_over(n);
    std::vector<Eigen::Vector4d> expected;
    for (int v = 0; v < camera.height; ++v) {
        for (int u = 0; u < camera.width; ++u) {
            const auto z = static_cast<double>(depth[static_cast<size_t>(camera.index(u, v))]);
            expected.push_back(normalised_or_zero(upsampled_normal(params, u, v, camera, z, coarse), z));
        }
    }
    // the shortest sum that is still normalised has length 0.01: rounding 1e-7 of its parts grows to 1e-5
    expect_near(launch.read<vec4>("geometry"), expected, 2e-5, ties(n));
}

TEST_P(PreprocessKernel, NormalsDownAveragesTheBlockOnTheHalfDepth) {
    for (const int level : {0, 1}) {
        const Camera fine = camera_at(params, level), half = camera_at(params, level + 1);
        const auto geometry = rough_geometry(fine, rough_depth(fine, 15), 16);
        const auto half_depth = rough_depth(half, 15);
        const auto m = static_cast<size_t>(half.pixels());
        Launch launch("preprocess/normals_down");
        launch.input("params", params).input("geometry", geometry).input("half_depth", half_depth);
        launch.output<vec4>("half_geometry", m).run_over(m, {{"level", level}});
        std::vector<Eigen::Vector4d> expected;
        for (int v = 0; v < half.height; ++v) {
            for (int u = 0; u < half.width; ++u) {
                const auto z = static_cast<double>(half_depth[static_cast<size_t>(half.index(u, v))]);
                Vector3d sum = Vector3d::Zero();
                for (int k = 0; k < 4; ++k) {
                    const auto& g = geometry[static_cast<size_t>(fine.index(2 * u + k % 2, 2 * v + k / 2))];
                    if (std::abs(static_cast<double>(g.w) - z) < gpu::SAME_SURFACE_SIGMAS * depth_sigma(params, z))
                        sum += xyz(g);
                }
                expected.push_back(normalised_or_zero(sum, z));
            }
        }
        expect_near(launch.read<vec4>("half_geometry"), expected, 2e-5, ties(m));
    }
}

std::vector<vec4> run_plane_normals(const Params& params, int level, int radius, const std::vector<float>& depth,
                                    const std::vector<vec4>* coarse = nullptr) {
    Launch launch("preprocess/plane_normals", {{"RADIUS", radius}});
    launch.input("params", params).input("depth", depth);
    launch.input("coarse_geometry", coarse ? *coarse : std::vector<vec4>(1)).output<vec4>("geometry", depth.size());
    launch.run_over(depth.size(), {{"level", level}, {"use_coarse", coarse != nullptr}});
    return launch.read<vec4>("geometry");
}

TEST_P(PreprocessKernel, PlaneNormalsAreExactOnAPlane) {
    for (const int level : {1, 2}) {
        const Camera c = camera_at(params, level);
        for (const Vector3d& normal : {Vector3d(0, 0, -1), Vector3d(0.5, -0.3, -1), Vector3d(-0.9, 0.1, -1)}) {
            const Vector3d expected_normal = normal.normalized();
            std::vector<float> depth;
            for (int i = 0; i < c.pixels(); ++i) {
                const Vector3d ray = c.back_project(i % c.width, i / c.width, 1);
                depth.push_back(static_cast<float>(-1.6 / expected_normal.dot(ray) * -expected_normal.z()));
            }
            const auto result = run_plane_normals(params, level, 3, depth);
            double worst = 0;
            int at = -1;
            for (int i = 0; i < c.pixels(); ++i) {
                const double error = (xyz(result[static_cast<size_t>(i)]) - expected_normal).norm();
                if (error > worst) worst = error, at = i;
                ASSERT_EQ(result[static_cast<size_t>(i)].w, depth[static_cast<size_t>(i)]);
            }
            // the inverse depth of a plane is linear in the pixel: what is left is rounding of 1 / z, times the focal
            // length
            EXPECT_LT(worst, 5e-4) << "level " << level << ", normal " << expected_normal.transpose() << ", at "
                                   << at % c.width << ' ' << at / c.width;
        }
    }
}

/// Least squares of 1/z = d + a du + b dv over the window's pixels on the centre's surface, then the blend with the
/// coarser level.
Eigen::Vector4d reference_plane_normal(const Params& params, const Camera& c, int radius,
                                       const std::vector<float>& depth, int u, int v, const std::vector<vec4>* coarse) {
    const auto z = static_cast<double>(depth[static_cast<size_t>(c.index(u, v))]);
    if (z <= 0) return {0, 0, 0, z};
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Vector3d rhs = Vector3d::Zero();
    for (int dv = -radius; dv <= radius; ++dv) {
        for (int du = -radius; du <= radius; ++du) {
            if (!c.contains(u + du, v + dv)) continue;
            const auto zn = static_cast<double>(depth[static_cast<size_t>(c.index(u + du, v + dv))]);
            const double reach = gpu::SAME_SURFACE_SIGMAS * depth_sigma(params, z) +
                                 gpu::STEEPEST_SLOPE * z / c.fx * std::max(std::abs(du), std::abs(dv));
            if (zn <= 0 || std::abs(zn - z) >= reach) continue;
            const Vector3d row(1, du, dv);
            A += row * row.transpose();
            rhs += row / zn;
        }
    }
    const double window = (2 * radius + 1) * (2 * radius + 1);
    // moments about the mean: the pixels must spread in both directions
    const double cuu = A(1, 1) - A(0, 1) * A(0, 1) / A(0, 0), cvv = A(2, 2) - A(0, 2) * A(0, 2) / A(0, 0);
    const double cuv = A(1, 2) - A(0, 1) * A(0, 2) / A(0, 0);
    Vector3d n = Vector3d::Zero();
    if (A(0, 0) >= gpu::MIN_PLANE_SHARE * window && cuu * cvv - cuv * cuv > gpu::MIN_PLANE_SPREAD * cuu * cvv) {
        const Vector3d fit = A.ldlt().solve(rhs);  // d, a, b
        n = -Vector3d(c.fx * fit(1), c.fy * fit(2), fit(0) + fit(1) * (c.cx - u) + fit(2) * (c.cy - v)).normalized();
    }
    if (coarse) {
        const double error = depth_sigma(params, z) * c.fx / (z * (2 * radius + 1)) / gpu::TOLERABLE_NORMAL_ERROR;
        n += error * error * upsampled_normal(params, u, v, c, z, *coarse);
        return normalised_or_zero(n, z);
    }
    return {n.x(), n.y(), n.z(), z};
}

TEST_P(PreprocessKernel, PlaneNormalsFitTheCentresSurface) {
    for (const int level : {1, 2}) {
        const Camera c = camera_at(params, level), half = camera_at(params, level + 1);
        const auto depth = rough_depth(c, 18);
        const auto coarse = rough_geometry(half, rough_depth(half, 18), 19);
        for (const int radius : {2, 3, 4}) {
            for (const bool use_coarse : {false, true}) {
                if (use_coarse && level == 2) continue;  // the coarsest level has none below
                std::vector<Eigen::Vector4d> expected;
                for (int v = 0; v < c.height; ++v) {
                    for (int u = 0; u < c.width; ++u) {
                        expected.push_back(
                            reference_plane_normal(params, c, radius, depth, u, v, use_coarse ? &coarse : nullptr));
                    }
                }
                // 1 / z is kept relative to the centre's in float: 1e-7 of it, times the focal length over the window
                expect_near(run_plane_normals(params, level, radius, depth, use_coarse ? &coarse : nullptr), expected,
                            5e-4, 2 + 5 * ties(static_cast<size_t>(c.pixels())));
            }
        }
    }
}

TEST_P(PreprocessKernel, PlaneNormalsPointTowardsTheCamera) {
    const Camera c = camera_at(params, 1);
    const auto depth = rough_depth(c, 17);
    for (size_t i = 0; const auto& g : run_plane_normals(params, 1, 3, depth)) {
        const Vector3d ray = c.back_project(static_cast<double>(i % static_cast<size_t>(c.width)),
                                            static_cast<double>(i / static_cast<size_t>(c.width)), 1);
        ASSERT_LE(xyz(g).dot(ray), 1e-6);
        ++i;
    }
}

TEST_P(PreprocessKernel, PlaneNormalsOfNoDepthAreUnknown) {
    const Camera c = camera_at(params, 1);
    for (const auto& g : run_plane_normals(params, 1, 3, std::vector<float>(static_cast<size_t>(c.pixels()), 0.0f))) {
        ASSERT_EQ(xyz(g), Vector3d::Zero());
        ASSERT_EQ(g.w, 0.0f);
    }
}

}  // namespace
}  // namespace posefusion::test
