#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/depth_noise.hpp"
#include "engine/core/image.hpp"
#include "engine/core/pinhole.hpp"

namespace posefusion {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr Intrinsics kCamera{500, 400, 99.5f, 79.5f, 200, 160};

TEST(Pinhole, TheOpticalAxisIsSeenAtThePrincipalPoint) {
    EXPECT_EQ(project(Vector3f(0, 0, 3), kCamera), Vector2f(99.5f, 79.5f));
    EXPECT_EQ(pixel_ray(99.5f, 79.5f, kCamera), Vector3f(0, 0, 1));
}

TEST(Pinhole, APointIsSeenWhereItWasProjectedFrom) {
    for (const Vector2f& pixel : {Vector2f(0, 0), Vector2f(12.25f, 150), Vector2f(199, 3.5f), Vector2f(-40, 300)}) {
        const Vector3f point = back_project(pixel.x(), pixel.y(), 2.5f, kCamera);
        EXPECT_EQ(point.z(), 2.5f);
        EXPECT_LT((project(point, kCamera) - pixel).norm(), 1e-4f);
        EXPECT_LT((project(point.cast<double>(), kCamera) - pixel.cast<double>()).norm(), 1e-4);
    }
}

TEST(Pinhole, FocalLengthsAreThoseOfTheirDirection) {
    EXPECT_EQ(project(Vector3f(1, 0, 5), kCamera), Vector2f(199.5f, 79.5f));
    EXPECT_EQ(project(Vector3f(0, 1, 5), kCamera), Vector2f(99.5f, 159.5f));
}

TEST(Pinhole, TheImageReachesToTheCentresOfItsOuterPixels) {
    EXPECT_TRUE(in_image(Vector2f(0, 0), kCamera));
    EXPECT_TRUE(in_image(Vector2f(199, 159), kCamera));
    for (const Vector2f& outside :
         {Vector2f(-0.1f, 5), Vector2f(5, -0.1f), Vector2f(199.1f, 5), Vector2f(5, 159.1f), Vector2f(NAN, 5)})
        EXPECT_FALSE(in_image(outside, kCamera)) << outside.transpose();
}

TEST(PackedColor, RedIsTheLowestByteAndComesBack) {
    static_assert(pack_rgb({1, 2, 3}) == 0x030201u);
    static_assert(unpack_rgb(0xff030201u) == Rgb8{1, 2, 3});
    EXPECT_EQ(unpack_rgb(pack_rgb({255, 128, 7})), (Rgb8{255, 128, 7}));
}

TEST(DepthNoise, GrowsWithTheSquareOfTheDistance) {
    const DepthNoise noise{.a = 0.001f, .b = 0.002f, .c = 0.5f};
    EXPECT_FLOAT_EQ(noise.sigma(0.5f), 0.001f);
    EXPECT_FLOAT_EQ(noise.sigma(2.5f), 0.009f);
    EXPECT_FLOAT_EQ(noise.sigma(4.5f), 0.033f);
}

}  // namespace
}  // namespace posefusion
