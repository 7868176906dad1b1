#include "hosts/io/lens.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace posefusion {
namespace {

/// The colour camera of an Azure Kinect.
constexpr LensCoefficients kRational{0.5f, -2.7f, 0.0006f, -0.0002f, 1.58f, 0.39f, -2.53f, 1.51f};

TEST(Lens, WithoutCoefficientsChangesNothing) {
    for (const PlanePoint p : {PlanePoint{0, 0}, PlanePoint{0.7f, -0.4f}}) {
        EXPECT_EQ(distort(p, {}).x, p.x);
        EXPECT_EQ(distort(p, {}).y, p.y);
        EXPECT_EQ(undistort(p, {}).x, p.x);
    }
}

/// Values of cv::projectPoints() with these coefficients and the identity as camera matrix.
TEST(Lens, TheRationalModelIsThatOfOpenCv) {
    struct Sample {
        PlanePoint ideal, distorted;
    };
    for (const Sample& s : std::vector<Sample>{{{0.1f, 0.2f}, {0.100511671f, 0.201073342f}},
                                               {{0.5f, -0.3f}, {0.511047060f, -0.306465036f}},
                                               {{-0.4f, 0.35f}, {-0.408390350f, 0.357461619f}}}) {
        const PlanePoint p = distort(s.ideal, kRational);
        EXPECT_NEAR(p.x, s.distorted.x, 1e-6f);
        EXPECT_NEAR(p.y, s.distorted.y, 1e-6f);
    }
}

TEST(Lens, UndistortingIsTheInverse) {
    for (const LensCoefficients& lens : {kRational, LensCoefficients{0.2624f, -0.9531f, -0.0054f, 0.0026f, 1.1633f}})
        for (const PlanePoint p : {PlanePoint{0.1f, 0.2f}, PlanePoint{-0.5f, 0.3f}, PlanePoint{0.4f, -0.35f}}) {
            const PlanePoint back = undistort(distort(p, lens), lens);
            EXPECT_NEAR(back.x, p.x, 2e-6f);
            EXPECT_NEAR(back.y, p.y, 2e-6f);
        }
}

}  // namespace
}  // namespace posefusion
