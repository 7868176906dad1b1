#include "hosts/run/people_json.hpp"

#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

namespace posefusion {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kPeopleVersion = 1;
constexpr double kPlaces = 1e4;  ///< a tenth of a millimetre

/// As OpenPose calls them.
constexpr std::array<const char*, kJointCount> kJointNames{
    "Nose",  "Neck",   "RShoulder", "RElbow", "RWrist", "LShoulder", "LElbow", "LWrist", "RHip",
    "RKnee", "RAnkle", "LHip",      "LKnee",  "LAnkle", "REye",      "LEye",   "REar",   "LEar"};

double rounded(double value) { return std::round(value * kPlaces) / kPlaces; }

Json joints_json(const PersonInView& person, const Eigen::Isometry3d& T_world_camera) {
    Json joints = Json::array();
    for (const PersonInView::Joint& joint : person.joints) {
        if (joint.confidence <= 0) {
            joints.push_back(nullptr);
            continue;
        }
        const Eigen::Vector3d point = T_world_camera * joint.point.cast<double>();
        joints.push_back({rounded(point.x()), rounded(point.y()), rounded(point.z()),
                          rounded(static_cast<double>(joint.confidence))});
    }
    return joints;
}

}  // namespace

std::string people_json(const RunRecord& record) {
    std::map<int, Json> frames_of;
    if (!record.pieces.empty()) {
        const PieceRecord& piece = record.pieces.front();
        for (std::size_t i = 0; i < piece.frames.size(); ++i) {
            const FrameRecord& frame = record.frames[piece.frames[i]];
            if (!has_pose(frame.result.tracking)) continue;
            for (const PersonInView& person : frame.in_view) {
                Json& frames = frames_of.try_emplace(person.id, Json::array()).first->second;
                frames.push_back({{"frame", frame.index},
                                  {"timestamp", to_seconds(frame.stamp)},
                                  {"joints", joints_json(person, piece.poses[i])}});
            }
        }
    }
    Json people = Json::array();
    for (auto& [id, frames] : frames_of)
        if (frames.size() >= kFewestSightings) people.push_back({{"id", id}, {"frames", std::move(frames)}});
    return Json{{"format", "posefusion people"},
                {"version", kPeopleVersion},
                {"joints", kJointNames},
                {"people", std::move(people)}}
               .dump() +
           "\n";
}

}  // namespace posefusion
