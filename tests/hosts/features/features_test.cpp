// Features of a rendered room: spread over it, none on people, the same whatever the number of threads.
#include "hosts/features/features.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <set>

#include "engine/core/pinhole.hpp"
#include "tests/engine/support/reference.hpp"
#include "tests/engine/support/synthetic_room.hpp"

namespace posefusion {
namespace {

const Intrinsics kCamera{525, 525, 319.5f, 239.5f, 640, 480};
const FeatureConfig kConfig;

test::Frame room(const Eigen::Isometry3d& T_world_camera = Eigen::Isometry3d::Identity(),
                 const std::optional<test::Ball>& ball = {}) {
    return test::render_room(kCamera, T_world_camera, ball);
}

bool are_equal(const Features& a, const Features& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Feature& x, const Feature& y) {
        return x.pixel == y.pixel && x.depth == y.depth && x.sigma == y.sigma && x.descriptor == y.descriptor;
    });
}

TEST(Features, AreSpreadOverTheImage) {
    const test::Frame frame = room();
    const Features features = find_features(frame.color, frame.depth, {}, kConfig);
    EXPECT_GT(features.size(), 200u);
    EXPECT_LE(features.size(), static_cast<std::size_t>(kConfig.count));
    std::set<std::pair<int, int>> quarters;
    for (const Feature& feature : features)
        quarters.emplace(static_cast<int>(feature.pixel.x()) / 160, static_cast<int>(feature.pixel.y()) / 120);
    EXPECT_GE(quarters.size(), 12u) << "of the 16 parts of the image";
}

TEST(Features, HaveTheDepthOfTheirSurface) {
    test::Frame frame = room();
    for (int v = 0; v < kCamera.height; ++v) {
        for (int u = 0; u < kCamera.width; ++u) {
            if (u > 500) frame.depth(u, v) = 0;                   // where depth is not known
            if (u % 2 == 1 || v % 2 == 1) frame.depth(u, v) = 0;  // a grid of holes
        }
    }
    const Features features = find_features(frame.color, frame.depth, {}, kConfig);
    EXPECT_GT(features.size(), 100u);
    for (const Feature& feature : features) {
        const float there = frame.depth(static_cast<int>(std::lround(feature.pixel.x() / 2)) * 2,
                                        static_cast<int>(std::lround(feature.pixel.y() / 2)) * 2);
        if (there > 0) {
            EXPECT_NEAR(feature.depth, there, 0.05f * there);
        }
        EXPECT_GT(feature.depth, 0.5f);
        EXPECT_LT(feature.pixel.x(), 503);
    }
    EXPECT_TRUE(find_features(frame.color, DepthImage(640, 480), {}, kConfig).empty());
}

TEST(Features, AreNotOnPeople) {
    const test::Frame frame = room(Eigen::Isometry3d::Identity(), test::Ball{{0, 0, 1}, 0.25});
    const Features features = find_features(frame.color, frame.depth, frame.labels, kConfig);
    EXPECT_FALSE(features.empty());
    for (const Feature& feature : features) {
        EXPECT_EQ(frame.labels(static_cast<int>(std::lround(feature.pixel.x())),
                               static_cast<int>(std::lround(feature.pixel.y()))),
                  0);
    }
}

TEST(Features, AreNotOnPlainSurfaces) {
    const ColorImage grey(640, 480, {90, 90, 90});
    EXPECT_TRUE(find_features(grey, DepthImage(640, 480, 2.0f), {}, kConfig).empty());
}

TEST(Features, AreTheSameForAnyNumberOfThreads) {
    const test::Frame frame = room();
    const int threads = cv::getNumThreads();
    cv::setNumThreads(1);
    const Features one = find_features(frame.color, frame.depth, {}, kConfig);
    cv::setNumThreads(5);
    const Features five = find_features(frame.color, frame.depth, {}, kConfig);
    cv::setNumThreads(threads);
    EXPECT_TRUE(are_equal(one, five));
}

TEST(FeatureMatches, AreOfTheSamePointAfterABigStep) {
    const Eigen::Isometry3d step = test::motion({0.15, -0.05, 0.1}, {0.2, 1, 0.3}, 8);
    const test::Frame a = room(), b = room(step);
    const Features earlier = find_features(a.color, a.depth, {}, kConfig),
                   current = find_features(b.color, b.depth, {}, kConfig);
    const std::vector<FeatureMatch> matches = match_features(earlier, current);
    std::size_t right = 0;
    for (const FeatureMatch& match : matches) {
        const Feature &from = earlier[match.earlier], &to = current[match.current];
        const Eigen::Vector3d point = back_project(from.pixel.x(), from.pixel.y(), from.depth, kCamera).cast<double>();
        right += (project(step.inverse() * point, kCamera) - to.pixel.cast<double>()).norm() < 6;
    }
    EXPECT_GT(right, static_cast<std::size_t>(FeatureConfig::kMinInliers)) << "too few for a motion";
    EXPECT_GT(static_cast<float>(right), FeatureConfig::kMinInlierShare * static_cast<float>(matches.size()));
}

TEST(FeatureMatches, AreOneToOne) {
    const test::Frame a = room(), b = room(test::motion({0.1, 0, 0}, {0, 1, 0}, 3));
    const auto matches =
        match_features(find_features(a.color, a.depth, {}, kConfig), find_features(b.color, b.depth, {}, kConfig));
    std::set<std::uint32_t> earlier, current;
    for (const FeatureMatch& match : matches) earlier.insert(match.earlier), current.insert(match.current);
    EXPECT_EQ(earlier.size(), matches.size());
    EXPECT_EQ(current.size(), matches.size());
    EXPECT_TRUE(match_features({}, {}).empty());
}

}  // namespace
}  // namespace posefusion
