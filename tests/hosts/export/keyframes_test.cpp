#include "hosts/export/keyframes.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace posefusion {
namespace {

/// Stripes of the width `period`, as a camera sees them that moves by `blur` pixels during the exposure.
ColorImage stripes(int period, int blur = 1) {
    ColorImage image(160, 120);
    for (int v = 0; v < image.height(); ++v) {
        for (int u = 0; u < image.width(); ++u) {
            int sum = 0;
            for (int k = 0; k < blur; ++k) sum += (u + k) / period % 2 == 0 ? 40 : 200;
            const auto grey = static_cast<std::uint8_t>(sum / blur);
            image(u, v) = {grey, grey, grey};
        }
    }
    return image;
}

KeyframeCandidate at(double x, double degrees, double sharpness = 100) {
    KeyframeCandidate candidate{Eigen::Isometry3d::Identity(), sharpness};
    candidate.T_world_camera.translation().x() = x;
    candidate.T_world_camera.rotate(
        Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Eigen::Vector3d(0, 1, 0.3).normalized()));
    return candidate;
}

using Places = std::vector<std::size_t>;

TEST(Sharpness, FallsWithMotionBlur) {
    const double sharp = sharpness(stripes(8)), blurred = sharpness(stripes(8, 4)), worse = sharpness(stripes(8, 8));
    EXPECT_GT(sharp, 2 * blurred);
    EXPECT_GT(blurred, worse);
}

TEST(Sharpness, OfAPlainImageIsZero) {
    EXPECT_EQ(sharpness(ColorImage(64, 48)), 0);
    EXPECT_EQ(sharpness(ColorImage(1, 1)), 0);
}

TEST(Sharpness, DoesNotLookAtPeople) {
    ColorImage image = stripes(8);
    LabelImage labels(image.width(), image.height());
    for (int v = 0; v < image.height(); ++v)
        for (int u = 0; u < image.width(); ++u)
            if (u < 80) labels(u, v) = 1;
    const double alone = sharpness(image, labels);
    for (int v = 0; v < image.height(); ++v)
        for (int u = 0; u < 80; ++u) image(u, v) = {200, 0, 0};
    EXPECT_EQ(sharpness(image, labels), alone);
    EXPECT_EQ(sharpness(image, LabelImage(image.width(), image.height())), sharpness(image));
}

TEST(Keyframes, FollowTheDistance) {
    std::vector<KeyframeCandidate> frames;
    for (int i = 0; i <= 40; ++i) frames.push_back(at(0.0101 * i, 0));
    // equally sharp: the first of a window counts
    EXPECT_EQ(choose_keyframes(frames, {.distance = 0.1f}), (Places{0, 10, 20, 30, 40}));
}

TEST(Keyframes, FollowTheAngle) {
    std::vector<KeyframeCandidate> frames;
    for (int i = 0; i <= 20; ++i) frames.push_back(at(0, 1.01 * i));
    EXPECT_EQ(choose_keyframes(frames, {.angle = 10}), (Places{0, 10, 20}));
}

TEST(Keyframes, AreTheSharpestNearby) {
    std::vector<KeyframeCandidate> frames;
    for (int i = 0; i <= 40; ++i) frames.push_back(at(0.0101 * i, 0));
    frames[13].sharpness = 150;
    frames[26].sharpness = 150;  // beyond half a step after the next is due
    EXPECT_EQ(choose_keyframes(frames, {.distance = 0.1f}), (Places{0, 13, 26, 36}));
}

TEST(Keyframes, AreNotBlurred) {
    std::vector<KeyframeCandidate> frames;
    for (int i = 0; i <= 30; ++i) frames.push_back(at(0.0101 * i, 0));
    for (std::size_t i = 8; i < 18; ++i) frames[i].sharpness = 40;  // longer than a window
    EXPECT_EQ(choose_keyframes(frames, {.distance = 0.1f}), (Places{0, 18, 28}));
}

TEST(Keyframes, OfACameraThatStandsStillAreOne) {
    EXPECT_EQ(choose_keyframes(std::vector<KeyframeCandidate>(50, at(0, 0)), {}), (Places{0}));
    EXPECT_TRUE(choose_keyframes({}, {}).empty());
}

}  // namespace
}  // namespace posefusion
