#include "hosts/viewer/shown_objects.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace posefusion {

ShownObject& ShownObjects::object(std::uint8_t label) {
    const auto at = std::lower_bound(objects_.begin(), objects_.end(), label,
                                     [](const ShownObject& o, std::uint8_t wanted) { return o.label < wanted; });
    if (at != objects_.end() && at->label == label) return *at;
    ShownObject added;
    added.label = label;
    return *objects_.insert(at, std::move(added));
}

void ShownObjects::extend_path(const Sighting& sighting, const Eigen::Isometry3f& T_world_camera) {
    std::vector<Eigen::Vector3f>& path = object(sighting.label).path;
    auto last = std::find_if(last_shown_.begin(), last_shown_.end(),
                             [&](const auto& entry) { return entry.first == sighting.label; });
    if (last == last_shown_.end())
        last = last_shown_.insert(last, {sighting.label, sighting.frame});
    else if (last->second + 1 < sighting.frame)
        path.emplace_back(Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
    last->second = sighting.frame;
    path.emplace_back((T_world_camera * sighting.T_camera_object).translation());
}

void ShownObjects::add(const FrameNews& news) {
    newest_ = news.number;
    for (ShownObject& known : objects_) known.T_world_object.reset(), known.pixels = 0;
    if (!has_pose(news.result.tracking)) return;
    const Eigen::Isometry3f T_world_camera = news.T_world_camera.cast<float>();
    for (const MovingObject& seen : news.result.objects) {
        const Sighting sighting{news.number, news.stamp, seen.label, seen.T_camera_object.cast<float>()};
        sightings_.push_back(sighting);
        extend_path(sighting, T_world_camera);
        ShownObject& shown = object(seen.label);
        shown.T_world_object = T_world_camera * sighting.T_camera_object;
        shown.pixels = seen.pixels;
        ++shown.frames;
    }
}

void ShownObjects::correct(const Trajectory& poses) {
    for (ShownObject& known : objects_) known.path.clear();
    last_shown_.clear();
    auto pose = poses.begin();
    for (const Sighting& sighting : sightings_) {
        pose = std::find_if(pose, poses.end(), [&](const StampedPose& p) { return p.stamp >= sighting.stamp; });
        if (pose == poses.end()) break;
        if (pose->stamp == sighting.stamp) extend_path(sighting, pose->T_world_camera.cast<float>());
    }
}

void ShownObjects::set_models(std::vector<ObjectMap> models) {
    for (ObjectMap& model : models) object(model.label).model = std::move(model.surfels);
}

void ShownObjects::clear() { *this = {}; }

std::vector<Surfel> ShownObjects::surfels() const {
    std::vector<Surfel> all;
    for (const ShownObject& shown : objects_) {
        if (!shown.T_world_object) continue;
        std::uint32_t last = 0;
        for (const Surfel& surfel : shown.model) last = std::max(last, surfel.last_seen);
        const auto now = static_cast<std::uint32_t>(newest_);
        const auto in_run = [&](std::uint32_t frame) { return now - std::min(now, last - frame); };
        for (Surfel surfel : shown.model) {
            surfel.position = *shown.T_world_object * surfel.position;
            surfel.normal = shown.T_world_object->linear() * surfel.normal;
            surfel.created = in_run(surfel.created);
            surfel.last_seen = in_run(surfel.last_seen);
            all.push_back(surfel);
        }
    }
    return all;
}

}  // namespace posefusion
