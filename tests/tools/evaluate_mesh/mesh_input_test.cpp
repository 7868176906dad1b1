#include "tools/evaluate_mesh/mesh_input.hpp"

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "hosts/mesh/mesh_file.hpp"
#include "tests/hosts/support/temp_folder.hpp"

/// Meshes come back as `posefusion export` wrote them.
namespace posefusion::test {
namespace {

Mesh tent() {
    Mesh mesh;
    for (const Eigen::Vector3f& p : {Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(1, 0, 0.25f),
                                     Eigen::Vector3f(0, -1, 0.5f), Eigen::Vector3f(3, 2, 1)})
        mesh.vertices.push_back({p, {10, 20, 30}});
    mesh.faces = {{0, 1, 2}, {2, 1, 3}};
    return mesh;
}

TexturedMesh textured_tent() {
    TexturedMesh mesh;
    for (const MeshVertex& v : tent().vertices) mesh.vertices.push_back({v.position, {0, 0, 1}, {0.5f, 0.5f}});
    mesh.faces = tent().faces;
    mesh.texture = ColorImage(8, 8);
    return mesh;
}

TEST(MeshInput, EveryFormatHasTheSameTriangles) {
    const TempFolder folder;
    write_mesh(folder / "a.ply", tent());
    write_mesh(folder / "a.glb", tent());
    write_mesh(folder / "b.glb", textured_tent());
    for (const char* name : {"a.ply", "a.glb", "b.glb"}) {
        const TrueMesh mesh = read_exported_mesh(folder / name);
        ASSERT_EQ(mesh.vertices.size(), 4u) << name;
        for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(mesh.vertices[i], tent().vertices[i].position) << name;
        EXPECT_EQ(mesh.faces, tent().faces) << name;
    }
}

TEST(MeshInput, DamageIsAnErrorThatNamesTheFile) {
    const TempFolder folder;
    write_mesh(folder / "a.glb", tent());
    const std::string good = read_all(folder / "a.glb");
    const auto fault = [&](const std::string& bytes) {
        folder.write("damaged.glb", bytes);
        return message_of<Error>([&] { (void)read_exported_mesh(folder / "damaged.glb"); });
    };
    for (std::size_t size = 0; size < good.size(); ++size)
        EXPECT_NE(fault(good.substr(0, size)).find("damaged.glb"), std::string::npos) << size;
    for (std::size_t at = 0; at < good.size(); ++at) {  // whatever it says, it is no crash
        std::string damaged = good;
        damaged[at] = static_cast<char>(damaged[at] ^ 0xff);
        folder.write("damaged.glb", damaged);
        try {
            (void)read_exported_mesh(folder / "damaged.glb");
        } catch (const Error&) {
        }
    }
    std::string far = good;  // a corner that no vertex has: the last index is at the end
    far[far.size() - 4] = 77;
    EXPECT_NE(fault(far).find("that it lacks"), std::string::npos) << fault(far);
    // The last count times the 15 bytes of a vertex is 14 in 64 bits, which with a face of 13 bytes is the size.
    for (const char* count : {"many", "18446744073709551616", "1229782938247303442"}) {
        folder.write("damaged.ply", std::string("ply\nelement vertex ") + count + "\nelement face 1\nend_header\n" +
                                        std::string(14 + 13, '\0'));
        EXPECT_NE(message_of<Error>([&] { (void)read_exported_mesh(folder / "damaged.ply"); }).find("damaged.ply"),
                  std::string::npos)
            << count;
    }
    EXPECT_NE(message_of<Error>([&] { (void)read_exported_mesh(folder / "a.obj"); }).find("no .glb"),
              std::string::npos);
}

}  // namespace
}  // namespace posefusion::test
