// The whole program on a short recording of a room with a person in it.
#include <algorithm>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <thread>

#include "engine/core/median.hpp"
#include "engine/core/pinhole.hpp"
#include "hosts/evaluate/evaluation.hpp"
#include "hosts/io/camera_file.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/io/ply.hpp"
#include "hosts/io/recording.hpp"
#include "hosts/io/trajectory.hpp"
#include "pose/joints.hpp"
#include "tests/hosts/cli/cli_fixture.hpp"

namespace posefusion::test {
namespace {

namespace fs = std::filesystem;

class Run : public Cli {
protected:
    nlohmann::json stats() const { return nlohmann::json::parse(read_all(out() / "stats.json")); }

    /// Runs and returns the bytes of trajectory and map.
    std::pair<std::string, std::string> results_of(const Program& program) {
        const Result result = execute(program);
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return {read_all(out() / "trajectory.txt"), read_all(out() / "map.ply")};
    }
};

TEST_F(Run, WritesEverythingAndIsAccurate) {
    const Result result =
        execute(program({"run", recording().string(), "--out", out().string(), "--save-masks", "--all-surfels"}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find("ATE"), std::string::npos) << result.out;

    const Trajectory trajectory = read_trajectory(out() / "trajectory.txt");
    ASSERT_EQ(trajectory.size(), static_cast<std::size_t>(kFrames));
    EXPECT_TRUE(trajectory.front().T_world_camera.isApprox(Eigen::Isometry3d::Identity()));
    const Evaluation evaluation = evaluate(read_trajectory(recording() / "groundtruth.txt"), trajectory);
    EXPECT_LT(evaluation.ate.translation.rmse, 0.02) << "metres, at 160 x 120";

    EXPECT_GT(read_ply(out() / "map.ply").size(), 5000u);
    for (const auto& entry : fs::directory_iterator(recording() / "rgb")) {
        EXPECT_TRUE(fs::exists(out() / "masks" / (entry.path().stem().string() + ".png")));
    }

    const nlohmann::json json = stats();
    EXPECT_EQ(json["status"], "finished");
    EXPECT_EQ(json["frames"].size(), static_cast<std::size_t>(kFrames));
    EXPECT_EQ(json["configuration"]["save_masks"], true);
    EXPECT_EQ(json["configuration"]["tracking"]["iterations"].size(), 3u);
    EXPECT_FALSE(json["device"]["name"].get<std::string>().empty());
    EXPECT_GT(json["summary"]["peak_memory_bytes"], 10'000'000);
    EXPECT_GT(json["summary"]["device_bytes"], 0);
    EXPECT_NEAR(json["evaluation"]["ate"]["translation_m"]["rmse"].get<double>(), evaluation.ate.translation.rmse,
                1e-6);
    for (const char* stage : {"read", "joints", "segmentation"}) {
        EXPECT_EQ(json["stages"]["host"][stage]["frames"], kFrames) << stage;
    }
    EXPECT_GE(json["stages"]["host"]["slam"]["frames"], kFrames - 2) << "all but those that compiled shaders";
    EXPECT_GE(json["stages"]["gpu"].size(), 3u);
    for (const auto& [name, stage] : json["stages"]["gpu"].items()) {
        EXPECT_GT(stage["median_ms"], 0) << name;
        EXPECT_LE(stage["median_ms"], stage["p95_ms"]) << name;
    }
    EXPECT_GT(json["frames"][5]["icp_inliers"], 1000);
    EXPECT_EQ(json["frames"][0]["tracking"], "first");
    EXPECT_EQ(json["frames"][5]["tracking"], "ok");
}

TEST_F(Run, ADoorThatSwingsHasATrajectoryAModelAndAPlaceInTheReport) {
    const std::string moving = (temp_ / "moving").string();
    ASSERT_EQ(execute(program({"synth", "--out", moving, "--scenario", "movers", "--seed", "3", "--people", "0",
                               "--no-noise", "--frames", "32", "--width", "160", "--height", "120"}))
                  .exit_code,
              0);
    const auto run = [&](const char* option) {
        const Result result = execute(program({"run", moving, "--out", out().string(), "--no-people", option}));
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return read_all(out() / "report.html");
    };
    const std::string report = run("--objects");
    const auto objects = stats()["objects"];
    ASSERT_FALSE(objects.empty());
    for (const auto& object : objects) {
        const std::string label = object["label"].dump();
        const std::size_t frames = read_trajectory(out() / "objects" / label / "trajectory.txt").size(),
                          surfels = read_ply(out() / "objects" / label / "map.ply").size();
        EXPECT_EQ(frames, object["frames"]);
        EXPECT_GT(surfels, 100u);
        EXPECT_NE(report.find("</i>" + label + "</td><td class=\"number\">" + std::to_string(frames) + "<"),
                  std::string::npos);
        EXPECT_NE(report.find(">" + std::to_string(surfels) + "</td></tr>"), std::string::npos);
    }
    EXPECT_EQ(run("--no-motion").find("<h2>Objects"), std::string::npos);
}

TEST_F(Run, TellsWhereThePersonWas) {
    const Result result = execute(run_of(recording(), {"--save-masks"}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto people = nlohmann::json::parse(read_all(out() / "people.json"))["people"];
    ASSERT_EQ(people.size(), 1u);
    const auto& frames = people[0]["frames"];
    EXPECT_GT(frames.size(), static_cast<std::size_t>(kFrames) / 2);

    const Trajectory trajectory = read_trajectory(out() / "trajectory.txt");
    const Intrinsics camera = read_camera_file(recording() / "camera.yaml").intrinsics;
    const auto truth = nlohmann::json::parse(read_all(recording() / "joints.json"))["frames"];
    std::vector<double> errors;
    for (const auto& frame : frames) {
        const auto at = frame["frame"].get<std::size_t>();
        EXPECT_NEAR(frame["timestamp"].get<double>(), to_seconds(trajectory.at(at).stamp), 1e-6);
        for (int j = 0; j < kJointCount; ++j) {
            const auto& joint = frame["joints"][j];
            const auto& uvz = truth[at]["persons"][0]["joints"][j];
            if (joint.is_null() || uvz[3] != 2) continue;
            const Eigen::Vector3d in_world(joint[0], joint[1], joint[2]);
            const Eigen::Vector3d expected =
                back_project(uvz[0].get<float>(), uvz[1].get<float>(), uvz[2].get<float>(), camera).cast<double>();
            errors.push_back((trajectory.at(at).T_world_camera.inverse() * in_world - expected).norm());
        }
    }
    ASSERT_GT(errors.size(), 30u);
    EXPECT_LT(upper_median(errors), 0.15) << "metres, at 160 x 120";
    const LabelImage mask =
        read_labels(out() / "masks" / (truth[kFrames - 1]["rgb"].get<std::string>() + ".png"), {kWidth, kHeight});
    EXPECT_GT(std::count(mask.begin(), mask.end(), people[0]["id"].get<int>()), 500) << "pixels";

    ASSERT_EQ(execute(run_of(recording(), {"--no-people", "--max-frames", "2"})).exit_code, 0);
    EXPECT_FALSE(fs::exists(out() / "people.json")) << "of the earlier run";
}

TEST_F(Run, TheBackgroundIsARecordingOfTheRoomWithoutThePerson) {
    const Result result = execute(run_of(recording(), {"--masks", (recording() / "masks").string(), "--save-background",
                                                       "--map-stable-confidence", "3"}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Recording background(out() / "background"), original(recording());
    ASSERT_EQ(background.size(), static_cast<std::size_t>(kFrames));
    ASSERT_TRUE(background.groundtruth());
    const Frame shown = background.load(kFrames - 1), seen = original.load(kFrames - 1);
    EXPECT_EQ(shown.stamp, seen.stamp);
    const std::string image = seen.stamp_text + ".png";
    const LabelImage people = read_labels(recording() / "masks" / image, {kWidth, kHeight}),
                     holes = read_labels(out() / "background" / "holes" / image, {kWidth, kHeight});
    std::vector<float> errors;
    std::size_t of_person = 0;
    for (std::size_t i = 0; i < holes.size(); ++i) {
        ASSERT_EQ(holes[i], shown.depth[i] > 0 ? 0 : 255);
        if (shown.depth[i] <= 0 || seen.depth[i] <= 0) continue;
        if (people[i] == 0) errors.push_back(std::abs(shown.depth[i] - seen.depth[i]));
        if (people[i] != 0 && shown.depth[i] < seen.depth[i] + 0.1f) ++of_person;
    }
    ASSERT_GT(errors.size(), holes.size() / 3) << "most of the room is there";
    EXPECT_LT(upper_median(errors), 0.03f) << "metres";
    EXPECT_LT(of_person, holes.size() / 100) << "pixels at the depth of the person";
}

TEST_F(Run, PipelinedSequentialAndAnyNumberOfThreadsGiveTheSameBytes) {
    Program run = run_of(recording(), {"--pose-every", "2"});  // people handling on, with masks carried between
    run.environment = {{"LP_NUM_THREADS", "2"}};
    const auto first = results_of(run);
    EXPECT_FALSE(first.first.empty());
    EXPECT_FALSE(first.second.empty());
    EXPECT_EQ(results_of(run), first) << "a second run";
    run.environment = {{"LP_NUM_THREADS", "1"}};
    run.arguments.push_back("--sequential");
    EXPECT_EQ(results_of(run), first) << "sequential, one thread";
}

TEST_F(Run, TheWrittenConfigurationRepeatsTheRun) {
    const auto first =
        results_of(run_of(recording(), {"--no-people", "--tracking-iterations", "5,4,3", "--scale", "0.5"}));
    const fs::path config = temp_ / "again.yaml";
    fs::copy_file(out() / "config.yaml", config);
    EXPECT_EQ(results_of(program({"run", recording().string(), "--config", config.string()})), first);
    EXPECT_EQ(stats()["configuration"]["tracking"]["iterations"], nlohmann::json({5, 4, 3}));
    EXPECT_EQ(stats()["recording"]["width"], kWidth / 2);
}

TEST_F(Run, TheCommandLineGoesBeforeTheFile) {
    const fs::path config = temp_.write("config.yaml", "max_frames: 9\ntracking.so3_iterations: 3\n");
    EXPECT_EQ(execute(run_of(recording(), {"--no-people", "--config", config.string(), "--max-frames", "4"})).exit_code,
              0);
    EXPECT_EQ(poses(), 4u);
    EXPECT_EQ(stats()["configuration"]["tracking"]["so3_iterations"], 3);
}

TEST_F(Run, GivenMasksAreUsedAndCanBeSavedUnchanged) {
    const Result result = execute(run_of(recording(), {"--masks", (recording() / "masks").string(), "--save-masks"}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    int with_people = 0;
    for (const auto& entry : fs::directory_iterator(recording() / "masks")) {
        const LabelImage given = read_labels(entry.path(), {kWidth, kHeight});
        const LabelImage saved = read_labels(out() / "masks" / entry.path().filename(), {kWidth, kHeight});
        EXPECT_TRUE(std::equal(given.begin(), given.end(), saved.begin(), saved.end())) << entry.path();
        with_people += std::any_of(given.begin(), given.end(), [](auto label) { return label != 0; }) ? 1 : 0;
    }
    EXPECT_EQ(stats()["summary"]["frames_with_people"], with_people);
    EXPECT_EQ(stats()["stages"]["host"]["joints"]["frames"], 0) << "the network ran all the same";
}

TEST_F(Run, TheNetworkRunsOnEveryNthFrameOnly) {
    ASSERT_EQ(execute(run_of(recording(), {"--pose-every", "5"})).exit_code, 0);
    EXPECT_EQ(stats()["stages"]["host"]["joints"]["frames"], (kFrames + 4) / 5);
    EXPECT_EQ(stats()["stages"]["host"]["segmentation"]["frames"], kFrames);
}

TEST_F(Run, RealTimeTakesAsLongAsTheRecordingAndCountsWhatItDrops) {
    ASSERT_EQ(execute(run_of(recording(), {"--no-people", "--real-time"})).exit_code, 0);
    const nlohmann::json json = stats();
    EXPECT_EQ(json["frames"].size() + json["summary"]["dropped_frames"].get<std::size_t>(), std::size_t{kFrames});
    const Trajectory trajectory = read_trajectory(out() / "trajectory.txt");
    EXPECT_GE(json["summary"]["wall_seconds"].get<double>(),
              to_seconds(trajectory.back().stamp - trajectory.front().stamp));

    // Faster than any machine: with all stamps in a hundredth of the time nearly everything is dropped.
    const fs::path recording = copy_of_recording();
    std::ifstream list(recording / "associations.txt");
    std::string fast;
    double first = 0;
    for (std::string stamp, color, depth_stamp, depth; list >> stamp >> color >> depth_stamp >> depth;) {
        if (fast.empty()) first = std::stod(stamp);
        const std::string faster = std::to_string(first + (std::stod(stamp) - first) / 100);
        fast += faster + " " + color + " " + faster + " " + depth + "\n";
    }
    list.close();
    std::ofstream(recording / "associations.txt") << fast;
    ASSERT_EQ(execute(run_of(recording, {"--no-people", "--real-time", "--sequential"})).exit_code, 0);
    EXPECT_GT(stats()["summary"]["dropped_frames"], kFrames / 2);
    ASSERT_EQ(execute(run_of(recording)).exit_code, 0);
    EXPECT_EQ(stats()["frames"].size(), std::size_t{kFrames})
        << "a recording that is not played in real time loses nothing";
    EXPECT_FALSE(stats()["summary"].contains("dropped_frames"));
}

class Interrupt : public Run, public testing::WithParamInterface<std::tuple<int, const char*>> {};
INSTANTIATE_TEST_SUITE_P(Signals, Interrupt,
                         testing::Combine(testing::Values(SIGINT, SIGTERM, SIGHUP),
                                          testing::Values("--no-people", "--sequential")));

TEST_P(Interrupt, SavesWhatThereIs) {
    const fs::path recording = long_recording();
    const auto [signal, option] = GetParam();
    Subprocess process(run_of(recording, {option, "--scale", "0.5"}), temp_.path());
    ASSERT_TRUE(process.wait_for("frame 20/10000")) << process.error_output();
    process.send(signal);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    process.send(signal);  // in haste: the same wish
    EXPECT_EQ(process.exit_code(), 130);
    EXPECT_GE(poses(), 20u);
    EXPECT_LT(poses(), 10000u);
    EXPECT_EQ(stats()["status"], "interrupted");
    EXPECT_EQ(stats()["frames"].size(), poses());
    EXPECT_TRUE(fs::exists(out() / "map.ply"));
}

TEST_F(Run, BenchPrintsTheTimePerStageAndWritesNothing) {
    const fs::path here = temp_ / "out";
    Program bench =
        program({"bench", recording().string(), "--out", here.string(), "--no-people", "--max-frames", "6"});
    const Result result = execute(bench);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find("GPU"), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("fuse"), std::string::npos) << result.out;
    EXPECT_FALSE(fs::exists(here));
}

TEST_F(Run, DevicesListsAUsableOne) {
    const Result result = execute(program({"devices"}));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find("usable"), std::string::npos) << result.out;
}

TEST_F(Run, SynthMakesTheScenarioAskedFor) {
    const std::vector<std::string> small{"synth",   "--out", out().string(), "--frames", "12",        "--static",
                                         "--width", "80",    "--height",     "60",       "--scenario"};
    const auto synth = [&](const char* scenario) {
        std::vector<std::string> arguments = small;
        arguments.emplace_back(scenario);
        return execute(program(arguments));
    };
    const Result made = synth("kidnap");
    EXPECT_EQ(made.exit_code, 0) << made.err;
    EXPECT_NE(read_all(out() / "events.json").find("\"kidnap\""), std::string::npos);
    const Result refused = synth("nonsense");
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_NE(refused.err.find("loop-people"), std::string::npos) << "the error names what there is: " << refused.err;
}

TEST_F(Run, EveryCommandHasHelp) {
    for (const char* command :
         {"run", "bench", "calibrate", "record", "export", "evaluate", "web", "synth", "devices"}) {
        const Result result = execute(program({command, "--help"}));
        EXPECT_EQ(result.exit_code, 0);
        EXPECT_NE(result.out.find("Usage: posefusion " + std::string(command)), std::string::npos) << result.out;
    }
    const std::string help = execute(program({"run", "--help"})).out;
    EXPECT_NE(help.find("--preprocess-depth-max"), std::string::npos) << help;
    EXPECT_NE(help.find("[default 5 m; 0.1 .. 100]"), std::string::npos) << help;
    EXPECT_EQ(help.find("--tracking-icp-max-distance"), std::string::npos) << "an advanced option: " << help;
    EXPECT_NE(help.find("--help-all"), std::string::npos) << help;
    const std::string all = execute(program({"run", "--help-all"})).out;
    EXPECT_NE(all.find("--tracking-icp-max-distance"), std::string::npos) << all;
    EXPECT_NE(all.find("[default 0.1 m; 0.001 .. 10]"), std::string::npos) << all;
}

TEST_F(Run, TheVersionSaysWhatThisBuildHas) {
    const Result result = execute(program({"--version"}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    std::smatch has;
    const std::regex lines(
        "posefusion [0-9.]+\nwith(out)? video: .*\nwith(out)? OpenNI2: .*\nwith(out)? viewer: posefusion view\n");
    ASSERT_TRUE(std::regex_match(result.out, has, lines)) << result.out;
    const std::string camera = execute(run_of("openni2:none")).err;
    EXPECT_EQ(camera.find("without OpenNI2") != std::string::npos, has[2].matched) << camera;
    EXPECT_EQ(execute(program({"view", "--help"})).exit_code != 0, has[3].matched);
}

// Several software drivers, that of the system and that of tools/setup: the newest is taken, and the list says so.
TEST_F(Run, DevicesSaysWhichWouldBeTakenAndWhy) {
    const Result result = execute(program({"devices"}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const std::size_t choice = result.out.find("Without --device: ");
    ASSERT_NE(choice, std::string::npos) << result.out;
    const std::regex mesa("Mesa ([0-9]+)");
    const auto versions = [&](const std::string& text) {
        std::vector<int> found;
        for (std::sregex_iterator match(text.begin(), text.end(), mesa), end; match != end; ++match)
            found.push_back(std::stoi((*match)[1]));
        return found;
    };
    const std::vector<int> all = versions(result.out.substr(0, choice)), chosen = versions(result.out.substr(choice));
    const bool software_only =
        result.out.find("integrated") == std::string::npos && result.out.find("discrete") == std::string::npos;
    if (all.empty() || !software_only) GTEST_SKIP() << "needs Mesa's software driver and no GPU";
    ASSERT_EQ(chosen.size(), 1u) << result.out;
    EXPECT_EQ(chosen[0], *std::max_element(all.begin(), all.end())) << result.out;
}

}  // namespace
}  // namespace posefusion::test
