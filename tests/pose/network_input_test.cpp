#include "pose/network_input.hpp"

#include <gtest/gtest.h>

namespace posefusion {
namespace {

TEST(NetworkInput, KeepsTheAspectUpToTheStride) {
    const InputSize landscape = fit_network_input(640, 480, {}, 256, 32);
    EXPECT_EQ(landscape.width, 256);
    EXPECT_EQ(landscape.height, 192);
    const InputSize portrait = fit_network_input(480, 640, {}, 256, 32);
    EXPECT_EQ(portrait.width, 192);
    EXPECT_EQ(portrait.height, 256);
    const InputSize wide = fit_network_input(1241, 376, {}, 256, 32);
    EXPECT_EQ(wide.width, 256);
    EXPECT_EQ(wide.height, 64);
}

TEST(NetworkInput, IsNeverEmpty) {
    const InputSize size = fit_network_input(4000, 3, {}, 256, 32);
    EXPECT_EQ(size.width, 256);
    EXPECT_EQ(size.height, 32);
}

TEST(NetworkInput, FixedSizesWin) {
    const InputSize size = fit_network_input(480, 640, {320, 240}, 256, 8);
    EXPECT_EQ(size.width, 320);
    EXPECT_EQ(size.height, 240);
}

TEST(NetworkInput, OrdersAndScalesTheChannels) {
    const ColorImage image(4, 4, Rgb8{255, 51, 0});
    const Tensor rgb = make_network_input(image, {4, 4}, {.bgr = false, .scale = 1 / 127.5f, .offset = -1});
    EXPECT_NEAR(rgb.at(0, 1, 1), 1.0f, 1e-6f);
    EXPECT_NEAR(rgb.at(1, 1, 1), -0.6f, 1e-6f);
    EXPECT_NEAR(rgb.at(2, 1, 1), -1.0f, 1e-6f);
    const Tensor bgr = make_network_input(image, {4, 4}, {.bgr = true, .scale = 1 / 255.0f, .offset = -0.5f});
    EXPECT_NEAR(bgr.at(0, 1, 1), -0.5f, 1e-6f);
    EXPECT_NEAR(bgr.at(1, 1, 1), -0.3f, 1e-6f);
    EXPECT_NEAR(bgr.at(2, 1, 1), 0.5f, 1e-6f);
}

TEST(NetworkInput, ShrinksByAveraging) {
    ColorImage stripes(8, 8);
    for (int v = 0; v < 8; ++v) {
        for (int u = 0; u < 8; ++u) stripes(u, v).r = u % 2 ? 200 : 100;
    }
    const Tensor input = make_network_input(stripes, {4, 4}, {});
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 4; ++x) EXPECT_FLOAT_EQ(input.at(0, y, x), 150.0f);
    }
}

}  // namespace
}  // namespace posefusion
