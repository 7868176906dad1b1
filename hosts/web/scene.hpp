#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/intrinsics.hpp"
#include "engine/map/surfel.hpp"
#include "hosts/web/run_results.hpp"
#include "pose/joints.hpp"

/// What the page shows: plain data, independent of how it gets into a browser.
namespace posefusion {

/// A pose of the camera. Page frame: origin at the first camera, x right, y up, z backwards; metres. The camera's own
/// axes stay those of the images: x right, y down, z forward.
struct ScenePose {
    std::size_t frame = 0;  ///< of the engine, as in Surfel::created
    double seconds = 0;     ///< since the first pose
    Eigen::Isometry3d T_page_camera = Eigen::Isometry3d::Identity();
};

/// A place that the engine can recognise.
struct SceneKeyframe {
    std::size_t pose = 0;  ///< position in WebScene::poses
    std::string jpeg;      ///< what the camera saw, small; empty: not at hand
};

/// The joints of a person at the time of a pose.
struct SceneSkeleton {
    std::size_t pose = 0;                                            ///< position in WebScene::poses
    std::array<std::optional<Eigen::Vector3d>, kJointCount> joints;  ///< page frame; nullopt: not seen
};

/// A person who was followed over time.
struct ScenePerson {
    int id = 0;
    std::vector<SceneSkeleton> skeletons;  ///< ascending poses
};

struct WebScene {
    std::string title;
    std::vector<std::pair<std::string, std::string>> facts;  ///< of the run, to be read
    std::vector<Surfel> surfels;                             ///< page frame
    std::vector<ScenePose> poses;                            ///< ascending frames; empty for a map without a run
    std::vector<SceneKeyframe> keyframes;
    std::optional<Intrinsics> camera;  ///< of the images
    std::vector<ScenePerson> people;
};

/// Upright, with the first camera in the origin. @param map, trajectory  either may be empty
[[nodiscard]] Eigen::Isometry3d page_from_world(const std::vector<Surfel>& map, const Trajectory& trajectory);
void transform(std::vector<Surfel>& surfels, const Eigen::Isometry3d& T);

/// @param map      world frame, not empty
/// @param results  of the run that made it; nullptr: there is nothing but a map
[[nodiscard]] WebScene make_scene(std::string title, std::vector<Surfel> map, const RunResults* results);

}  // namespace posefusion
