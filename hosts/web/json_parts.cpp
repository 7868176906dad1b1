#include "hosts/web/json_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "hosts/report/person_colors.hpp"

namespace posefusion {
namespace {

constexpr int kTenthOfMillimetre = 4, kTenthOfMillisecond = 4, kRotationDecimals = 6;
/// Share of the surfels left out at either end of an axis when the size of the room is judged: stray ones lie far off.
constexpr double kStrayShare = 0.01;

/// A JSON number with no more digits than the rounding left.
WebJson number(double value, int decimals) {
    const double scale = std::pow(10.0, decimals);
    return std::round(value * scale) / scale;
}

WebJson vector(const Eigen::Vector3d& v) {
    return {number(v.x(), kTenthOfMillimetre), number(v.y(), kTenthOfMillimetre), number(v.z(), kTenthOfMillimetre)};
}

float quantile(std::vector<float>& values, double share) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// The box that holds the map but for strays.
WebJson bounds(const std::vector<Surfel>& surfels) {
    Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = low;
    if (surfels.empty()) return {vector(low), vector(high)};
    std::vector<float> values(surfels.size());
    for (int axis = 0; axis < 3; ++axis) {
        std::transform(surfels.begin(), surfels.end(), values.begin(),
                       [&](const Surfel& s) { return s.position[axis]; });
        low[axis] = static_cast<double>(quantile(values, kStrayShare));
        high[axis] = static_cast<double>(quantile(values, 1 - kStrayShare));
    }
    return {vector(low), vector(high)};
}

/// The least and the greatest frame number.
template <class FrameOf>
WebJson frame_range(const std::vector<Surfel>& surfels, FrameOf&& frame_of) {
    if (surfels.empty()) return {0, 0};
    std::uint32_t first = frame_of(surfels.front()), last = first;
    for (const Surfel& s : surfels) {
        first = std::min(first, frame_of(s));
        last = std::max(last, frame_of(s));
    }
    return {first, last};
}

/// As in pictures and in the viewer.
std::string css_color(const ScenePerson& person) {
    const Rgb8 c = person_color(static_cast<std::size_t>(std::max(person.id - 1, 0)));
    return fmt::format("#{:02x}{:02x}{:02x}", c.r, c.g, c.b);
}

}  // namespace

WebJson map_facts_json(const std::vector<Surfel>& surfels) {
    float confidence = 0;
    for (const Surfel& s : surfels) confidence = std::max(confidence, s.confidence);
    return {{"surfels", surfels.size()},
            {"bounds", bounds(surfels)},
            {"created", frame_range(surfels, [](const Surfel& s) { return s.created; })},
            {"seen", frame_range(surfels, [](const Surfel& s) { return s.last_seen; })},
            {"confidence", confidence}};
}

WebJson coding_json(const MapCoding& coding) {
    return {{"origin", {coding.origin.x(), coding.origin.y(), coding.origin.z()}},
            {"step", coding.step},
            {"least_radius", coding.least_radius},
            {"radius_growth", coding.radius_growth},
            {"confidence_scale", coding.confidence_scale},
            {"bytes_per_surfel", coding.bytes_per_surfel}};
}

WebJson poses_json(std::span<const ScenePose> poses) {
    WebJson frames = WebJson::array(), seconds = WebJson::array(), positions = WebJson::array(),
            rotations = WebJson::array();
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

WebJson camera_json(const std::optional<Intrinsics>& camera) {
    if (!camera) return nullptr;
    return {{"width", camera->width}, {"height", camera->height}, {"fx", camera->fx},
            {"fy", camera->fy},       {"cx", camera->cx},         {"cy", camera->cy}};
}

WebJson people_json(const std::vector<ScenePerson>& people) {
    constexpr double kMillimetres = 1000;
    WebJson list = WebJson::array();
    for (const ScenePerson& person : people) {
        WebJson poses = WebJson::array(), joints = WebJson::array();
        for (const SceneSkeleton& skeleton : person.skeletons) {
            poses.push_back(skeleton.pose);
            WebJson& flat = joints.emplace_back(WebJson::array());
            for (const auto& joint : skeleton.joints)
                for (int axis = 0; axis < 3; ++axis)
                    flat.push_back(joint ? WebJson(std::lround(kMillimetres * (*joint)[axis])) : WebJson());
        }
        list.push_back({{"id", person.id},
                        {"colour", css_color(person)},
                        {"pose", std::move(poses)},
                        {"joints", std::move(joints)}});
    }
    return {{"limbs", kLimbs}, {"people", std::move(list)}};
}

}  // namespace posefusion
