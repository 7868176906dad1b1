#include "hosts/synth/room.hpp"

#include <gtest/gtest.h>

#include "hosts/synth/camera_path.hpp"
#include "hosts/synth/floor_plan.hpp"

namespace posefusion::synth {
namespace {

TEST(SynthRoom, TheCameraStaysClearOfEverythingAndMovesLikeAHandHeldOne) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const Room room(seed);
        const CameraPath path(room, seed, 1.0);
        double length = 0, turned = 0, fastest = 0;
        for (double t = 0; t < 20; t += 1.0 / 30) {
            const Eigen::Isometry3d a = path.at(t), b = path.at(t + 1.0 / 30);
            EXPECT_GT(room.clearance(a.translation().cast<float>()), 0.10f) << "seed " << seed << " t " << t;
            EXPECT_NEAR(a.linear().determinant(), 1, 1e-9);
            const double step = (b.translation() - a.translation()).norm();
            length += step;
            fastest = std::max(fastest, step * 30);
            turned += Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
        }
        EXPECT_GT(length / 20, 0.05);
        EXPECT_LT(length / 20, 0.50);
        EXPECT_LT(fastest, 1.2);
        EXPECT_LT(turned / 20, 0.5) << "rad/s";
    }
}

TEST(SynthRoom, EveryPlaceCanBeReachedFromEveryOther) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const Room room(seed);
        const FloorPlan floor(room);
        std::vector<Vector2f> places = room.spots;
        places.insert(places.end(), room.exits.begin(), room.exits.end());
        for (const Vector2f& from : places)
            for (const Vector2f& to : places) {
                if (from == to) continue;
                const auto route = floor.route(from, to);
                ASSERT_FALSE(route.empty()) << "seed " << seed;
                EXPECT_LT((route.front() - from).norm(), 0.05f);
                EXPECT_LT((route.back() - to).norm(), 0.05f);
                for (const Vector2f& p : route) EXPECT_GT(floor.clearance(p), 0.18f);
            }
    }
}

}  // namespace
}  // namespace posefusion::synth
