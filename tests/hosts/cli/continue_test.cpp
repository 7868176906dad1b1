// Runs that go on from an earlier one: after a kill, and in a map of another run.
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "hosts/io/map_file.hpp"
#include "hosts/io/trajectory.hpp"
#include "tests/hosts/cli/cli_fixture.hpp"

namespace posefusion::test {
namespace {

namespace fs = std::filesystem;

constexpr int kPasses = 4;  ///< of the recording, to and fro
constexpr int kLongFrames = kPasses * (12 - 1) + 1;

/// The recording forward, backward, forward ...: one walk, long enough for people to come and go and surfels to be
/// stable.
class Continue : public Cli {
protected:
    void SetUp() override {
        recording_ = copy_of_recording();
        std::ifstream list(recording_ / "associations.txt");
        std::vector<std::string> colors, depths;
        for (std::string stamp, color, depth; list >> stamp >> color >> stamp >> depth;) {
            colors.push_back(color);
            depths.push_back(depth);
        }
        list.close();
        ASSERT_EQ(colors.size(), static_cast<std::size_t>(kFrames));
        fs::remove(recording_ / "groundtruth.txt");  // of other stamps
        std::ofstream longer(recording_ / "associations.txt");
        const int last = kFrames - 1;
        for (int i = 0; i < kLongFrames; ++i) {
            const int phase = i % (2 * last);
            const auto at = static_cast<std::size_t>(phase <= last ? phase : 2 * last - phase);
            const std::string stamp = std::to_string(2000 + i / 30.0);
            longer << stamp << ' ' << colors[at] << ' ' << stamp << ' ' << depths[at] << '\n';
        }
    }

    [[nodiscard]] fs::path checkpoint() const { return out() / "checkpoint.bin"; }

    /// Starts the program, kills it when it has written a new checkpoint.
    void kill_after_a_checkpoint(const Program& program) const {
        std::error_code none;
        const auto before = fs::last_write_time(checkpoint(), none);
        Subprocess process(program, temp_.path());
        const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(120);
        while (!fs::exists(checkpoint()) || fs::last_write_time(checkpoint(), none) == before) {
            ASSERT_LT(std::chrono::steady_clock::now(), give_up) << process.error_output();
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        process.send(SIGKILL);
        ASSERT_EQ(process.exit_code(), 1000 + SIGKILL) << "it was faster than the kill; " << process.error_output();
        ASSERT_FALSE(fs::exists(out() / "trajectory.txt"));
    }

    [[nodiscard]] nlohmann::json stats() const { return nlohmann::json::parse(read_all(out() / "stats.json")); }

    fs::path recording_;
};

TEST_F(Continue, ARunThatWasKilledTwiceEndsWithTheSameBytes) {
    const std::vector<std::string> options{"--pose-every",       "3", "--loops-time-window", "15",
                                           "--checkpoint-every", "10"};
    std::vector<std::string> plain(options.begin(), options.end() - 2), resumed = options;
    resumed.emplace_back("--resume");

    ASSERT_EQ(execute(run_of(recording_, plain)).exit_code, 0);
    const std::string trajectory = read_all(out() / "trajectory.txt"), map = read_all(out() / "map.ply");
    ASSERT_EQ(poses(), static_cast<std::size_t>(kLongFrames));
    const nlohmann::json whole = stats();
    ASSERT_GT(whole["summary"]["frames_with_people"], kLongFrames / 3) << "the test needs people";
    fs::remove_all(out());

    kill_after_a_checkpoint(run_of(recording_, options));
    std::ofstream(checkpoint().string() + ".tmp-1") << "as if killed while writing";
    kill_after_a_checkpoint(run_of(recording_, resumed));
    const Result result = execute(run_of(recording_, resumed));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(read_all(out() / "trajectory.txt"), trajectory);
    EXPECT_EQ(read_all(out() / "map.ply"), map);
    EXPECT_FALSE(fs::exists(checkpoint().string() + ".tmp-1")) << "left lying about";

    const nlohmann::json json = stats();
    ASSERT_EQ(json["frames"].size(), whole["frames"].size());
    for (std::size_t i = 0; i < whole["frames"].size(); ++i) {
        for (const char* key :
             {"stamp", "index", "tracking", "people", "people_carried", "icp_inliers", "surfels", "keyframes"})
            EXPECT_EQ(json["frames"][i][key], whole["frames"][i][key]) << key << " of frame " << i;
    }
    EXPECT_EQ(json["loops"].size(), whole["loops"].size());
}

TEST_F(Continue, OnlyTheSameRunIsResumed) {
    const std::vector<std::string> options{"--no-people", "--max-frames", "4", "--checkpoint-every", "2"};
    const auto with = [&](std::vector<std::string> more) {
        std::vector<std::string> all = options;
        all.insert(all.end(), more.begin(), more.end());
        return all;
    };
    const Result fresh = execute(run_of(recording_, with({"--resume"})));  // killed before the first checkpoint
    ASSERT_EQ(fresh.exit_code, 0) << fresh.err;
    EXPECT_NE(fresh.err.find("checkpoint.bin: no checkpoint has been written yet"), std::string::npos) << fresh.err;
    EXPECT_EQ(poses(), 4u);

    expect_error(execute(run_of(recording_, with({"--real-time"}))), {"--real-time excludes"});
    expect_error(execute(run_of(recording_, with({"--resume", "--tracking-so3-iterations", "3"}))),
                 {"tracking.so3_iterations = '10', not '3'"});
    expect_error(execute(run_of(recording(), with({"--resume"}))),
                 {"another recording", recording_.filename().string()});

    const std::string content = read_all(checkpoint());
    std::ofstream(checkpoint(), std::ios::binary) << content.substr(0, content.size() / 2);
    expect_error(execute(run_of(recording_, with({"--resume"}))), {"cut short"});
    std::ofstream(checkpoint(), std::ios::binary) << "no checkpoint at all, but long enough";
    expect_error(execute(run_of(recording_, with({"--resume"}))), {"is no checkpoint"});

    std::ofstream(checkpoint(), std::ios::binary) << content;
    const std::vector<std::string> longer{"--no-people", "--max-frames", "6", "--resume"};
    ASSERT_EQ(execute(run_of(recording_, longer)).exit_code, 0) << "how far it goes may differ";
    EXPECT_EQ(poses(), 6u);

    std::ofstream(recording_ / "associations.txt", std::ios::app) << "3000 rgb/x.png 3000 depth/x.png\n";
    expect_error(execute(run_of(recording_, with({"--resume"}))), {"the frames of the recording have changed"});
}

TEST_F(Continue, LocalisesInASavedMapWithoutChangingIt) {
    const fs::path map = temp_ / "maps" / "room.pfmap", after = temp_ / "after.pfmap";
    ASSERT_EQ(execute(run_of(recording_, {"--no-people", "--save-map", map.string()})).exit_code, 0);
    const Trajectory mapped = read_trajectory(out() / "trajectory.txt");
    const std::string surfels = read_all(out() / "map.ply");
    const std::string file = read_all(map);

    const Result result = execute(run_of(recording_, {"--no-people", "--load-map", map.string(), "--localise-only",
                                                      "--max-frames", "12", "--save-map", after.string()}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(read_all(map), file);
    EXPECT_EQ(read_all(out() / "map.ply"), surfels);
    const SlamState was = read_map(map), is = read_map(after);
    EXPECT_EQ(is.map.counters, was.map.counters);
    EXPECT_EQ(is.map.position_confidence, was.map.position_confidence);
    EXPECT_EQ(is.map.normal_radius, was.map.normal_radius);
    EXPECT_EQ(is.map.appearance, was.map.appearance);
    EXPECT_EQ(is.back_end.keyframes.size(), was.back_end.keyframes.size());

    const Trajectory localised = read_trajectory(out() / "trajectory.txt");
    ASSERT_EQ(localised.size(), 11u) << "frames of this run only; the second one confirms where the first one was";
    EXPECT_EQ(localised.front().stamp, mapped[1].stamp);
    for (std::size_t i = 0; i < localised.size(); ++i) {
        const Eigen::Vector3d difference =
            localised[i].T_world_camera.translation() - mapped[i + 1].T_world_camera.translation();
        EXPECT_LT(difference.norm(), 0.02) << i;
    }
}

TEST_F(Continue, MapsOnInASavedMap) {
    const fs::path map = temp_ / "room.pfmap";
    ASSERT_EQ(execute(run_of(recording_, {"--no-people", "--save-map", map.string()})).exit_code, 0);
    const auto surfels = stats()["summary"]["surfels"].get<double>();
    ASSERT_EQ(execute(run_of(recording_, {"--no-people", "--load-map", map.string(), "--max-frames", "12"})).exit_code,
              0);
    EXPECT_EQ(poses(), 11u) << "all but the first one, which the second one confirms";
    const auto more = stats()["summary"]["surfels"].get<double>();
    EXPECT_LT(more, 1.15 * surfels) << "the same room was built beside itself";
    EXPECT_NE(more, surfels) << "nothing was fused";
}

TEST_F(Continue, ASavedMapIsExportedLikeThatOfItsRun) {
    const fs::path map = temp_ / "room.pfmap", cloud = temp_ / "cloud.ply", same = temp_ / "same.ply";
    const Result run = execute(run_of(recording_, {"--no-people", "--save-map", map.string()}));
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_NE(run.out.find("stats.json map.ply\nwritten to " + map.string() + "\n"), std::string::npos) << run.out;
    const Result result = execute(program({"export", map.string(), "--cloud", cloud.string()}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    ASSERT_EQ(execute(program({"export", out().string(), "--cloud", same.string()})).exit_code, 0);
    EXPECT_GT(read_all(cloud).size(), 10'000u);
    EXPECT_TRUE(read_all(cloud) == read_all(same));
}

TEST_F(Continue, MapsThatCannotBeUsedAreOneLine) {
    const std::string map = (temp_ / "room.pfmap").string();
    ASSERT_EQ(execute(run_of(recording_, {"--no-people", "--max-frames", "3", "--save-map", map})).exit_code, 0);
    expect_error(execute(run_of(recording_, {"--no-people", "--load-map", map, "--scale", "0.5"})),
                 {"another camera", "160x120", "80x60"});
    expect_error(execute(run_of(recording_, {"--no-people", "--load-map", map, "--loops-fern-seed", "5"})),
                 {"loops.fern_seed = 1"});
    expect_error(execute(run_of(recording_, {"--no-people", "--load-map", (temp_ / "none").string()})),
                 {"there is no such map file"});
    expect_error(execute(run_of(recording_, {"--no-people", "--load-map", (out() / "map.ply").string()})),
                 {"is no map file"});
    expect_error(execute(run_of(recording_, {"--no-people", "--localise-only"})), {"--load-map"});
    expect_error(execute(run_of(recording_, {"--no-people", "--save-map", "/proc/none/room.pfmap"})), {"/proc/none"});
}

}  // namespace
}  // namespace posefusion::test
