#include "tools/evaluate_mesh/mesh_scores.hpp"

#include <gtest/gtest.h>

#include <random>

#include "engine/core/error.hpp"
#include "tests/hosts/support/temp_folder.hpp"
#include "tools/evaluate_mesh/surface_index.hpp"
#include "tools/evaluate_objects/triangle_distance.hpp"

/// Scores of meshes whose errors are known.
namespace posefusion::test {
namespace {

/// Adds a rectangle of the plane y = `height`.
void add_floor(TrueMesh& mesh, float x0, float x1, float height, float depth = 2.0f) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const auto& [x, z] : {std::pair{x0, 0.0f}, {x1, 0.0f}, {x1, depth}, {x0, depth}})
        mesh.vertices.emplace_back(x, height, z);
    mesh.faces.push_back({first, first + 1, first + 2});
    mesh.faces.push_back({first, first + 2, first + 3});
}

TrueMesh floor_of(float x0, float x1, float height) {
    TrueMesh mesh;
    add_floor(mesh, x0, x1, height);
    return mesh;
}

TEST(MeshScores, PointsAreSpreadEvenly) {
    TrueMesh mesh = floor_of(0, 3, 1);
    const auto points = spread_points(mesh, 0.02f);
    EXPECT_NEAR(static_cast<double>(points.size()), 3 * 2 / 0.0004, 2);
    std::array<int, 12> counts{};
    for (const auto& p : points) {
        EXPECT_EQ(p.y(), 1);
        ++counts.at(static_cast<std::size_t>(p.x() * 2) * 2 + static_cast<std::size_t>(p.z()));
    }
    for (const int count : counts) EXPECT_NEAR(count, 1250, 40);
    TrueMesh fine;  // triangles that are too small for a point each
    for (int i = 0; i < 300; ++i) add_floor(fine, 0.01f * static_cast<float>(i), 0.01f * static_cast<float>(i + 1), 0);
    EXPECT_NEAR(static_cast<double>(spread_points(fine, 0.2f).size()), 150, 2);
}

TEST(MeshScores, DistancesAreThoseToTheNearestTriangle) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto anywhere = [&] { return Eigen::Vector3f(unit(random), unit(random), unit(random)); };
    TrueMesh mesh;
    for (int i = 0; i < 60; ++i) {  // of all sizes
        const Eigen::Vector3f corner = anywhere();
        const float size = 0.02f * static_cast<float>(1 + i);
        for (int j = 0; j < 3; ++j) mesh.vertices.push_back(corner + size * anywhere());
        const auto first = static_cast<std::uint32_t>(3 * i);
        mesh.faces.push_back({first, first + 1, first + 2});
    }
    const TriangleDistance exact(mesh);
    constexpr float kLimit = 0.1f;
    const SurfaceIndex index(mesh, kLimit);
    int near = 0;
    for (int i = 0; i < 3000; ++i) {
        const Eigen::Vector3f point = 1.3f * anywhere();
        const float truth = exact(point);
        const auto found = index.distance(point);
        if (truth > kLimit + 1e-5f) {
            EXPECT_FALSE(found);
        } else if (truth < kLimit - 1e-5f) {
            ASSERT_TRUE(found);
            EXPECT_NEAR(*found, truth, 1e-5f);
            ++near;
        }
    }
    EXPECT_GT(near, 300);
}

TEST(MeshScores, APerfectMeshIsPerfect) {
    const TrueMesh truth = floor_of(0, 2, 0);
    const MeshScores s = score_mesh(truth, spread_points(truth, 0.01f), truth);
    EXPECT_EQ(s.triangles, 2u);
    EXPECT_NEAR(s.area, 4, 0.001);
    EXPECT_NEAR(s.mean_distance, 0, 1e-6);
    EXPECT_EQ(s.accuracy, 1);
    EXPECT_EQ(s.invented, 0);
    EXPECT_EQ(s.completeness, 1);
}

TEST(MeshScores, ALayerThatIsOffIsAsFarOffAsItIs) {
    const TrueMesh truth = floor_of(0, 2, 0);
    const auto seen = spread_points(truth, 0.01f);
    const MeshScores near = score_mesh(truth, seen, floor_of(0, 2, 0.006f));
    EXPECT_NEAR(near.mean_distance, 0.006, 1e-5);
    EXPECT_EQ(near.accuracy, 1);
    EXPECT_EQ(near.completeness, 1);
    const MeshScores off = score_mesh(truth, seen, floor_of(0, 2, 0.02f));
    EXPECT_NEAR(off.mean_distance, 0.02, 1e-5);
    EXPECT_EQ(off.accuracy, 0);
    EXPECT_EQ(off.completeness, 0);
    EXPECT_EQ(off.invented, 0);
}

TEST(MeshScores, HolesCostCompletenessAndMembranesAccuracy) {
    const TrueMesh truth = floor_of(0, 2, 0);
    const auto seen = spread_points(truth, 0.01f);
    const MeshScores half = score_mesh(truth, seen, floor_of(0, 1, 0));
    EXPECT_EQ(half.accuracy, 1);
    EXPECT_NEAR(half.completeness, 0.505, 0.002) << "and the centimetre beside it";
    TrueMesh membrane = truth;
    add_floor(membrane, 0, 2, 0.5f);
    const MeshScores s = score_mesh(truth, seen, membrane);
    EXPECT_NEAR(s.accuracy, 0.5, 0.001);
    EXPECT_NEAR(s.invented, 0.5, 0.001);
    EXPECT_EQ(s.completeness, 1);
}

TEST(MeshScores, NothingCannotBeScored) {
    const TrueMesh truth = floor_of(0, 2, 0);
    EXPECT_NE(message_of<Error>([&] { (void)score_mesh(truth, {}, truth); }).find("seen"), std::string::npos);
    EXPECT_NE(message_of<Error>([&] { (void)score_mesh(truth, {{0, 0, 0}}, {}); }).find("area"), std::string::npos);
}

}  // namespace
}  // namespace posefusion::test
