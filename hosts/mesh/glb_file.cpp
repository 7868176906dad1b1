#include "hosts/mesh/glb_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>

#include "engine/core/error.hpp"
#include "hosts/io/image_file.hpp"

namespace posefusion {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF is written without swapping bytes");

using Json = nlohmann::ordered_json;

/// Numbers that glTF gives to types and uses (its section 5).
constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;
constexpr int kLinear = 9729, kLinearMipmapLinear = 9987, kClampToEdge = 33071;
constexpr int kVertexAttributes = 34962, kIndices = 34963;
constexpr int kJpegQuality = 92;       ///< of textures: a third of a PNG, and no difference to be seen
constexpr std::size_t kAlignment = 4;  ///< of chunks, and of what is in them

/// The binary chunk and the JSON that says what is where in it.
class Buffer {
public:
    /// @param put  appends the bytes of an element @return number of the accessor
    template <class Elements, class Put>
    std::size_t add(const Elements& elements, const char* type, int component, int target, Put&& put) {
        const std::size_t begin = bytes_.size();
        for (const auto& element : elements) put(element);
        views_.push_back(
            {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", bytes_.size() - begin}, {"target", target}});
        accessors_.push_back({{"bufferView", views_.size() - 1},
                              {"componentType", component},
                              {"count", elements.size()},
                              {"type", type}});
        align();
        return accessors_.size() - 1;
    }

    template <class Number>
    void put(Number value) {
        char bytes[sizeof value];
        std::memcpy(bytes, &value, sizeof value);
        bytes_.append(bytes, sizeof value);
    }
    template <int Size>
    void put(const Eigen::Matrix<float, Size, 1>& vector) {
        for (int i = 0; i < Size; ++i) put(vector[i]);
    }

    /// Bytes of a file, as they are. @return number of the buffer view
    std::size_t add_file(const std::string& content) {
        views_.push_back({{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", content.size()}});
        bytes_ += content;
        align();
        return views_.size() - 1;
    }

    [[nodiscard]] Json& accessor(std::size_t number) { return accessors_[number]; }
    [[nodiscard]] const Json& accessors() const { return accessors_; }
    [[nodiscard]] const Json& views() const { return views_; }
    [[nodiscard]] const std::string& bytes() const { return bytes_; }

private:
    void align() { bytes_.resize((bytes_.size() + kAlignment - 1) / kAlignment * kAlignment); }

    std::string bytes_;
    Json views_ = Json::array(), accessors_ = Json::array();
};

/// sRGB (IEC 61966-2-1) to linear light, of 65535.
std::uint16_t linear(std::uint8_t channel) {
    static const auto kTable = [] {
        std::array<std::uint16_t, 256> table{};
        for (std::size_t i = 0; i < table.size(); ++i) {
            const double s = static_cast<double>(i) / 255;
            const double light = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
            table[i] = static_cast<std::uint16_t>(std::lround(light * 65535));
        }
        return table;
    }();
    return kTable[channel];
}

/// The exact value of a float, which minima and maxima have to be.
Json numbers(const Eigen::Vector3f& v) {
    return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

template <class Vertices>
std::size_t add_positions(Buffer& buffer, const Vertices& vertices) {
    Eigen::Vector3f least = vertices.front().position, most = least;
    const std::size_t number = buffer.add(vertices, "VEC3", kFloat, kVertexAttributes, [&](const auto& vertex) {
        least = least.cwiseMin(vertex.position);
        most = most.cwiseMax(vertex.position);
        buffer.put(vertex.position);
    });
    buffer.accessor(number)["min"] = numbers(least);
    buffer.accessor(number)["max"] = numbers(most);
    return number;
}

/// With alpha: elements are aligned to four bytes.
std::size_t add_colors(Buffer& buffer, const Mesh& mesh) {
    const std::size_t number =
        buffer.add(mesh.vertices, "VEC4", kUnsignedShort, kVertexAttributes, [&](const MeshVertex& vertex) {
            for (const std::uint8_t channel : {vertex.color.r, vertex.color.g, vertex.color.b})
                buffer.put(linear(channel));
            buffer.put(std::numeric_limits<std::uint16_t>::max());
        });
    buffer.accessor(number)["normalized"] = true;
    return number;
}

std::size_t add_indices(Buffer& buffer, const std::vector<std::array<std::uint32_t, 3>>& faces) {
    std::vector<std::uint32_t> corners;
    corners.reserve(3 * faces.size());
    for (const auto& face : faces) corners.insert(corners.end(), face.begin(), face.end());
    return buffer.add(corners, "SCALAR", kUnsignedInt, kIndices, [&](std::uint32_t corner) { buffer.put(corner); });
}

Json describe(const Json& attributes, std::size_t indices, const Eigen::Quaternionf& upright) {
    const Json unlit = {{"KHR_materials_unlit", Json::object()}};
    Json gltf;
    gltf["asset"] = {{"version", "2.0"}, {"generator", "PoseFusion"}};
    gltf["extensionsUsed"] = {"KHR_materials_unlit"};
    gltf["scene"] = 0;
    gltf["scenes"] = Json::array({{{"nodes", {0}}}});
    gltf["nodes"] = Json::array(
        {{{"name", "map"}, {"mesh", 0}, {"rotation", {upright.x(), upright.y(), upright.z(), upright.w()}}}});
    gltf["meshes"] = Json::array(
        {{{"primitives", Json::array({{{"attributes", attributes}, {"indices", indices}, {"material", 0}}})}}});
    gltf["materials"] = Json::array(
        {{{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}}, {"extensions", unlit}}});
    return gltf;
}

void write_number(std::ostream& out, std::size_t value) {
    const auto number = static_cast<std::uint32_t>(value);
    out.write(reinterpret_cast<const char*>(&number), sizeof number);
}

void write_chunk(std::ostream& out, const char* type, const std::string& bytes) {
    write_number(out, bytes.size());
    out.write(type, 4);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// Completes the JSON and writes the file.
void write_file(std::ostream& out, Json gltf, const Buffer& buffer) {
    gltf["accessors"] = buffer.accessors();
    gltf["bufferViews"] = buffer.views();
    gltf["buffers"] = Json::array({{{"byteLength", buffer.bytes().size()}}});
    std::string json = gltf.dump();
    json.resize((json.size() + kAlignment - 1) / kAlignment * kAlignment, ' ');

    constexpr std::size_t kHeader = 12, kChunkHeader = 8;
    const std::size_t bytes = kHeader + 2 * kChunkHeader + json.size() + buffer.bytes().size();
    if (bytes > std::numeric_limits<std::uint32_t>::max())
        throw Error("the mesh needs more than the 4 GB of a .glb file; give --max-triangles");
    out.write("glTF", 4);
    write_number(out, 2);  // version
    write_number(out, bytes);
    write_chunk(out, "JSON", json);
    write_chunk(out, std::string("BIN\0", 4).c_str(), buffer.bytes());
}

template <class AnyMesh>
void check_that_it_has_triangles(const AnyMesh& mesh) {
    if (mesh.faces.empty()) throw Error("a mesh without triangles cannot be a .glb file");
}

}  // namespace

void write_glb_mesh(std::ostream& out, const Mesh& mesh, const Eigen::Quaternionf& upright) {
    check_that_it_has_triangles(mesh);
    Buffer buffer;
    Json attributes;
    attributes["POSITION"] = add_positions(buffer, mesh.vertices);
    attributes["NORMAL"] = buffer.add(vertex_normals(mesh), "VEC3", kFloat, kVertexAttributes,
                                      [&](const Eigen::Vector3f& normal) { buffer.put(normal); });
    attributes["COLOR_0"] = add_colors(buffer, mesh);
    const std::size_t indices = add_indices(buffer, mesh.faces);
    write_file(out, describe(attributes, indices, upright.normalized()), buffer);
}

void write_glb_mesh(std::ostream& out, const TexturedMesh& mesh, const Eigen::Quaternionf& upright) {
    check_that_it_has_triangles(mesh);
    Buffer buffer;
    Json attributes;
    attributes["POSITION"] = add_positions(buffer, mesh.vertices);
    attributes["NORMAL"] = buffer.add(mesh.vertices, "VEC3", kFloat, kVertexAttributes,
                                      [&](const TexturedVertex& vertex) { buffer.put(vertex.normal); });
    attributes["TEXCOORD_0"] = buffer.add(mesh.vertices, "VEC2", kFloat, kVertexAttributes,
                                          [&](const TexturedVertex& vertex) { buffer.put(vertex.uv); });
    const std::size_t indices = add_indices(buffer, mesh.faces);
    Json gltf = describe(attributes, indices, upright.normalized());
    gltf["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
    gltf["textures"] = Json::array({{{"source", 0}, {"sampler", 0}}});
    gltf["samplers"] = Json::array({{{"magFilter", kLinear},
                                     {"minFilter", kLinearMipmapLinear},
                                     {"wrapS", kClampToEdge},
                                     {"wrapT", kClampToEdge}}});
    const std::size_t image = buffer.add_file(encode_jpeg(mesh.texture, kJpegQuality));
    gltf["images"] = Json::array({{{"bufferView", image}, {"mimeType", "image/jpeg"}}});
    write_file(out, std::move(gltf), buffer);
}

}  // namespace posefusion
