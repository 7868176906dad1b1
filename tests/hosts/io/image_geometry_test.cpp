#include "hosts/io/image_geometry.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

Camera camera(int width, int height) {
    return {{500, 510, static_cast<float>(width) / 2, static_cast<float>(height) / 2, width, height}, 5000, {}};
}

TEST(ImageGeometry, FullScaleChangesNothing) {
    const ImageGeometry geometry(camera(64, 48), 1);
    ColorImage color(64, 48);
    DepthImage depth(64, 48);
    LabelImage labels(64, 48);
    for (std::size_t i = 0; i < color.size(); ++i) {
        color[i] = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i / 7), 3};
        depth[i] = 0.001f * static_cast<float>(i);
        labels[i] = static_cast<std::uint8_t>(i % 3);
    }
    const auto c = geometry.from_source(color);
    const auto d = geometry.from_source(depth);
    const auto l = geometry.from_source(labels), back = geometry.to_source(labels);
    EXPECT_TRUE(std::equal(c.begin(), c.end(), color.begin()));
    EXPECT_TRUE(std::equal(d.begin(), d.end(), depth.begin()));
    EXPECT_TRUE(std::equal(l.begin(), l.end(), labels.begin()));
    EXPECT_TRUE(std::equal(back.begin(), back.end(), labels.begin()));
    EXPECT_FLOAT_EQ(geometry.intrinsics().cx, 32);
}

TEST(ImageGeometry, WholeBlocksGiveTheScaledCamera) {
    const Camera full = camera(640, 480);
    for (const float scale : {0.5f, 0.25f}) {
        const Intrinsics a = ImageGeometry(full, scale).intrinsics(), b = full.intrinsics.scaled(scale);
        EXPECT_FLOAT_EQ(a.fx, b.fx);
        EXPECT_FLOAT_EQ(a.fy, b.fy);
        EXPECT_FLOAT_EQ(a.cx, b.cx);
        EXPECT_FLOAT_EQ(a.cy, b.cy);
        EXPECT_EQ(a.width, b.width);
        EXPECT_EQ(a.height, b.height);
    }
}

TEST(ImageGeometry, SizesAreCroppedToMultiplesOfFour) {
    const Camera full = camera(1241, 376);
    const Intrinsics whole = ImageGeometry(full, 1).intrinsics();
    EXPECT_EQ(whole.width, 1240);
    EXPECT_EQ(whole.height, 376);
    EXPECT_FLOAT_EQ(whole.fx, full.intrinsics.fx);
    EXPECT_FLOAT_EQ(whole.cx, full.intrinsics.cx);
    for (const float scale : {0.9f, 0.7f, 0.6f, 0.33f, 0.1f}) {
        const Intrinsics K = ImageGeometry(full, scale).intrinsics();
        EXPECT_EQ(K.width % 4, 0);
        EXPECT_EQ(K.height % 4, 0);
        EXPECT_NEAR(K.fx, full.intrinsics.fx * scale, 0.02f * full.intrinsics.fx * scale);
        EXPECT_GT(K.width, 0);
    }
}

TEST(ImageGeometry, ScalesThatMakeNoSenseAreRefused) {
    for (const float scale : {0.0f, -1.0f, 1.01f, std::nanf(""), 0.001f})
        EXPECT_THROW(ImageGeometry(camera(640, 480), scale), Error) << scale;
}

TEST(ImageGeometry, ImagesOfAnotherSizeAreRefused) {
    EXPECT_THROW((void)ImageGeometry(camera(64, 48), 1).from_source(DepthImage(48, 64)), Error);
    EXPECT_THROW((void)ImageGeometry(camera(64, 48), 0.5f).to_source(LabelImage(64, 48)), Error);
}

TEST(ImageGeometry, ColourShrinksByArea) {
    ColorImage color(16, 8);
    for (int v = 0; v < 8; ++v)
        for (int u = 0; u < 16; ++u) color(u, v) = {static_cast<std::uint8_t>((u % 2) * 100 + (v % 2) * 50), 40, 0};
    const ColorImage half = ImageGeometry(camera(16, 8), 0.5f).from_source(color);
    ASSERT_EQ(half.width(), 8);
    for (const Rgb8 c : half) EXPECT_EQ(c, (Rgb8{75, 40, 0}));
}

TEST(ImageGeometry, DepthNeverMixesForegroundAndBackground) {
    // A step edge at every position within the blocks: results are one surface or the other.
    for (const float scale : {0.5f, 0.25f}) {
        for (int edge = 20; edge < 28; ++edge) {
            DepthImage depth(64, 48);
            for (int v = 0; v < 48; ++v)
                for (int u = 0; u < 64; ++u) depth(u, v) = u + v / 3 < edge ? 1.0f : 3.0f;
            for (const float d : ImageGeometry(camera(64, 48), scale).from_source(depth))
                EXPECT_TRUE(d == 1.0f || d == 3.0f) << d << " at edge " << edge << ", scale " << scale;
        }
    }
}

TEST(ImageGeometry, DepthOfAPlaneStaysOnThePlane) {
    // 1/z is linear in the pixel coordinates on a plane; the mean of a block is the depth at its centre.
    const Camera full = camera(64, 48);
    const auto plane = [](double u, double v) { return 1.0 / (0.5 + 0.0005 * u + 0.001 * v); };
    DepthImage depth(64, 48);
    for (int v = 0; v < 48; ++v)
        for (int u = 0; u < 64; ++u) depth(u, v) = static_cast<float>(plane(u, v));
    const DepthImage half = ImageGeometry(full, 0.5f).from_source(depth);
    for (int v = 0; v < half.height(); ++v)
        for (int u = 0; u < half.width(); ++u) EXPECT_NEAR(half(u, v), plane(2 * u + 0.5, 2 * v + 0.5), 1e-5);
}

TEST(ImageGeometry, ADeformationOfDepthIsUndone) {
    Camera deformed = camera(64, 48);
    for (std::size_t i = 0; i < DepthDeformation::kNodes; ++i)
        deformed.deformation.nodes[i] = 0.001f * static_cast<float>(i);
    DepthImage measured(64, 48, 2.0f);
    measured(5, 5) = 0;
    const DepthImage depth = ImageGeometry(deformed, 1).from_source(measured);
    EXPECT_FLOAT_EQ(depth(0, 0), 2) << "the first node is 0";
    EXPECT_NEAR(1 / depth(63, 47), 0.5f + 0.019f, 1e-6f) << "the last node";
    // between the nodes 0 1 and 5 6 of the grid, whose rows have five nodes
    constexpr float kColumn = 63.0f / 4, kRow = 47.0f / 3;
    EXPECT_NEAR(1 / depth(4, 8), 0.5f + 0.001f * (4 / kColumn + 5 * 8 / kRow), 1e-6f);
    EXPECT_EQ(depth(5, 5), 0) << "no measurement";
}

TEST(ImageGeometry, MissingDepthIsNotInventedButSmallHolesClose) {
    DepthImage depth(16, 16, 2.0f);
    depth(0, 0) = 0;                              // one of four: closed
    depth(2, 0) = depth(3, 0) = 0;                // two of four: closed
    depth(4, 0) = depth(5, 0) = depth(4, 1) = 0;  // three of four: missing
    const DepthImage half = ImageGeometry(camera(16, 16), 0.5f).from_source(depth);
    EXPECT_EQ(half(0, 0), 2.0f);
    EXPECT_EQ(half(1, 0), 2.0f);
    EXPECT_EQ(half(2, 0), 0.0f);
    EXPECT_EQ(half(3, 0), 2.0f);
}

TEST(ImageGeometry, LabelsComeBackAsTheyWere) {
    for (const float scale : {0.5f, 0.25f, 0.7f}) {
        const ImageGeometry geometry(camera(64, 48), scale);
        LabelImage labels(geometry.intrinsics().width, geometry.intrinsics().height);
        for (std::size_t i = 0; i < labels.size(); ++i) labels[i] = static_cast<std::uint8_t>(i * 7919 % 5);
        const LabelImage full = geometry.to_source(labels);
        EXPECT_EQ(full.width(), 64);
        EXPECT_EQ(full.height(), 48);
        const LabelImage back = geometry.from_source(full);
        EXPECT_TRUE(std::equal(back.begin(), back.end(), labels.begin())) << scale;
    }
}

/// The colour camera of freiburg1.
const Camera kDistorted{
    {517.3f, 516.5f, 318.6f, 255.3f, 640, 480}, 5000, {0.2624f, -0.9531f, -0.0054f, 0.0026f, 1.1633f}};

TEST(ImageGeometry, ADistortedLineBecomesStraight) {
    // Where Brown's model puts the points of the vertical line x = 0.4 m at z = 1 m; written out once more on purpose.
    const Intrinsics& K = kDistorted.intrinsics;
    const auto [k1, k2, p1, p2, k3, k4, k5, k6] = kDistorted.distortion;
    DepthImage depth(640, 480);
    for (double y = -0.35; y <= 0.35; y += 0.0005) {
        const double x = 0.4, r2 = x * x + y * y, radial = 1 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
        ASSERT_TRUE(k4 == 0 && k5 == 0 && k6 == 0);
        const double xd = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
        const double yd = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
        const int u = static_cast<int>(std::lround(K.fx * xd + K.cx)),
                  v = static_cast<int>(std::lround(K.fy * yd + K.cy));
        for (int du = -1; du <= 1; ++du) depth(u + du, v) = 1;
    }
    const DepthImage ideal = ImageGeometry(kDistorted, 1).from_source(depth);
    const int column = static_cast<int>(std::lround(K.fx * 0.4 + K.cx));
    int rows = 0;
    for (int v = 90; v <= 420; ++v) rows += ideal(column, v) > 0 ? 1 : 0;
    EXPECT_EQ(rows, 331);
}

TEST(ImageGeometry, DistortedLabelsComeBackWhereTheyWere) {
    const ImageGeometry geometry(kDistorted, 1);
    LabelImage labels(640, 480);
    for (int v = 100; v < 300; ++v)
        for (int u = 420; u < 560; ++u) labels(u, v) = 2;
    const LabelImage back = geometry.to_source(geometry.from_source(labels));
    int wrong = 0;
    for (std::size_t i = 0; i < labels.size(); ++i) wrong += back[i] != labels[i] ? 1 : 0;
    EXPECT_LT(wrong, 680) << "more than the outline differs";
}

}  // namespace
}  // namespace posefusion
