#include "hosts/web/scene_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "hosts/report/person_colors.hpp"

namespace posefusion {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kTenthOfMillimetre = 4, kTenthOfMillisecond = 4, kRotationDecimals = 6;
/// Share of the surfels left out at either end of an axis when the size of the room is judged: stray ones lie far off.
constexpr double kStrayShare = 0.01;

/// A JSON number with no more digits than the rounding left.
Json number(double value, int decimals) {
    const double scale = std::pow(10.0, decimals);
    return std::round(value * scale) / scale;
}

Json vector(const Eigen::Vector3d& v) {
    return {number(v.x(), kTenthOfMillimetre), number(v.y(), kTenthOfMillimetre), number(v.z(), kTenthOfMillimetre)};
}

float quantile(std::vector<float>& values, double share) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// The box that holds the map but for strays.
Json bounds(const std::vector<Surfel>& surfels) {
    Eigen::Vector3d low, high;
    std::vector<float> values(surfels.size());
    for (int axis = 0; axis < 3; ++axis) {
        std::transform(surfels.begin(), surfels.end(), values.begin(),
                       [&](const Surfel& s) { return s.position[axis]; });
        low[axis] = static_cast<double>(quantile(values, kStrayShare));
        high[axis] = static_cast<double>(quantile(values, 1 - kStrayShare));
    }
    return {vector(low), vector(high)};
}

Json map_json(const std::vector<Surfel>& surfels, const EncodedMap& map, const SceneUrls& urls) {
    std::uint32_t first = surfels.front().created, last = first;
    for (const Surfel& s : surfels) {
        first = std::min(first, s.created);
        last = std::max(last, s.created);
    }
    Json pieces = Json::array();
    for (std::size_t i = 0; i < map.pieces.size(); ++i)
        pieces.push_back({{"surfels", map.pieces[i].surfels}, {"url", urls.piece(i)}});
    const MapCoding& coding = map.coding;
    return {{"surfels", surfels.size()},
            {"bounds", bounds(surfels)},
            {"created", {first, last}},
            {"coding",
             {{"origin", {coding.origin.x(), coding.origin.y(), coding.origin.z()}},
              {"step", coding.step},
              {"least_radius", coding.least_radius},
              {"radius_growth", coding.radius_growth},
              {"confidence_scale", coding.confidence_scale},
              {"bytes_per_surfel", coding.bytes_per_surfel}}},
            {"pieces", std::move(pieces)}};
}

/// Flat lists: three numbers per position, four (x y z w) per rotation.
Json poses_json(const std::vector<ScenePose>& poses) {
    Json frames = Json::array(), seconds = Json::array(), positions = Json::array(), rotations = Json::array();
    for (const ScenePose& pose : poses) {
        frames.push_back(pose.frame);
        seconds.push_back(number(pose.seconds, kTenthOfMillisecond));
        for (const double value : pose.T_page_camera.translation())
            positions.push_back(number(value, kTenthOfMillimetre));
        const Eigen::Quaterniond rotation(pose.T_page_camera.linear());
        for (const double value : rotation.coeffs()) rotations.push_back(number(value, kRotationDecimals));
    }
    return {{"frame", std::move(frames)},
            {"seconds", std::move(seconds)},
            {"position", std::move(positions)},
            {"rotation", std::move(rotations)}};
}

Json keyframes_json(const std::vector<SceneKeyframe>& keyframes, const SceneUrls& urls) {
    Json list = Json::array();
    for (std::size_t i = 0; i < keyframes.size(); ++i)
        list.push_back(
            {{"pose", keyframes[i].pose}, {"image", keyframes[i].jpeg.empty() ? Json() : Json(urls.image(i))}});
    return list;
}

Json camera_json(const std::optional<Intrinsics>& camera) {
    if (!camera) return nullptr;
    return {{"width", camera->width}, {"height", camera->height}, {"fx", camera->fx},
            {"fy", camera->fy},       {"cx", camera->cx},         {"cy", camera->cy}};
}

/// As in pictures and in the viewer.
std::string css_color(const ScenePerson& person) {
    const Rgb8 c = person_color(static_cast<std::size_t>(std::max(person.id - 1, 0)));
    return fmt::format("#{:02x}{:02x}{:02x}", c.r, c.g, c.b);
}

/// Joints as flat lists of three whole numbers, millimetres; null: not seen.
Json people_json(const std::vector<ScenePerson>& people) {
    constexpr double kMillimetres = 1000;
    Json list = Json::array();
    for (const ScenePerson& person : people) {
        Json poses = Json::array(), joints = Json::array();
        for (const SceneSkeleton& skeleton : person.skeletons) {
            poses.push_back(skeleton.pose);
            Json& flat = joints.emplace_back(Json::array());
            for (const auto& joint : skeleton.joints)
                for (int axis = 0; axis < 3; ++axis)
                    flat.push_back(joint ? Json(std::lround(kMillimetres * (*joint)[axis])) : Json());
        }
        list.push_back({{"id", person.id},
                        {"colour", css_color(person)},
                        {"pose", std::move(poses)},
                        {"joints", std::move(joints)}});
    }
    return {{"limbs", kLimbs}, {"people", std::move(list)}};
}

}  // namespace

std::string scene_json(const WebScene& scene, const EncodedMap& map, const SceneUrls& urls) {
    Json json;
    json["title"] = scene.title;
    json["facts"] = Json::array();
    for (const auto& [name, value] : scene.facts) json["facts"].push_back({name, value});
    json["map"] = map_json(scene.surfels, map, urls);
    json["poses"] = poses_json(scene.poses);
    json["keyframes"] = keyframes_json(scene.keyframes, urls);
    json["camera"] = camera_json(scene.camera);
    json["skeletons"] = people_json(scene.people);
    return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

}  // namespace posefusion
