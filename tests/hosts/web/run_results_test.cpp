#include "hosts/web/run_results.hpp"

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "hosts/web/scene.hpp"
#include "tests/hosts/support/temp_folder.hpp"
#include "tests/hosts/web/random_map.hpp"

/// What the page knows about a run.
namespace posefusion::test {
namespace {

class RunResultsTest : public ::testing::Test {
protected:
    /// Five frames, of which number 2 has no pose; 0 and 3 became keyframes.
    void write_run() const {
        temp_.write("trajectory.txt",
                    "10.0 0 0 0 0 0 0 1\n10.1 0.1 0 0 0 0 0 1\n10.3 0.1 0 0.3 0 0 0 1\n10.4 0.1 0 0.4 0 0 0 1\n");
        temp_.write("stats.json", R"({"status": "finished", "recording": {"folder": "/data/kitchen/", "width": 64,
            "height": 48, "fx": 50, "fy": 51, "cx": 31.5, "cy": 23.5},
            "summary": {"loops_closed": 2, "frames_with_people": 0},
            "evaluation": {"ate": {"translation_m": {"rmse": 0.0123}}},
            "frames": [{"stamp": 10.0, "keyframes": 1}, {"stamp": 10.1, "keyframes": 1}, {"stamp": 10.2,
            "keyframes": 1}, {"stamp": 10.3, "keyframes": 2}, {"stamp": 10.4, "keyframes": 2}]})");
    }
    [[nodiscard]] std::string fault() const {
        return message_of<Error>([&] { (void)read_run_results(temp_.path()); });
    }
    TempFolder temp_;
};

TEST_F(RunResultsTest, PosesHaveTheirFrames) {
    write_run();
    const RunResults results = read_run_results(temp_.path());
    EXPECT_EQ(results.frames, (std::vector<std::size_t>{0, 1, 3, 4}));
    EXPECT_EQ(results.keyframes, (std::vector<std::size_t>{0, 2}));
    EXPECT_EQ(results.frames_of_run, 5u);
    ASSERT_TRUE(results.camera);
    EXPECT_EQ(results.camera->width, 64);
    EXPECT_FLOAT_EQ(results.camera->fy, 51);
}

TEST_F(RunResultsTest, FactsAreThoseOfTheRun) {
    write_run();
    const auto facts = read_run_results(temp_.path()).facts;
    const auto has = [&](const char* name, const char* value) {
        return std::find(facts.begin(), facts.end(), std::pair<std::string, std::string>(name, value)) != facts.end();
    };
    EXPECT_TRUE(has("Duration", "0.4 s"));
    EXPECT_TRUE(has("Frames", "5"));
    EXPECT_TRUE(has("Without tracking", "1"));
    EXPECT_TRUE(has("Camera path", "0.50 m"));
    EXPECT_TRUE(has("Loops closed", "2"));
    EXPECT_TRUE(has("ATE RMSE", "1.23 cm"));
    EXPECT_FALSE(has("Frames with people", "0"));
}

TEST_F(RunResultsTest, ATrajectoryAloneWillDo) {
    write_run();
    std::filesystem::remove(temp_ / "stats.json");
    const RunResults results = read_run_results(temp_.path());
    EXPECT_EQ(results.frames, (std::vector<std::size_t>{0, 1, 2, 3}));
    EXPECT_TRUE(results.keyframes.empty());
    EXPECT_FALSE(results.camera);
}

TEST_F(RunResultsTest, PeopleAreShownAtTheirPoses) {
    write_run();
    const std::string rest = [] {
        std::string joints;
        for (int i = 2; i < kJointCount; ++i) joints += ", null";
        return joints + "]}";
    }();
    temp_.write("people.json", R"({"format": "posefusion people", "version": 1, "joints": [], "people": [{"id": 7,
        "frames": [{"frame": 1, "timestamp": 10.1, "joints": [[0.1, 0.2, 0.3, 0.9], null)" +
                                   rest + R"(, {"frame": 3, "timestamp": 10.3, "joints": [null, [1, 2, 3, 0.5])" +
                                   rest + R"(, {"frame": 9, "timestamp": 12, "joints": [null, [1, 2, 3, 0.5])" + rest +
                                   "]}]}");
    const RunResults results = read_run_results(temp_.path());
    ASSERT_EQ(results.people.size(), 1u);
    EXPECT_EQ(results.people[0].id, 7);
    const WebScene scene = make_scene("kitchen", random_map(100), &results);
    const auto& skeletons = scene.people.at(0).skeletons;
    ASSERT_EQ(skeletons.size(), 2u) << "one frame has no pose";
    EXPECT_EQ(skeletons[0].pose, 1u);
    EXPECT_EQ(skeletons[1].pose, 2u);
    ASSERT_TRUE(skeletons[0].joints[Nose]);
    EXPECT_FALSE(skeletons[0].joints[Neck]);
    const Eigen::Isometry3d T_page_world =
        scene.poses[0].T_page_camera * results.trajectory[0].T_world_camera.inverse();
    EXPECT_TRUE(skeletons[0].joints[Nose]->isApprox(T_page_world * Eigen::Vector3d(0.1, 0.2, 0.3), 1e-9));
}

TEST_F(RunResultsTest, FilesThatNoRunWroteAreNamed) {
    write_run();
    for (const char* damaged : {"", "{", "[]", "{\"frames\": 3}", "{\"frames\": [{}], \"recording\": {}}",
                                "{\"frames\": [], \"recording\": 1}"}) {
        temp_.write("stats.json", damaged);
        EXPECT_NE(fault().find("stats.json"), std::string::npos) << damaged;
    }
    temp_.write("stats.json", R"({"recording": {}, "frames": [{"stamp": 99}]})");
    for (const char* damaged : {"", "[]", R"({"format": "posefusion people", "version": 2, "people": []})",
                                R"({"format": "posefusion people", "version": 1, "people": [{"id": 1, "frames": [
                                    {"timestamp": 1, "joints": []}]}]})"}) {
        temp_.write("people.json", damaged);
        EXPECT_NE(fault().find("people.json"), std::string::npos) << damaged;
    }
    std::filesystem::remove(temp_ / "people.json");
    EXPECT_NE(fault().find("another run"), std::string::npos) << fault();
    std::filesystem::remove(temp_ / "trajectory.txt");
    EXPECT_NE(fault().find("trajectory.txt"), std::string::npos);
}

TEST_F(RunResultsTest, FramesOfALoadedMapComeBefore) {
    write_run();
    const RunResults results = read_run_results(temp_.path());
    std::vector<Surfel> map = random_map(100);
    for (Surfel& s : map) s.last_seen = 4;
    EXPECT_EQ(make_scene("a", map, &results).poses.back().frame, 4u);
    map.front().last_seen = 104;  // seen in the last of the five frames
    EXPECT_EQ(make_scene("a", map, &results).poses.back().frame, 104u);
}

TEST_F(RunResultsTest, ThePageHasItsFloorBelow) {
    write_run();
    const RunResults results = read_run_results(temp_.path());
    std::vector<Surfel> map = random_map(1000);
    for (Surfel& s : map) s.normal = -Eigen::Vector3f::UnitY();  // of a floor, in a world with y down
    const WebScene scene = make_scene("a", map, &results);
    for (std::size_t i = 0; i < map.size(); ++i) {
        ASSERT_LT((scene.surfels[i].normal - Eigen::Vector3f::UnitY()).norm(), 1e-3f);
        const Eigen::Vector3f expected(map[i].position.x(), -map[i].position.y(), -map[i].position.z());
        ASSERT_LT((scene.surfels[i].position - expected).norm(), 1e-3f);
    }
    EXPECT_LT((scene.poses.back().T_page_camera.translation() - Eigen::Vector3d(0.1, 0, -0.4)).norm(), 1e-6);
}

}  // namespace
}  // namespace posefusion::test
