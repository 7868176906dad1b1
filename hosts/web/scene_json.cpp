#include "hosts/web/scene_json.hpp"

#include <vector>

#include "hosts/web/json_parts.hpp"

namespace posefusion {
namespace {

WebJson map_json(const std::vector<Surfel>& surfels, const EncodedMap& map, const SceneUrls& urls) {
    WebJson json = map_facts_json(surfels);
    json["coding"] = coding_json(map.coding);
    json["pieces"] = WebJson::array();
    for (std::size_t i = 0; i < map.pieces.size(); ++i)
        json["pieces"].push_back({{"surfels", map.pieces[i].surfels}, {"url", urls.piece(i)}});
    return json;
}

WebJson keyframes_json(const std::vector<SceneKeyframe>& keyframes, const SceneUrls& urls) {
    WebJson list = WebJson::array();
    for (std::size_t i = 0; i < keyframes.size(); ++i)
        list.push_back(
            {{"pose", keyframes[i].pose}, {"image", keyframes[i].jpeg.empty() ? WebJson() : WebJson(urls.image(i))}});
    return list;
}

}  // namespace

std::string scene_json(const WebScene& scene, const EncodedMap& map, const SceneUrls& urls) {
    WebJson json;
    json["title"] = scene.title;
    json["facts"] = WebJson::array();
    for (const auto& [name, value] : scene.facts) json["facts"].push_back({name, value});
    json["map"] = map_json(scene.surfels, map, urls);
    json["poses"] = poses_json(scene.poses);
    json["keyframes"] = keyframes_json(scene.keyframes, urls);
    json["camera"] = camera_json(scene.camera);
    json["skeletons"] = people_json(scene.people);
    return json.dump(-1, ' ', true, WebJson::error_handler_t::replace);
}

}  // namespace posefusion
