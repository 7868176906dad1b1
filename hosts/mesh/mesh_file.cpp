#include "hosts/mesh/mesh_file.hpp"

#include <bit>
#include <cstring>
#include <ostream>
#include <string>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/io/output_file.hpp"

namespace posefusion {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY files are written without swapping bytes");

bool is_obj(const std::filesystem::path& file) { return file.extension() == ".obj"; }

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

void write_obj_mesh(std::ostream& out, const Mesh& mesh) {
    constexpr float kFullByte = 255;
    out << "# made by PoseFusion, metres\n";
    std::string line;
    for (const MeshVertex& v : mesh.vertices) {
        line = 'v';
        for (int i = 0; i < 3; ++i) put_text(line, v.position[i]);
        for (const std::uint8_t channel : {v.color.r, v.color.g, v.color.b})
            put_text(line, static_cast<float>(channel) / kFullByte);
        out << line << '\n';
    }
    for (const auto& face : mesh.faces) {
        line = 'f';
        for (const std::uint32_t corner : face) put_text(line, corner + 1);
        out << line << '\n';
    }
}

}  // namespace

void check_mesh_name(const std::filesystem::path& file) {
    if (file.extension() != ".ply" && !is_obj(file))
        throw Error(file.string() + ": not a mesh format; use a name that ends in .ply or .obj");
}

void write_mesh(const std::filesystem::path& file, const Mesh& mesh) {
    check_mesh_name(file);
    write_file_atomically(
        file, [&](std::ostream& out) { is_obj(file) ? write_obj_mesh(out, mesh) : write_ply_mesh(out, mesh); });
}

}  // namespace posefusion
