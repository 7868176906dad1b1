#include "hosts/web/people_file.hpp"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "posefusion people";
constexpr int kVersion = 1;

Sighting sighting_of(const Json& frame) {
    Sighting sighting;
    sighting.stamp = stamp_of(frame.at("timestamp").get<double>());
    const Json& joints = frame.at("joints");
    for (std::size_t i = 0; i < sighting.joints.size(); ++i) {
        const Json& joint = joints.at(i);
        if (joint.is_null()) continue;
        const Eigen::Vector3d point(joint.at(0).get<double>(), joint.at(1).get<double>(), joint.at(2).get<double>());
        if (point.allFinite()) sighting.joints[i] = point;
    }
    return sighting;
}

}  // namespace

std::vector<FollowedPerson> read_people(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw Error(file.string() + ": cannot be read");
    std::vector<FollowedPerson> people;
    try {
        const Json json = Json::parse(in);
        if (json.at("format") != kFormat || json.at("version") != kVersion)
            throw Error(file.string() + ": is of another format or version; run the recording again");
        for (const Json& person : json.at("people")) {
            FollowedPerson& followed = people.emplace_back();
            followed.id = person.at("id").get<int>();
            for (const Json& frame : person.at("frames")) followed.sightings.push_back(sighting_of(frame));
        }
    } catch (const Json::exception&) {
        throw Error(file.string() + ": is not what `posefusion run` writes; run the recording again");
    }
    return people;
}

}  // namespace posefusion
