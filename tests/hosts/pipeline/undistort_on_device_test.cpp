// The lens undone by the device: the same bytes as by the CPU, OpenCV's remap(), which is the reference here.
#include "hosts/pipeline/undistort_on_device.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "engine/core/error.hpp"
#include "hosts/pipeline/posefusion.hpp"

namespace posefusion {
namespace {

/// Like the colour camera of freiburg1, at an odd size.
const Camera kPincushion{
    {170.1f, 169.8f, 104.8f, 83.9f, 211, 157}, 5000, {0.2624f, -0.9531f, -0.0054f, 0.0026f, 1.1633f}};
/// Barrel, no two numbers alike.
const Camera kBarrel{{131.25f, 130.0f, 80.5f, 58.5f, 160, 120}, 5000, {-0.22f, 0.06f, 0.004f, -0.003f, -0.01f}};
/// No lens is like this: the model folds the image over, its corners lie far outside.
const Camera kAbsurd{{60, 60, 81, 59, 160, 120}, 5000, {3, -7, 0.2f, -0.3f, 40}};
/// Squares of a radius of some 1e30 pixels are infinite, and their differences no numbers.
const Camera kInfinite{{0.001f, 0.001f, 80, 60, 160, 120}, 5000, {1e30f, -1e30f, 1e30f, 1e30f, -1e30f}};

ColorImage color_of(const Camera& camera, unsigned seed) {
    std::mt19937 random(seed);
    ColorImage color(camera.intrinsics.width, camera.intrinsics.height);
    for (Rgb8& c : color) c = unpack_rgb(static_cast<std::uint32_t>(random()));
    return color;
}

DepthImage depth_of(const Camera& camera, unsigned seed) {
    std::mt19937 random(seed);
    DepthImage depth(camera.intrinsics.width, camera.intrinsics.height);
    for (float& z : depth) z = static_cast<float>(random() % 5000) / 1000;
    return depth;
}

bool equal(const auto& a, const auto& b) {
    return a.width() == b.width() && a.height() == b.height() && std::equal(a.begin(), a.end(), b.begin());
}

/// A device is needed; what it tracks does not matter.
class UndistortOnDevice : public testing::Test {
protected:
    static void SetUpTestSuite() {
        SlamConfig config;
        config.validation = true;
        slam_ = std::make_unique<Slam>(Intrinsics{100, 100, 32, 24, 64, 48}, config);
    }
    static void TearDownTestSuite() { slam_.reset(); }
    void TearDown() override { EXPECT_EQ(slam_->validation_messages(), 0u); }

    static inline std::unique_ptr<Slam> slam_;
};

TEST_F(UndistortOnDevice, GivesTheBytesOfTheCpu) {
    for (const Camera& camera : {kPincushion, kBarrel, kAbsurd, kInfinite}) {
        for (const float scale : {1.0f, 0.5f}) {
            const ImageGeometry cpu(camera, scale);
            ImageGeometry device = cpu;
            undistort_on_device(device, *slam_);
            for (unsigned seed = 0; seed < 2; ++seed) {
                const ColorImage color = color_of(camera, seed);
                const DepthImage depth = depth_of(camera, seed);
                const auto a = cpu.from_source(color, depth), b = device.from_source(color, depth);
                EXPECT_TRUE(equal(a.color, b.color)) << camera.distortion[0] << " at scale " << scale;
                EXPECT_TRUE(equal(a.depth, b.depth)) << camera.distortion[0] << " at scale " << scale;
                EXPECT_FALSE(a.undistort.device_ms.has_value());
                EXPECT_TRUE(b.undistort.device_ms.has_value()) << "the device has not been asked";
                EXPECT_TRUE(equal(a.color, cpu.from_source(color))) << "both images of a frame as each on its own";
                EXPECT_TRUE(equal(a.depth, cpu.from_source(depth)));
            }
        }
    }
}

TEST_F(UndistortOnDevice, LooksOutsideWhereTheLensShowsNothing) {
    const ImageGeometry geometry(kPincushion, 1);
    const LensMap& lens = geometry.lens();
    const auto outside = static_cast<std::size_t>(
        std::count_if(lens.begin(), lens.end(), [](PixelPosition p) { return p.u < -0.5f || p.v < -0.5f; }));
    EXPECT_GT(outside, 20u) << "otherwise these tests show less than they should";
    DepthImage full(211, 157);
    for (float& z : full) z = 1;
    ImageGeometry device = geometry;
    undistort_on_device(device, *slam_);
    const DepthImage ideal = device.from_source(ColorImage(211, 157), full).depth;
    EXPECT_GE(static_cast<std::size_t>(std::count(ideal.begin(), ideal.end(), 0.0f)), outside / 2)
        << "cropped by 3 columns and a row";
}

TEST_F(UndistortOnDevice, AnAbsurdLensIsOfFinitePlaces) {
    const ImageGeometry geometry(kInfinite, 1);
    for (const PixelPosition p : geometry.lens()) ASSERT_TRUE(std::isfinite(p.u) && std::isfinite(p.v));
}

TEST_F(UndistortOnDevice, LeavesOtherCamerasAlone) {
    const Camera ideal{kBarrel.intrinsics, 5000, {}};
    ImageGeometry geometry(ideal, 1);
    undistort_on_device(geometry, *slam_);
    const ColorImage color = color_of(ideal, 1);
    const auto images = geometry.from_source(color, depth_of(ideal, 1));
    EXPECT_TRUE(equal(images.color, color));
    EXPECT_FALSE(images.undistort.device_ms.has_value());
}

TEST_F(UndistortOnDevice, ImagesOfAnotherSizeAreRefused) {
    ImageGeometry geometry(kBarrel, 1);
    undistort_on_device(geometry, *slam_);
    EXPECT_THROW((void)geometry.from_source(ColorImage(120, 160), DepthImage(160, 120)), Error);
    EXPECT_THROW((void)geometry.from_source(ColorImage(160, 120), DepthImage(120, 160)), Error);
}

TEST_F(UndistortOnDevice, TheTimeComesFirst) {
    FrameResult result;
    result.gpu_times = {{"preprocess", 1}};
    Frame frame;
    add_undistortion_time(frame, result);
    ASSERT_EQ(result.gpu_times.size(), 1u);
    frame.undistort.device_ms = 0.5;
    add_undistortion_time(frame, result);
    ASSERT_EQ(result.gpu_times.size(), 2u);
    EXPECT_EQ(result.gpu_times[0].name, "undistort");
    EXPECT_EQ(result.gpu_times[0].milliseconds, 0.5);
}

/// What the library and Python use: frames through a lens, and the same frames with the lens undone by the CPU.
TEST_F(UndistortOnDevice, GivesTheSamePoses) {
    RunConfig config;
    config.no_people = true;
    config.slam.validation = true;
    const ImageGeometry cpu(kBarrel, 1);
    PoseFusion lens(kBarrel, config), ideal({cpu.intrinsics(), 5000, {}}, config);
    for (int i = 0; i < 3; ++i) {
        // a wavy, painted wall that moves to the side
        ColorImage color(160, 120);
        DepthImage depth(160, 120);
        for (int v = 0; v < 120; ++v) {
            for (int u = 0; u < 160; ++u) {
                const double x = (u + 2 * i) * 0.11, y = v * 0.13;
                color(u, v) = {static_cast<std::uint8_t>(128 + 90 * std::sin(x) * std::cos(y)),
                               static_cast<std::uint8_t>(128 + 90 * std::sin(0.6 * x + y)),
                               static_cast<std::uint8_t>(128 + 90 * std::cos(0.4 * x - 0.7 * y))};
                depth(u, v) = static_cast<float>(1.5 + 0.2 * std::sin(0.5 * x) + 0.2 * std::cos(0.6 * y));
            }
        }
        const auto through_lens = lens.process(color, depth, std::chrono::seconds(i));
        const auto expected = ideal.process(cpu.from_source(color), cpu.from_source(depth), std::chrono::seconds(i));
        EXPECT_EQ(through_lens.result.T_world_camera.matrix(), expected.result.T_world_camera.matrix())
            << "frame " << i;
        EXPECT_EQ(through_lens.result.surfels, expected.result.surfels);
        ASSERT_FALSE(through_lens.result.gpu_times.empty());
        EXPECT_EQ(through_lens.result.gpu_times[0].name, "undistort");
        EXPECT_NE(expected.result.gpu_times.at(0).name, "undistort");
    }
    EXPECT_GT(lens.engine().surfels(false).size(), 5000u);
    EXPECT_EQ(lens.engine().validation_messages(), 0u);
}

}  // namespace
}  // namespace posefusion
