#include "hosts/mesh/mesh_file.hpp"

#include <bit>
#include <cstring>
#include <ostream>
#include <string>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/mesh/glb_file.hpp"

namespace posefusion {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY files are written without swapping bytes");

template <class Number>
void put(std::string& to, Number value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    to.append(bytes, sizeof value);
}

void write_ply_mesh(std::ostream& out, const Mesh& mesh) {
    out << "ply\nformat binary_little_endian 1.0\ncomment made by PoseFusion, metres\nelement vertex "
        << std::to_string(mesh.vertices.size())
        << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty "
           "uchar blue\nelement face "
        << std::to_string(mesh.faces.size()) << "\nproperty list uchar int vertex_indices\nend_header\n";
    std::string bytes;
    for (const MeshVertex& v : mesh.vertices) {
        bytes.clear();
        for (int i = 0; i < 3; ++i) put(bytes, v.position[i]);
        for (const std::uint8_t channel : {v.color.r, v.color.g, v.color.b}) put(bytes, channel);
        out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    }
    for (const auto& face : mesh.faces) {
        bytes.clear();
        put(bytes, static_cast<std::uint8_t>(face.size()));
        for (const std::uint32_t corner : face) put(bytes, static_cast<std::int32_t>(corner));
        out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    }
}

template <class Number>
void put_text(std::string& line, Number value) {
    line += ' ';
    line += shortest_text(value);
}

/// White, without highlights: the colours of the vertices stay as they are.
constexpr const char* kMaterial = "newmtl surface\nKa 1 1 1\nKd 1 1 1\nKs 0 0 0\nillum 1\n";

void write_obj_mesh(std::ostream& out, const Mesh& mesh, const std::string& material_file) {
    constexpr float kFullByte = 255;
    out << "# made by PoseFusion, metres\nmtllib " << material_file << "\nusemtl surface\n";
    std::string line;
    for (const MeshVertex& v : mesh.vertices) {
        line = 'v';
        for (int i = 0; i < 3; ++i) put_text(line, v.position[i]);
        for (const std::uint8_t channel : {v.color.r, v.color.g, v.color.b})
            put_text(line, static_cast<float>(channel) / kFullByte);
        out << line << '\n';
    }
    for (const Eigen::Vector3f& normal : vertex_normals(mesh)) {
        line = "vn";
        for (int i = 0; i < 3; ++i) put_text(line, normal[i]);
        out << line << '\n';
    }
    for (const auto& face : mesh.faces) {
        line = 'f';
        for (const std::uint32_t corner : face) {
            const std::string number = shortest_text(corner + 1);
            line += ' ' + number + "//" + number;  // of position and normal
        }
        out << line << '\n';
    }
}

/// Textures of OBJ files count from the lower left corner.
void write_textured_obj_mesh(std::ostream& out, const TexturedMesh& mesh, const std::string& material_file) {
    out << "# made by PoseFusion, metres\nmtllib " << material_file << "\nusemtl surface\n";
    std::string line;
    for (const TexturedVertex& vertex : mesh.vertices) {
        line = 'v';
        for (int i = 0; i < 3; ++i) put_text(line, vertex.position[i]);
        line += "\nvt";
        put_text(line, vertex.uv.x());
        put_text(line, 1 - vertex.uv.y());
        line += "\nvn";
        for (int i = 0; i < 3; ++i) put_text(line, vertex.normal[i]);
        out << line << '\n';
    }
    for (const auto& face : mesh.faces) {
        line = 'f';
        for (const std::uint32_t corner : face) {
            const std::string number = shortest_text(corner + 1);
            line += ' ' + number + '/' + number + '/' + number;  // of position, place in the texture and normal
        }
        out << line << '\n';
    }
}

}  // namespace

void check_mesh_name(const std::filesystem::path& file) {
    for (const char* known : {".ply", ".obj", ".glb"})
        if (file.extension() == known) return;
    throw Error(file.string() + ": not a mesh format; use a name that ends in .ply, .obj or .glb");
}

void write_mesh(const std::filesystem::path& file, const Mesh& mesh, const Eigen::Quaternionf& upright) {
    check_mesh_name(file);
    const std::filesystem::path material = std::filesystem::path(file).replace_extension(".mtl");
    if (file.extension() == ".obj") write_file_atomically(material, kMaterial);
    write_file_atomically(file, [&](std::ostream& out) {
        if (file.extension() == ".obj")
            write_obj_mesh(out, mesh, material.filename().string());
        else if (file.extension() == ".glb")
            write_glb_mesh(out, mesh, upright);
        else
            write_ply_mesh(out, mesh);
    });
}

void check_textured_mesh_name(const std::filesystem::path& file) {
    if (file.extension() == ".obj" || file.extension() == ".glb") return;
    throw Error(file.string() + ": only .obj and .glb can have a texture");
}

void write_mesh(const std::filesystem::path& file, const TexturedMesh& mesh, const Eigen::Quaternionf& upright) {
    check_textured_mesh_name(file);
    if (file.extension() == ".glb")
        return write_file_atomically(file, [&](std::ostream& out) { write_glb_mesh(out, mesh, upright); });
    const auto beside = [&](const char* extension) { return std::filesystem::path(file).replace_extension(extension); };
    write_png(beside(".png"), mesh.texture);
    write_file_atomically(beside(".mtl"), kMaterial + ("map_Kd " + beside(".png").filename().string()) + '\n');
    write_file_atomically(
        file, [&](std::ostream& out) { write_textured_obj_mesh(out, mesh, beside(".mtl").filename().string()); });
}

}  // namespace posefusion
