#include "tools/evaluate_objects/object_truth.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "PLY files are read without swapping bytes");

constexpr std::size_t kVertexBytes = 3 * sizeof(float) + 3;
constexpr std::size_t kFaceBytes = 1 + 3 * sizeof(std::int32_t);

std::string bytes_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw Error(file.string() + ": cannot be read; an object of info.json needs it");
    std::ostringstream bytes;
    bytes << in.rdbuf();
    return bytes.str();
}

/// 0 if the header does not say it.
std::size_t count_of(const std::string& header, const std::string& element) {
    const std::string begin = "element " + element + " ";
    const std::size_t at = header.find(begin);
    std::size_t count = 0;
    if (at != std::string::npos)
        std::from_chars(header.data() + at + begin.size(), header.data() + header.size(), count);
    return count;
}

/// The largest way of a corner of the bounding box from one pose to the other, metres.
double way_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b,
                   const std::vector<Eigen::Vector3d>& corners) {
    double way = 0;
    for (const Eigen::Vector3d& corner : corners) way = std::max(way, (a * corner - b * corner).norm());
    return way;
}

std::vector<Eigen::Vector3d> corners_of(const TrueMesh& mesh) {
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& vertex : mesh.vertices) box.extend(vertex);
    if (box.isEmpty()) return {Eigen::Vector3d::Zero()};
    std::vector<Eigen::Vector3d> corners;
    for (int i = 0; i < 8; ++i)
        corners.push_back(box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(i)).cast<double>());
    return corners;
}

}  // namespace

Eigen::Vector3d TrueMesh::middle() const {
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& vertex : vertices) box.extend(vertex);
    return box.isEmpty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(box.center().cast<double>());
}

TrueMesh read_true_mesh(const fs::path& file) {
    const std::string bytes = bytes_of(file);
    const std::string end = "end_header\n";
    const std::size_t at = bytes.find(end);
    const std::string header = bytes.substr(0, at == std::string::npos ? 0 : at);
    const std::size_t vertices = count_of(header, "vertex"), faces = count_of(header, "face");
    const bool possible = std::max(vertices, faces) <= bytes.size();  // the products below do not overflow
    if (!possible || faces == 0 ||
        bytes.size() != header.size() + end.size() + vertices * kVertexBytes + faces * kFaceBytes)
        throw Error(file.string() + ": not a mesh as posefusion writes it; make the recording again");
    TrueMesh mesh;
    const char* next = bytes.data() + at + end.size();
    for (std::size_t i = 0; i < vertices; ++i, next += kVertexBytes) {
        Eigen::Vector3f p;
        std::memcpy(p.data(), next, 3 * sizeof(float));
        mesh.vertices.push_back(p);
    }
    for (std::size_t i = 0; i < faces; ++i, next += kFaceBytes) {
        std::array<std::uint32_t, 3> corners{};
        std::memcpy(corners.data(), next + 1, sizeof corners);
        if (*next != 3 || *std::max_element(corners.begin(), corners.end()) >= vertices)
            throw Error(file.string() + ": its faces are damaged; make the recording again");
        mesh.faces.push_back(corners);
    }
    return mesh;
}

std::vector<TrueObject> read_true_objects(const fs::path& recording) {
    std::ifstream in(recording / "info.json");
    if (!in) return {};
    std::vector<TrueObject> objects;
    try {
        const auto info = nlohmann::json::parse(in);
        if (!info.contains("objects")) return {};
        for (const auto& entry : info["objects"]) {
            TrueObject object{entry["kind"], entry["label"], entry["rigid"], {}, {}};
            if (object.label < kFirstObjectLabel) continue;
            object.poses = read_trajectory(recording / entry["trajectory"].get<std::string>());
            object.mesh = read_true_mesh(recording / entry["mesh"].get<std::string>());
            objects.push_back(std::move(object));
        }
    } catch (const nlohmann::json::exception& e) {
        throw Error((recording / "info.json").string() + ": " + e.what());
    }
    return objects;
}

std::vector<ObjectState> states_of(const TrueObject& object, const MotionConfig& config) {
    const Trajectory& poses = object.poses;
    const std::vector<Eigen::Vector3d> corners = corners_of(object.mesh);
    std::vector<ObjectState> states(poses.size(), ObjectState::Stands);
    int moving = 0;
    for (std::size_t i = 0, first = 0; i < poses.size(); ++i) {
        while (to_seconds(poses[i].stamp - poses[first].stamp) > config.window) ++first;
        const double time = to_seconds(poses[i].stamp - poses[first].stamp);
        const double way = way_between(poses[i].T_world_camera, poses[first].T_world_camera, corners);
        // In the first frames there is less time to go the way.
        moving = time > 0 && way >= config.way * std::min(time / config.window, 1.0) ? moving + 1 : 0;
        if (moving > 0) states[i] = moving > config.settled ? ObjectState::Moves : ObjectState::Begins;
    }
    return states;
}

}  // namespace posefusion
