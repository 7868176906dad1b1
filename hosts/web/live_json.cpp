#include "hosts/web/live_json.hpp"

#include <algorithm>

#include "hosts/web/json_parts.hpp"

namespace posefusion {
namespace {

std::string text(const WebJson& json) { return json.dump(-1, ' ', true, WebJson::error_handler_t::replace); }

}  // namespace

std::string live_scene_json(const std::string& title, const Intrinsics& camera, const MapCoding& coding,
                            const std::string& url) {
    WebJson json;
    json["title"] = title;
    json["facts"] = WebJson::array();
    json["map"] = map_facts_json({});
    json["map"]["coding"] = coding_json(coding);
    json["map"]["pieces"] = WebJson::array();
    json["poses"] = poses_json({});
    json["keyframes"] = WebJson::array();
    json["camera"] = camera_json(camera);
    json["skeletons"] = people_json({});
    json["live"] = url;
    return text(json);
}

std::string live_path_json(const WebScene& scene, std::size_t first, std::size_t count) {
    std::vector<ScenePerson> people;
    for (const ScenePerson& person : scene.people) {
        ScenePerson here{person.id, {}};
        for (const SceneSkeleton& skeleton : person.skeletons)
            if (skeleton.pose >= first && skeleton.pose < first + count) here.skeletons.push_back(skeleton);
        if (!here.skeletons.empty()) people.push_back(std::move(here));
    }
    return text({{"poses", poses_json(std::span(scene.poses).subspan(first, count))},
                 {"people", people_json(people).at("people")}});
}

std::string live_state_json(const LiveState& state, const WebScene& scene, const std::vector<Surfel>& surfels) {
    WebJson cells = WebJson::array(), keyframes = WebJson::array();
    for (const LiveMap::Cell& cell : state.cells) cells.push_back({cell.id, cell.version, cell.surfels});
    for (std::size_t i = 0; i < scene.keyframes.size(); ++i) {
        const std::optional<std::size_t> picture = state.pictures.at(i);
        keyframes.push_back({scene.keyframes[i].pose, picture ? WebJson(*picture) : WebJson()});
    }
    return text({{"status", state.status},
                 {"frames", state.frames},
                 {"frames_to_do", state.frames_to_do},
                 {"map", map_facts_json(surfels)},
                 {"cells", std::move(cells)},
                 {"path", state.path},
                 {"keyframes", std::move(keyframes)}});
}

}  // namespace posefusion
