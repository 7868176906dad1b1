#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hosts/web/live_map.hpp"
#include "hosts/web/scene.hpp"

/// What page/live_run.js is told of a run that goes on.
namespace posefusion {

/// The scene that the page begins with: nothing yet, and where the rest will come from.
/// @param url  of live_state_json()
[[nodiscard]] std::string live_scene_json(const std::string& title, const Intrinsics& camera, const MapCoding& coding,
                                          const std::string& url);

/// Some of the poses, and the skeletons at their times. @param first, count  positions in `scene.poses`
[[nodiscard]] std::string live_path_json(const WebScene& scene, std::size_t first, std::size_t count);

/// The state of the run, and which version of each of its parts is the newest.
struct LiveState {
    std::string status;            ///< "running", or how the run ended
    std::size_t frames = 0;        ///< done
    std::size_t frames_to_do = 0;  ///< 0 = not known
    std::vector<std::uint64_t> path;
    std::vector<LiveMap::Cell> cells;
    std::vector<std::optional<std::size_t>> pictures;  ///< number of that of each keyframe of the scene
};
/// @param surfels  the whole map, page frame
[[nodiscard]] std::string live_state_json(const LiveState& state, const WebScene& scene,
                                          const std::vector<Surfel>& surfels);

}  // namespace posefusion
