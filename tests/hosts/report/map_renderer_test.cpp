#include "hosts/report/map_renderer.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace posefusion {
namespace {

const Intrinsics kCamera{100, 100, 49.5f, 39.5f, 100, 80};
const Eigen::Isometry3d kIdentity = Eigen::Isometry3d::Identity();
constexpr Rgb8 kRed{200, 0, 0}, kGreen{0, 200, 0};

Surfel disc(const Eigen::Vector3f& position, float radius, Rgb8 color, const Eigen::Vector3f& normal = {0, 0, -1}) {
    Surfel s;
    s.position = position;
    s.normal = normal;
    s.color = color;
    s.radius = radius;
    return s;
}

MapRenderConfig plain() {
    MapRenderConfig config;
    config.background = {0, 0, 255};
    config.ambient = 1;
    config.radius_factor = 1;
    config.supersampling = 1;
    return config;
}

long pixels_of(const ColorImage& image, Rgb8 color) { return std::count(image.begin(), image.end(), color); }

TEST(MapRenderer, ADiscCoversWhatItsProjectionCovers) {
    // radius 0.2 m at 2 m: 10 pixels, 314 pixels of area
    const ColorImage image = render_map({disc({0, 0, 2}, 0.2f, kRed)}, kCamera, kIdentity, plain());
    EXPECT_NEAR(static_cast<double>(pixels_of(image, kRed)), 314, 8);
    EXPECT_EQ(image(50, 40), kRed);
    EXPECT_EQ(image(50 + 11, 40), (Rgb8{0, 0, 255}));
}

TEST(MapRenderer, ATiltedDiscIsAnEllipse) {
    const ColorImage image =
        render_map({disc({0, 0, 2}, 0.2f, kRed, Eigen::Vector3f(0.866f, 0, -0.5f))}, kCamera, kIdentity, plain());
    EXPECT_NEAR(static_cast<double>(pixels_of(image, kRed)), 157, 12);
}

TEST(MapRenderer, TheNearerSurfaceHidesTheFarther) {
    const std::vector<Surfel> near_first{disc({0, 0, 1}, 0.2f, kRed), disc({0, 0, 2}, 0.8f, kGreen)};
    const std::vector<Surfel> far_first{near_first[1], near_first[0]};
    for (const auto& map : {near_first, far_first}) {
        const ColorImage image = render_map(map, kCamera, kIdentity, plain());
        EXPECT_EQ(image(50, 40), kRed);
        EXPECT_EQ(image(50, 40 + 30), kGreen);
    }
}

TEST(MapRenderer, BacksAndThingsBehindTheCameraAreLeftOut) {
    const std::vector<Surfel> map{disc({0, 0, 2}, 0.2f, kRed, {0, 0, 1}), disc({0, 0, -2}, 0.2f, kRed),
                                  disc({0, 0, 0}, 0.2f, kRed)};
    EXPECT_EQ(pixels_of(render_map(map, kCamera, kIdentity, plain()), kRed), 0);
    // Seen from the other side the first shows itself.
    const auto behind = look_at({0, 0, 4}, {0, 0, 2}, {0, -1, 0});
    EXPECT_GT(pixels_of(render_map({map[0]}, kCamera, behind, plain()), kRed), 200);
}

TEST(MapRenderer, TinySurfelsAreNotLostBetweenPixels) {
    std::vector<Surfel> map;
    for (int i = 0; i < 50; ++i) map.push_back(disc({-0.8f + 0.0313f * static_cast<float>(i), 0.007f, 2}, 1e-5f, kRed));
    EXPECT_GE(pixels_of(render_map(map, kCamera, kIdentity, plain()), kRed), 45);
}

TEST(MapRenderer, BrokenSurfelsDoNoHarm) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    const std::vector<Surfel> map{disc({nan, 0, 1}, 0.1f, kRed),
                                  disc({0, 0, inf}, 0.1f, kRed),
                                  disc({0, 0, 2}, nan, kRed),
                                  disc({1e30f, 0, 1}, 0.1f, kRed),
                                  disc({0, 0, 1}, 0.1f, kRed, {nan, nan, nan}),
                                  disc({0, 0, 1}, 0.1f, kRed, {0, 0, 0}),
                                  disc({0, 0, 1}, inf, kGreen)};
    EXPECT_NO_THROW((void)render_map(map, kCamera, kIdentity));
    EXPECT_NO_THROW((void)overview_pose(map, kCamera, {0, -1, -1}, {0, -1, 0}));
}

TEST(MapRenderer, LookAtLooksThere) {
    const Eigen::Isometry3d T = look_at({1, 2, 3}, {4, 2, 3}, {0, 0, 1});
    EXPECT_TRUE((T.inverse() * Eigen::Vector3d(4, 2, 3)).isApprox(Eigen::Vector3d(0, 0, 3), 1e-12));
    EXPECT_TRUE((T.linear() * Eigen::Vector3d(0, -1, 0)).isApprox(Eigen::Vector3d(0, 0, 1), 1e-12))
        << "up in the picture";
    EXPECT_NEAR(T.linear().determinant(), 1, 1e-12);
}

TEST(MapRenderer, TheOverviewShowsAllButStraySurfels) {
    std::vector<Surfel> map;
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 60; ++x)
            map.push_back(
                disc({0.1f * static_cast<float>(x), 1, 0.1f * static_cast<float>(y)}, 0.05f, kRed, {0, -1, 0}));
    map.push_back(disc({500, 0, 0}, 0.05f, kRed));
    const Eigen::Isometry3d pose = overview_pose(map, kCamera, {0, -1, -0.5}, {0, -1, 0});
    EXPECT_LT(pose.translation().norm(), 20) << "the stray surfel must not push the camera away";
    int seen = 0;
    for (const Surfel& s : map) {
        const Eigen::Vector3d p = pose.inverse() * s.position.cast<double>();
        const double u = kCamera.fx * p.x() / p.z() + kCamera.cx, v = kCamera.fy * p.y() / p.z() + kCamera.cy;
        seen += p.z() > 0 && u >= 0 && v >= 0 && u < kCamera.width && v < kCamera.height ? 1 : 0;
    }
    EXPECT_GT(seen, 2300);
    EXPECT_GT(pixels_of(render_map(map, kCamera, pose, plain()), kRed), 1200) << "and fills the picture";
}

TEST(MapRenderer, TheOverviewShowsMorePointsIfAsked) {
    const auto sees = [](const Eigen::Isometry3d& pose, const Eigen::Vector3d& point) {
        const Eigen::Vector3d p = pose.inverse() * point;
        const double u = kCamera.fx * p.x() / p.z() + kCamera.cx, v = kCamera.fy * p.y() / p.z() + kCamera.cy;
        return p.z() > 0 && u >= 0 && v >= 0 && u < kCamera.width && v < kCamera.height;
    };
    const Eigen::Vector3d far_away(9, 0, 4), direction(0, -1, -0.5), up(0, -1, 0);
    for (const std::vector<Surfel>& map : {std::vector<Surfel>(100), std::vector<Surfel>{}}) {
        EXPECT_FALSE(sees(overview_pose(map, kCamera, direction, up), far_away));
        EXPECT_TRUE(sees(overview_pose(map, kCamera, direction, up, {far_away}), far_away)) << map.size();
    }
}

}  // namespace
}  // namespace posefusion
