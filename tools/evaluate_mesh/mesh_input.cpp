#include "tools/evaluate_mesh/mesh_input.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "engine/core/error.hpp"
#include "hosts/io/input_file.hpp"

namespace posefusion {
namespace {

using Json = nlohmann::json;

constexpr int kFloat = 5126, kUnsignedInt = 5125;  // glTF's numbers
constexpr std::uint64_t kLargestFile = std::uint64_t{1} << 32;

[[noreturn]] void refuse(const std::string& name, const std::string& what) { throw Error(name + ": " + what); }

/// The bytes of an accessor with elements of `size` bytes that lie close together.
ByteView bytes_of(const Json& gltf, std::size_t accessor, int type, const char* shape, std::size_t size,
                  ByteView binary, std::size_t& count) {
    const Json& entry = gltf.at("accessors").at(accessor);
    const Json& view = gltf.at("bufferViews").at(entry.at("bufferView").get<std::size_t>());
    if (entry.at("componentType").get<int>() != type || entry.at("type").get<std::string>() != shape ||
        view.contains("byteStride"))
        throw Error("its numbers are not laid out as PoseFusion does it");
    count = entry.at("count").get<std::size_t>();
    const auto begin = view.value("byteOffset", std::size_t{0}) + entry.value("byteOffset", std::size_t{0});
    if (begin > binary.size() || count > (binary.size() - begin) / size) throw Error("it is damaged");
    return binary.subspan(begin, count * size);
}

TrueMesh read_glb(const std::filesystem::path& path) {
    const InputFile file(path);
    if (file.size() > kLargestFile) refuse(file.name(), "is larger than a .glb can be");
    const ByteBuffer content = file.read(0, file.size());
    ByteReader reader(content, file.name());
    const ByteView magic = reader.take(4);
    if (!std::equal(magic.begin(), magic.end(), "glTF") || reader.take<std::uint32_t>() != 2)
        refuse(file.name(), "is no .glb of version 2");
    (void)reader.take<std::uint32_t>();  // of the whole file
    const auto chunk = [&](std::string_view type) {
        const auto length = reader.take<std::uint32_t>();
        const ByteView name = reader.take(4);
        if (!std::equal(name.begin(), name.end(), type.begin(), type.end()))
            refuse(file.name(), "lacks a part that a .glb has");
        return reader.take(length);
    };
    const ByteView text = chunk("JSON"), binary = chunk({"BIN\0", 4});
    TrueMesh mesh;
    try {
        const Json gltf = Json::parse(text.begin(), text.end());
        const Json& primitive = gltf.at("meshes").at(0).at("primitives").at(0);
        std::size_t vertices = 0, corners = 0;
        ByteReader positions(bytes_of(gltf, primitive.at("attributes").at("POSITION").get<std::size_t>(), kFloat,
                                      "VEC3", 3 * sizeof(float), binary, vertices),
                             file.name());
        ByteReader indices(bytes_of(gltf, primitive.at("indices").get<std::size_t>(), kUnsignedInt, "SCALAR",
                                    sizeof(std::uint32_t), binary, corners),
                           file.name());
        for (std::size_t i = 0; i < vertices; ++i) {
            Eigen::Vector3f& p = mesh.vertices.emplace_back();
            for (int axis = 0; axis < 3; ++axis) p[axis] = positions.take<float>();
        }
        for (std::size_t i = 0; i + 3 <= corners; i += 3) {
            auto& face = mesh.faces.emplace_back();
            for (std::uint32_t& corner : face) corner = indices.take<std::uint32_t>();
        }
    } catch (const Json::exception&) {
        refuse(file.name(), "its description is not that of a mesh of PoseFusion");
    } catch (const Error& error) {
        refuse(file.name(), error.what());
    }
    return mesh;
}

void check_mesh(const TrueMesh& mesh, const std::string& name) {
    if (mesh.faces.empty()) refuse(name, "has no triangles");
    for (const Eigen::Vector3f& p : mesh.vertices)
        if (!p.allFinite()) refuse(name, "has a vertex that is nowhere");
    for (const auto& face : mesh.faces)
        for (const std::uint32_t corner : face)
            if (corner >= mesh.vertices.size()) refuse(name, "has a triangle with a vertex that it lacks");
}

}  // namespace

TrueMesh read_exported_mesh(const std::filesystem::path& file) {
    const std::string ending = file.extension().string();
    if (ending == ".glb") return read_exported_glb(file);
    if (ending != ".ply") refuse(file.string(), "is no .ply and no .glb");
    TrueMesh mesh = read_true_mesh(file);
    check_mesh(mesh, file.string());
    return mesh;
}

TrueMesh read_exported_glb(const std::filesystem::path& file) {
    TrueMesh mesh = read_glb(file);
    check_mesh(mesh, file.string());
    return mesh;
}

}  // namespace posefusion
