#include <gtest/gtest.h>
#include <pcl/PolygonMesh.h>
#include <pcl/conversions.h>
#include <pcl/io/obj_io.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "engine/core/error.hpp"
#include "hosts/io/image_file.hpp"
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
    Mesh mesh;
    mesh.vertices = {{{0, 0, 1}, {255, 0, 51}}, {{1, 0, 1}, {0, 255, 0}}, {{0, 1, 1}, {0, 0, 255}}};
    mesh.faces = {{0, 1, 2}};
    write_mesh(folder / "mesh.obj", mesh);
    EXPECT_EQ(read_all(folder / "mesh.obj"),
              "# made by PoseFusion, metres\nmtllib mesh.mtl\nusemtl surface\n"
              "v 0 0 1 1 0 0.2\nv 1 0 1 0 1 0\nv 0 1 1 0 0 1\n"
              "vn 0 0 1\nvn 0 0 1\nvn 0 0 1\n"
              "f 1//1 2//2 3//3\n");
    EXPECT_NE(read_all(folder / "mesh.mtl").find("newmtl surface\n"), std::string::npos);
}

TEST(MeshFile, ObjOpensInPcl) {
    const TempFolder folder;
    const Mesh mesh = two_triangles();
    write_mesh(folder / "mesh.obj", mesh);
    pcl::PolygonMesh read;
    ASSERT_EQ(pcl::io::loadOBJFile((folder / "mesh.obj").string(), read), 0);
    ASSERT_EQ(read.polygons.size(), 2u);
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(static_cast<std::uint32_t>(read.polygons[1].vertices[k]), mesh.faces[1][k]);
}

/// A .glb taken apart by the letter of the specification.
struct Glb {
    nlohmann::json json;
    std::string binary;

    explicit Glb(const std::string& file) {
        EXPECT_EQ(file.substr(0, 4), "glTF");
        EXPECT_EQ(number(file, 4), 2u);
        EXPECT_EQ(number(file, 8), file.size());
        const std::uint32_t json_bytes = number(file, 12);
        EXPECT_EQ(json_bytes % 4, 0u);
        EXPECT_EQ(file.substr(16, 4), "JSON");
        json = nlohmann::json::parse(file.substr(20, json_bytes));
        const std::size_t at = 20 + json_bytes;
        EXPECT_EQ(number(file, at) % 4, 0u);
        EXPECT_EQ(file.substr(at + 4, 4), std::string("BIN\0", 4));
        binary = file.substr(at + 8);
        EXPECT_EQ(binary.size(), number(file, at));
        EXPECT_EQ(binary.size(), json["buffers"][0]["byteLength"]);
    }

    static std::uint32_t number(const std::string& bytes, std::size_t at) {
        std::uint32_t value = 0;
        std::memcpy(&value, bytes.data() + at, sizeof value);
        return value;
    }

    /// The numbers behind an accessor.
    template <class Number>
    [[nodiscard]] std::vector<Number> numbers(std::size_t accessor, std::size_t per_element) const {
        const auto& about = json["accessors"][accessor];
        const auto& view = json["bufferViews"][about["bufferView"].get<std::size_t>()];
        const auto offset = view["byteOffset"].get<std::size_t>();
        EXPECT_EQ(offset % 4, 0u);
        std::vector<Number> values(per_element * about["count"].get<std::size_t>());
        EXPECT_EQ(view["byteLength"], values.size() * sizeof(Number));
        EXPECT_LE(offset + values.size() * sizeof(Number), binary.size());
        std::memcpy(values.data(), binary.data() + offset, values.size() * sizeof(Number));
        return values;
    }
};

TEST(MeshFile, GlbHoldsTheMesh) {
    const TempFolder folder;
    const Mesh mesh = two_triangles();
    write_mesh(folder / "mesh.glb", mesh);
    const Glb glb(read_all(folder / "mesh.glb"));
    EXPECT_EQ(glb.json["asset"]["version"], "2.0");
    const auto& primitive = glb.json["meshes"][0]["primitives"][0];
    const auto accessor = [&](const char* name) { return primitive["attributes"][name].get<std::size_t>(); };

    const auto positions = glb.numbers<float>(accessor("POSITION"), 3);
    ASSERT_EQ(positions.size(), 3 * mesh.vertices.size());
    for (std::size_t i = 0; i < positions.size(); ++i)
        EXPECT_EQ(positions[i], mesh.vertices[i / 3].position[static_cast<int>(i % 3)]);
    const auto& about = glb.json["accessors"][accessor("POSITION")];
    EXPECT_EQ(about["min"], nlohmann::json({0.0, 0.0, -1.5}));
    EXPECT_EQ(about["max"], nlohmann::json({1.0, 1.25, 1.0}));

    const auto normals = glb.numbers<float>(accessor("NORMAL"), 3);
    for (std::size_t i = 0; i < normals.size(); i += 3)
        EXPECT_NEAR(Eigen::Vector3f(normals[i], normals[i + 1], normals[i + 2]).norm(), 1, 1e-6);

    const auto indices = glb.numbers<std::uint32_t>(primitive["indices"].get<std::size_t>(), 1);
    EXPECT_EQ(indices, (std::vector<std::uint32_t>{0, 1, 2, 1, 3, 2}));
}

TexturedMesh textured_triangle() {
    TexturedMesh mesh;
    const Eigen::Vector3f normal(0, 0, -1);
    mesh.vertices = {
        {{0, 0, 1}, normal, {0.25f, 0.25f}}, {{1, 0, 1}, normal, {0.75f, 0.25f}}, {{0, 1, 1}, normal, {0.25f, 0.75f}}};
    mesh.faces = {{0, 1, 2}};
    mesh.texture = ColorImage(16, 16, {200, 60, 30});
    return mesh;
}

TEST(MeshFile, GlbCarriesItsTexture) {
    const TempFolder folder;
    write_mesh(folder / "mesh.glb", textured_triangle());
    const Glb glb(read_all(folder / "mesh.glb"));
    const auto& attributes = glb.json["meshes"][0]["primitives"][0]["attributes"];
    EXPECT_FALSE(attributes.contains("COLOR_0"));
    EXPECT_EQ(glb.numbers<float>(attributes["TEXCOORD_0"].get<std::size_t>(), 2),
              (std::vector<float>{0.25f, 0.25f, 0.75f, 0.25f, 0.25f, 0.75f}));
    const auto& material = glb.json["materials"][0]["pbrMetallicRoughness"];
    const auto& texture = glb.json["textures"][material["baseColorTexture"]["index"].get<std::size_t>()];
    const auto& image = glb.json["images"][texture["source"].get<std::size_t>()];
    EXPECT_EQ(image["mimeType"], "image/jpeg");
    const auto& view = glb.json["bufferViews"][image["bufferView"].get<std::size_t>()];
    const std::string jpeg = glb.binary.substr(view["byteOffset"].get<std::size_t>(), view["byteLength"]);
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(jpeg.data());
    const ColorImage read = decode_color({bytes, jpeg.size()}, "texture", {16, 16});
    EXPECT_NEAR(read(8, 8).r, 200, 4);
    EXPECT_NEAR(read(8, 8).b, 30, 4);
}

TEST(MeshFile, ObjHasItsTextureBesideIt) {
    const TempFolder folder;
    write_mesh(folder / "mesh.obj", textured_triangle());
    const std::string obj = read_all(folder / "mesh.obj");
    EXPECT_NE(obj.find("mtllib mesh.mtl\n"), std::string::npos);
    EXPECT_NE(obj.find("\nvt 0.25 0.75\n"), std::string::npos) << "from the lower left corner";
    EXPECT_NE(obj.find("\nf 1/1/1 2/2/2 3/3/3\n"), std::string::npos);
    EXPECT_NE(read_all(folder / "mesh.mtl").find("\nmap_Kd mesh.png\n"), std::string::npos);
    EXPECT_EQ(read_color(folder / "mesh.png", {16, 16})(3, 3), (Rgb8{200, 60, 30}));
    EXPECT_THROW(write_mesh(folder / "mesh.ply", textured_triangle()), Error);
}

TEST(MeshFile, GlbHasColoursInLinearLight) {
    const TempFolder folder;
    Mesh mesh = two_triangles();
    mesh.vertices[0].color = {255, 0, 188};
    write_mesh(folder / "mesh.glb", mesh);
    const Glb glb(read_all(folder / "mesh.glb"));
    const auto accessor = glb.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"].get<std::size_t>();
    EXPECT_EQ(glb.json["accessors"][accessor]["normalized"], true);
    const auto colors = glb.numbers<std::uint16_t>(accessor, 4);
    EXPECT_EQ(colors[0], 65535);
    EXPECT_EQ(colors[1], 0);
    EXPECT_NEAR(colors[2], 65535 * 0.5, 300) << "sRGB 188 is half the light";
    EXPECT_EQ(colors[3], 65535);
}

TEST(MeshFile, GlbIsTurnedUpright) {
    const TempFolder folder;
    write_mesh(folder / "mesh.glb", two_triangles());
    const Glb glb(read_all(folder / "mesh.glb"));
    const auto r = glb.json["nodes"][0]["rotation"].get<std::vector<float>>();  // x y z w
    const Eigen::Quaternionf rotation(r[3], r[0], r[1], r[2]);
    EXPECT_TRUE((rotation * Eigen::Vector3f(0, -1, 0)).isApprox(Eigen::Vector3f(0, 1, 0))) << "up of the first camera";
    EXPECT_TRUE((rotation * Eigen::Vector3f(0, 0, 1)).isApprox(Eigen::Vector3f(0, 0, -1))) << "its view";
}

TEST(CloudFile, PcdOpensInPcl) {
    const TempFolder folder;
    const auto surfels = sphere({1, 2, 3}, 0.5f, 500);
    for (const CloudEncoding encoding : {CloudEncoding::Binary, CloudEncoding::Text}) {
        write_cloud(folder / "cloud.pcd", surfels, encoding);
        pcl::PointCloud<pcl::PointXYZRGBNormal> points;
        ASSERT_EQ(pcl::io::loadPCDFile((folder / "cloud.pcd").string(), points), 0);
        ASSERT_EQ(points.size(), surfels.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            ASSERT_EQ(points[i].getVector3fMap(), surfels[i].position);
            ASSERT_EQ(points[i].getNormalVector3fMap(), surfels[i].normal);
            ASSERT_EQ((Rgb8{points[i].r, points[i].g, points[i].b}), surfels[i].color);
        }
    }
}

TEST(CloudFile, XyzHasPositionNormalAndColourPerLine) {
    const TempFolder folder;
    write_cloud(folder / "cloud.xyz",
                {surfel_at({0.1f, -2, 3}, {0, 0, -1}, {1, 20, 255}), surfel_at({1e-5f, 0, 0.5f}, {0.6f, 0, 0.8f}, {})});
    EXPECT_EQ(read_all(folder / "cloud.xyz"), "0.1 -2 3 0 0 -1 1 20 255\n1e-05 0 0.5 0.6 0 0.8 0 0 0\n");
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
    EXPECT_NE(message_of<Error>([&] { write_mesh(folder / "mesh.stl", two_triangles()); }).find(".ply, .obj or .glb"),
              std::string::npos);
    EXPECT_NE(message_of<Error>([&] { write_cloud(folder / "cloud.obj", {}); }).find(".pcd, .ply or .xyz"),
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
