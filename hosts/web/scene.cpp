#include "hosts/web/scene.hpp"

#include <algorithm>

#include "hosts/report/upright.hpp"

namespace posefusion {
namespace {

/// The engine counts frames on from those of a loaded map. How many these were is in no file; but the surfels in view
/// of the last frame were seen in it.
std::size_t frames_before(const std::vector<Surfel>& map, std::size_t frames_of_run) {
    std::size_t last = 0;
    for (const Surfel& s : map) last = std::max<std::size_t>(last, s.last_seen);
    return last + 1 > frames_of_run ? last + 1 - frames_of_run : 0;
}

/// Of the poses of the trajectory, which was written with six decimals of a second or nine.
std::optional<std::size_t> pose_at(const Trajectory& trajectory, Stamp stamp) {
    constexpr Stamp kRounding{1'000};  // people.json has doubles
    const auto at = std::lower_bound(trajectory.begin(), trajectory.end(), stamp - kRounding,
                                     [](const StampedPose& pose, Stamp wanted) { return pose.stamp < wanted; });
    if (at == trajectory.end() || at->stamp > stamp + kRounding) return std::nullopt;
    return static_cast<std::size_t>(at - trajectory.begin());
}

ScenePerson person_in_page(const FollowedPerson& followed, const Trajectory& trajectory,
                           const Eigen::Isometry3d& T_page_world) {
    ScenePerson person{followed.id, {}};
    for (const Sighting& sighting : followed.sightings) {
        const auto pose = pose_at(trajectory, sighting.stamp);
        if (!pose) continue;
        SceneSkeleton& skeleton = person.skeletons.emplace_back();
        skeleton.pose = *pose;
        for (std::size_t i = 0; i < skeleton.joints.size(); ++i)
            if (sighting.joints[i]) skeleton.joints[i] = T_page_world * *sighting.joints[i];
    }
    return person;
}

}  // namespace

/// upright_axes() are right, forward and up; the page has y up and looks along -z, as WebGL's libraries do.
Eigen::Isometry3d page_from_world(const std::vector<Surfel>& map, const Trajectory& trajectory) {
    Eigen::Isometry3d T_page_upright = Eigen::Isometry3d::Identity();
    T_page_upright.linear() << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    return T_page_upright * upright_axes(map, trajectory).inverse();
}

void transform(std::vector<Surfel>& surfels, const Eigen::Isometry3d& T) {
    const Eigen::Isometry3f moved = T.cast<float>();
    for (Surfel& s : surfels) {
        s.position = moved * s.position;
        s.normal = moved.linear() * s.normal;
    }
}

WebScene make_scene(std::string title, std::vector<Surfel> map, const RunResults* results) {
    WebScene scene;
    scene.title = std::move(title);
    scene.surfels = std::move(map);
    static const Trajectory kNoTrajectory;
    const Trajectory& trajectory = results != nullptr ? results->trajectory : kNoTrajectory;
    const Eigen::Isometry3d T_page_world = page_from_world(scene.surfels, trajectory);
    if (results != nullptr) {
        const std::size_t before = frames_before(scene.surfels, results->frames_of_run);
        for (std::size_t i = 0; i < trajectory.size(); ++i)
            scene.poses.push_back({before + results->frames[i],
                                   to_seconds(trajectory[i].stamp - trajectory.front().stamp),
                                   T_page_world * trajectory[i].T_world_camera});
        for (const std::size_t pose : results->keyframes) scene.keyframes.push_back({pose, {}});
        scene.camera = results->camera;
        scene.facts = results->facts;
        for (const FollowedPerson& person : results->people)
            scene.people.push_back(person_in_page(person, trajectory, T_page_world));
    }
    transform(scene.surfels, T_page_world);
    return scene;
}

}  // namespace posefusion
