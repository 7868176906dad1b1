#include <gtest/gtest.h>
#include <pcl/PolygonMesh.h>
#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>

#include "engine/core/error.hpp"
#include "hosts/io/ply.hpp"
#include "hosts/mesh/cloud_file.hpp"
#include "hosts/mesh/mesh_file.hpp"
#include "tests/hosts/mesh/shapes.hpp"
#include "tests/hosts/support/temp_folder.hpp"

/// What is written opens again, with PCL's readers where PCL has one.
namespace posefusion::test {
namespace {

Mesh two_triangles() {
    Mesh mesh;
    mesh.vertices = {{{0, 0, 1}, {255, 0, 51}},
                     {{1, 0, 1}, {0, 255, 0}},
                     {{0, 1.25f, 1}, {0, 0, 255}},
                     {{1, 1, -1.5f}, {10, 20, 30}}};
    mesh.faces = {{0, 1, 2}, {1, 3, 2}};
    return mesh;
}

TEST(MeshFile, PlyOpensInPcl) {
    const TempFolder folder;
    const Mesh mesh = two_triangles();
    write_mesh(folder / "mesh.ply", mesh);
    pcl::PolygonMesh read;
    ASSERT_EQ(pcl::io::loadPLYFile((folder / "mesh.ply").string(), read), 0);
    pcl::PointCloud<pcl::PointXYZRGB> points;
    pcl::fromPCLPointCloud2(read.cloud, points);
    ASSERT_EQ(points.size(), mesh.vertices.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(points[i].getVector3fMap(), mesh.vertices[i].position);
        EXPECT_EQ((Rgb8{points[i].r, points[i].g, points[i].b}), mesh.vertices[i].color);
    }
    ASSERT_EQ(read.polygons.size(), 2u);
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(static_cast<std::uint32_t>(read.polygons[1].vertices[k]), mesh.faces[1][k]);
}

TEST(MeshFile, ObjHoldsVerticesColoursAndFaces) {
    const TempFolder folder;
    write_mesh(folder / "mesh.obj", two_triangles());
    EXPECT_EQ(read_all(folder / "mesh.obj"),
              "# made by PoseFusion, metres\n"
              "v 0 0 1 1 0 0.2\nv 1 0 1 0 1 0\nv 0 1.25 1 0 0 1\nv 1 1 -1.5 0.039215688 0.078431375 0.11764706\n"
              "f 1 2 3\nf 2 4 3\n");
}

TEST(CloudFile, PcdOpensInPcl) {
    const TempFolder folder;
    const auto surfels = sphere({1, 2, 3}, 0.5f, 500);
    write_cloud(folder / "cloud.pcd", surfels);
    pcl::PointCloud<pcl::PointXYZRGBNormal> points;
    ASSERT_EQ(pcl::io::loadPCDFile((folder / "cloud.pcd").string(), points), 0);
    ASSERT_EQ(points.size(), surfels.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_EQ(points[i].getVector3fMap(), surfels[i].position);
        ASSERT_EQ(points[i].getNormalVector3fMap(), surfels[i].normal);
        ASSERT_EQ((Rgb8{points[i].r, points[i].g, points[i].b}), surfels[i].color);
    }
}

TEST(CloudFile, PlyIsAMapAgain) {
    const TempFolder folder;
    const auto surfels = sphere({1, 2, 3}, 0.5f, 500);
    write_cloud(folder / "cloud.ply", surfels);
    const auto read = read_ply(folder / "cloud.ply");
    ASSERT_EQ(read.size(), surfels.size());
    EXPECT_EQ(read[7].position, surfels[7].position);
    EXPECT_EQ(read[7].confidence, surfels[7].confidence);
}

TEST(MeshFile, OtherNamesAreRefused) {
    const TempFolder folder;
    EXPECT_NE(message_of<Error>([&] { write_mesh(folder / "mesh.stl", two_triangles()); }).find(".ply or .obj"),
              std::string::npos);
    EXPECT_NE(message_of<Error>([&] { write_cloud(folder / "cloud.obj", {}); }).find(".pcd or .ply"),
              std::string::npos);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(MeshFile, AFolderThatIsNotThereIsNamed) {
    const TempFolder folder;
    EXPECT_NE(message_of<Error>([&] {
                  write_mesh(folder.path() / "no" / "mesh.ply", two_triangles());
              }).find((folder / "no").string()),
              std::string::npos);
}

}  // namespace
}  // namespace posefusion::test
