#pragma once
#include <functional>
#include <string>

#include "hosts/web/map_pieces.hpp"
#include "hosts/web/scene.hpp"

namespace posefusion {

/// Where the page finds the parts of a scene that are not in its JSON: URLs.
struct SceneUrls {
    std::function<std::string(std::size_t piece)> piece;
    std::function<std::string(std::size_t keyframe)> image;  ///< asked for keyframes that have one
};

/// The scene as page/scene_data.js reads it; metres, seconds, page frame.
[[nodiscard]] std::string scene_json(const WebScene& scene, const EncodedMap& map, const SceneUrls& urls);

}  // namespace posefusion
