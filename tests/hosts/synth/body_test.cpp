#include "hosts/synth/body.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "hosts/synth/random.hpp"
#include "hosts/synth/surface_nets.hpp"

namespace posefusion::synth {
namespace {

TEST(SynthBody, SurfaceNetsFindASphere) {
    const Surface ball = surface_nets([](const Vector3f& p) { return p.norm() - 0.3f; }, Vector3f::Constant(-0.4f),
                                      Vector3f::Constant(0.4f), 0.03f);
    ASSERT_GT(ball.triangles.size(), 500u);
    for (std::size_t i = 0; i < ball.positions.size(); ++i) {
        EXPECT_NEAR(ball.positions[i].norm(), 0.3f, 1e-4f);
        EXPECT_GT(ball.normals[i].dot(ball.positions[i].normalized()), 0.999f);
    }
    double area = 0;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const Triangle& t : ball.triangles) {
        area += 0.5 *
                (ball.positions[t[1]] - ball.positions[t[0]]).cross(ball.positions[t[2]] - ball.positions[t[0]]).norm();
        for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
    }
    EXPECT_NEAR(area, 4 * M_PI * 0.09, 0.02);
    for (const auto& [edge, count] : edges) EXPECT_EQ(count, 2) << "closed surface";
}

TEST(SynthBody, BindPoseLeavesTheBodyAsModelled) {
    const Body body = make_body(BodyLook(3, true));
    const PosedBody posed = pose_body(body, body.bind);
    for (std::size_t i = 0; i < body.vertices.size(); ++i)
        ASSERT_LT((posed.positions[i] - body.vertices[i].rest).norm(), 1e-5f);
}

TEST(SynthBody, HasHumanSizeStandsOnTheFloorAndContainsItsJoints) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        const BodyLook look(seed, seed % 2 == 0);
        const Body body = make_body(look);
        Vector3f low = Vector3f::Constant(9), high = Vector3f::Constant(-9);
        for (const BodyVertex& v : body.vertices) {
            low = low.cwiseMin(v.rest), high = high.cwiseMax(v.rest);
            float total = 0;
            for (const float w : v.weights) total += w;
            ASSERT_NEAR(total, 1, 1e-5f);
        }
        EXPECT_NEAR(high.z(), look.height, 0.04f);
        EXPECT_NEAR(low.z(), 0, 0.01f);
        for (const Vector3f& joint : body_joints(body.proportions, body.bind)) {
            float nearest = 1;
            for (const BodyVertex& v : body.vertices) nearest = std::min(nearest, (v.rest - joint).norm());
            EXPECT_LT(nearest, 0.13f);
        }
    }
}

TEST(SynthBody, TheSameSeedDressesTheSameWayAndOthersDiffer) {
    const BodyLook a(5, true), b(5, true), c(6, true);
    EXPECT_EQ(a.shirt, b.shirt);
    EXPECT_EQ(a.height, b.height);
    EXPECT_NE(a.height, c.height);
}

}  // namespace
}  // namespace posefusion::synth
