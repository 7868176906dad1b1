#include "hosts/mesh/reconstruction.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <map>
#include <utility>

#include "engine/core/error.hpp"
#include "tests/hosts/mesh/shapes.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion::test {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// How often each edge is passed in either direction.
std::map<Edge, int> edges_of(const Mesh& mesh) {
    std::map<Edge, int> edges;
    for (const auto& f : mesh.faces)
        for (std::size_t k = 0; k < 3; ++k) ++edges[{f[k], f[(k + 1) % 3]}];
    return edges;
}

Eigen::Vector3f face_normal(const Mesh& mesh, const std::array<std::uint32_t, 3>& f) {
    const Eigen::Vector3f &a = mesh.vertices[f[0]].position, &b = mesh.vertices[f[1]].position,
                          &c = mesh.vertices[f[2]].position;
    return (b - a).cross(c - a);
}

TEST(Reconstruction, ASphereBecomesAClosedSphere) {
    const Eigen::Vector3f centre(0.3f, -0.2f, 2);
    constexpr float kRadius = 0.5f;
    const Mesh mesh = reconstruct_mesh(sphere(centre, kRadius, 20'000), {});
    ASSERT_GT(mesh.faces.size(), 1000u);
    float worst = 0;
    for (const MeshVertex& v : mesh.vertices) worst = std::max(worst, std::abs((v.position - centre).norm() - kRadius));
    EXPECT_LT(worst, 0.003f);

    // Closed and of one orientation: every edge is passed once in each direction. Euler: it is a sphere.
    const auto edges = edges_of(mesh);
    for (const auto& [edge, times] : edges) {
        ASSERT_EQ(times, 1);
        ASSERT_TRUE(edges.contains({edge.second, edge.first}));
    }
    EXPECT_EQ(static_cast<long>(mesh.vertices.size()) - static_cast<long>(edges.size() / 2) +
                  static_cast<long>(mesh.faces.size()),
              2);
}

TEST(Reconstruction, FacesLookWhereTheNormalsDo) {
    const Eigen::Vector3f centre(0, 0, 1);
    const Mesh mesh = reconstruct_mesh(sphere(centre, 0.5f, 20'000), {});
    std::size_t outwards = 0;
    for (const auto& f : mesh.faces)
        outwards += face_normal(mesh, f).dot(mesh.vertices[f[0]].position - centre) > 0 ? 1 : 0;
    EXPECT_GT(static_cast<double>(outwards), 0.999 * static_cast<double>(mesh.faces.size()));
}

TEST(Reconstruction, ColoursAreThoseOfTheSurfelsNearby) {
    const Eigen::Vector3f centre(0, 0, 1);
    const Mesh mesh = reconstruct_mesh(sphere(centre, 0.5f, 20'000), {});
    constexpr float kSeam = 0.03f;
    for (const MeshVertex& v : mesh.vertices) {
        const float height = v.position.z() - centre.z();
        if (std::abs(height) > kSeam) {
            ASSERT_EQ(v.color, height > 0 ? kUpperColor : kLowerColor);
        }
    }
}

TEST(Reconstruction, AWallStaysOpenAndFlat) {
    constexpr float kSide = 1;
    const MeshConfig config;
    const Mesh mesh = reconstruct_mesh(wall(kSide), config);
    float worst = 0, widest = 0, area = 0;
    for (const MeshVertex& v : mesh.vertices) {
        worst = std::max(worst, std::abs(v.position.z() - 2));
        widest = std::max(widest, v.position.head<2>().cwiseAbs().maxCoeff());
    }
    for (const auto& f : mesh.faces) area += face_normal(mesh, f).norm() / 2;
    EXPECT_LT(worst, 0.01f);
    EXPECT_LT(widest, kSide / 2 + 3 * config.resolution) << "what no surfel supports was not cut off";
    EXPECT_GT(area, 0.98f * kSide * kSide);
    EXPECT_LT(area, 1.25f * kSide * kSide);
}

/// A wall with a square hole of 20 cm: what no surfel is near is invented.
float area_within_hole(float trim) {
    constexpr float kHalf = 0.1f;
    std::vector<Surfel> surfels = wall(1);
    std::erase_if(surfels, [](const Surfel& s) { return s.position.head<2>().cwiseAbs().maxCoeff() < kHalf; });
    const Mesh mesh = reconstruct_mesh(surfels, {.trim = trim});
    float area = 0;
    for (const auto& f : mesh.faces) {
        const Eigen::Vector3f centre =
            (mesh.vertices[f[0]].position + mesh.vertices[f[1]].position + mesh.vertices[f[2]].position) / 3;
        if (centre.head<2>().cwiseAbs().maxCoeff() < kHalf - trim - 0.01f) area += face_normal(mesh, f).norm() / 2;
    }
    return area;
}

TEST(Reconstruction, AHoleStaysOpenBeyondTheTrim) {
    EXPECT_EQ(area_within_hole(0.03f), 0);
    EXPECT_EQ(area_within_hole(0.06f), 0);
    const std::vector<Surfel> closed = wall(1);
    std::vector<Surfel> open = closed;
    std::erase_if(open, [](const Surfel& s) { return s.position.head<2>().cwiseAbs().maxCoeff() < 0.1f; });
    const auto area = [](const Mesh& mesh) {
        float sum = 0;
        for (const auto& f : mesh.faces) sum += face_normal(mesh, f).norm() / 2;
        return sum;
    };
    EXPECT_NEAR(area(reconstruct_mesh(open, {.trim = 0.15f})), area(reconstruct_mesh(closed, {.trim = 0.15f})), 0.01f)
        << "a trim beyond the middle of the hole closes it";
}

TEST(Simplification, ReachesTheCountAndKeepsTheShape) {
    const Eigen::Vector3f centre(0, 0, 1);
    constexpr float kRadius = 0.5f;
    const Mesh fine = reconstruct_mesh(sphere(centre, kRadius, 20'000), {});
    const Mesh coarse = reconstruct_mesh(sphere(centre, kRadius, 20'000), {.max_triangles = 1000});
    ASSERT_GT(fine.faces.size(), 4000u);
    EXPECT_LE(coarse.faces.size(), 1000u);
    EXPECT_GT(coarse.faces.size(), 900u);
    for (const MeshVertex& v : coarse.vertices) ASSERT_NEAR((v.position - centre).norm(), kRadius, 0.003f);
    float farthest = 0;  // of the middles of triangles, which an even simplification sinks by about 2 mm
    for (const auto& f : coarse.faces) {
        const Eigen::Vector3f middle =
            (coarse.vertices[f[0]].position + coarse.vertices[f[1]].position + coarse.vertices[f[2]].position) / 3;
        farthest = std::max(farthest, std::abs((middle - centre).norm() - kRadius));
        EXPECT_GT(face_normal(coarse, f).dot(middle - centre), 0) << "no triangle turns over";
    }
    EXPECT_LT(farthest, 0.01f);
    const auto edges = edges_of(coarse);
    for (const auto& [edge, times] : edges) ASSERT_TRUE(times == 1 && edges.contains({edge.second, edge.first}));
    for (const MeshVertex& v : coarse.vertices)
        if (std::abs(v.position.z() - centre.z()) > 0.03f) {
            ASSERT_EQ(v.color, v.position.z() > centre.z() ? kUpperColor : kLowerColor);
        }
}

TEST(Simplification, LeavesASmallMeshAsItIs) {
    const auto surfels = sphere({0, 0, 1}, 0.3f, 5000);
    const Mesh mesh = reconstruct_mesh(surfels, {});
    EXPECT_EQ(reconstruct_mesh(surfels, {.max_triangles = mesh.faces.size()}).faces, mesh.faces);
}

TEST(Reconstruction, SameSurfelsSameMesh) {
    const auto surfels = sphere({0, 0, 1}, 0.3f, 5000);
    const Mesh a = reconstruct_mesh(surfels, {}), b = reconstruct_mesh(surfels, {});
    ASSERT_EQ(a.vertices.size(), b.vertices.size());
    EXPECT_EQ(a.faces, b.faces);
    for (std::size_t i = 0; i < a.vertices.size(); ++i) ASSERT_EQ(a.vertices[i].position, b.vertices[i].position);
}

TEST(Reconstruction, DamagedSurfelsTakeNoPart) {
    auto surfels = sphere({0, 0, 1}, 0.3f, 5000);
    const Mesh clean = reconstruct_mesh(surfels, {});
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    surfels.push_back(surfel_at({kNone, 0, 0}, {0, 0, 1}, {}));
    surfels.push_back(surfel_at({0, 0, 5}, {0, 0, 0}, {}));
    surfels.push_back(surfel_at({9, 9, 9}, {kNone, 0, 1}, {}));
    EXPECT_EQ(reconstruct_mesh(surfels, {}).faces, clean.faces);
}

TEST(Reconstruction, SaysWhatIsWrong) {
    const auto few = sphere({0, 0, 1}, 0.3f, 20);
    EXPECT_NE(message_of<Error>([&] { (void)reconstruct_mesh(few, {}); }).find("only 20 surfels"), std::string::npos);
    const auto enough = sphere({0, 0, 1}, 0.3f, 200);
    EXPECT_NE(
        message_of<Error>([&] { (void)reconstruct_mesh(enough, {.resolution = 1e-5f}); }).find("the finest is 1 mm"),
        std::string::npos);
    std::vector<Surfel> damaged = enough;
    damaged.back().position.x() = 1e30f;
    EXPECT_NE(message_of<Error>([&] { (void)reconstruct_mesh(damaged, {}); }).find("100 km apart"), std::string::npos);
    EXPECT_NE(message_of<Error>([&] { (void)reconstruct_mesh(enough, {.resolution = 0}); }).find("above 0 m"),
              std::string::npos);
}

}  // namespace
}  // namespace posefusion::test
