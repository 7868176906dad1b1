#include "hosts/web/live_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/hosts/web/random_map.hpp"

/// What the page is told of a run that goes on.
namespace posefusion::test {
namespace {

using Json = nlohmann::json;

WebScene walk() {
    WebScene scene;
    for (std::size_t i = 0; i < 10; ++i) {
        ScenePose& pose = scene.poses.emplace_back();
        pose.frame = 20 + i;
        pose.seconds = 0.1 * static_cast<double>(i);
        pose.T_page_camera.translation().x() = static_cast<double>(i);
    }
    scene.keyframes = {{0, {}}, {7, {}}};
    ScenePerson& person = scene.people.emplace_back();
    person.id = 3;
    for (const std::size_t pose : {2u, 5u, 6u}) {
        SceneSkeleton& skeleton = person.skeletons.emplace_back();
        skeleton.pose = pose;
        skeleton.joints[Neck] = Eigen::Vector3d(0.001 * static_cast<double>(pose), 1, -2);
    }
    return scene;
}

TEST(LiveJson, ThePathComesInPartsWithThePeopleOnIt) {
    const Json part = Json::parse(live_path_json(walk(), 4, 3));
    EXPECT_EQ(part.at("poses").at("frame"), Json({24, 25, 26}));
    EXPECT_EQ(part.at("poses").at("position"), Json({4.0, 0.0, 0.0, 5.0, 0.0, 0.0, 6.0, 0.0, 0.0}));
    const Json& person = part.at("people").at(0);
    EXPECT_EQ(person.at("id"), 3);
    EXPECT_EQ(person.at("pose"), Json({5, 6})) << "positions on the whole path";
    EXPECT_EQ(person.at("joints")[0][3 * Neck], 5);
    EXPECT_TRUE(person.at("joints")[0][3 * Nose].is_null());
    EXPECT_EQ(person.at("colour").get<std::string>().size(), 7u);
    EXPECT_TRUE(Json::parse(live_path_json(walk(), 8, 2)).at("people").empty());
}

TEST(LiveJson, TheStateNamesTheNewestVersions) {
    const std::vector<Surfel> surfels = random_map(1000);
    LiveMap map;
    map.update(surfels, 300);
    LiveState state{"running", 30, 0, {4, 9}, map.cells(), {std::nullopt, 27}};
    const Json json = Json::parse(live_state_json(state, walk(), surfels));
    EXPECT_EQ(json.at("status"), "running");
    EXPECT_EQ(json.at("frames"), 30);
    EXPECT_EQ(json.at("path"), Json({4, 9}));
    EXPECT_EQ(json.at("keyframes"), Json({{0, nullptr}, {7, 27}}));
    EXPECT_EQ(json.at("map").at("surfels"), 1000);
    EXPECT_EQ(json.at("map").at("created"), Json({0, 299}));
    EXPECT_EQ(json.at("map").at("seen"), Json({280, 299}));
    ASSERT_EQ(json.at("cells").size(), map.cells().size());
    EXPECT_EQ(json.at("cells")[0], Json({map.cells()[0].id, map.cells()[0].version, map.cells()[0].surfels}));
}

TEST(LiveJson, TheSceneBeginsWithNothing) {
    const Json scene =
        Json::parse(live_scene_json("k</script>", {50, 51, 31, 23, 64, 48}, coding_of_unknown_map(), "u"));
    EXPECT_EQ(scene.at("live"), "u");
    EXPECT_EQ(scene.at("title"), "k</script>");
    EXPECT_EQ(scene.at("map").at("surfels"), 0);
    EXPECT_TRUE(scene.at("poses").at("frame").empty());
    EXPECT_EQ(scene.at("camera").at("fy"), 51);
    EXPECT_FALSE(scene.at("skeletons").at("limbs").empty());
}

}  // namespace
}  // namespace posefusion::test
