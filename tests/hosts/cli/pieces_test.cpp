// A camera that is carried, covered, to another room: the map is in pieces.
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "hosts/io/ply.hpp"
#include "hosts/io/trajectory.hpp"
#include "tests/hosts/cli/cli_fixture.hpp"

namespace posefusion::test {
namespace {

namespace fs = std::filesystem;

constexpr int kInFirst = 34, kInSecond = 24, kBackInFirst = 12;  // frames in the rooms

class Pieces : public Cli {
protected:
    void SetUp() override {
        const Result synth = execute(
            program({"synth", "--out", (temp_ / "room2").string(), "--frames", std::to_string(kFrames), "--people", "0",
                     "--seed", "7", "--width", std::to_string(kWidth), "--height", std::to_string(kHeight)}));
        ASSERT_EQ(synth.exit_code, 0) << synth.err;
        recording_ = copy_of_recording();
        fs::remove(recording_ / "groundtruth.txt");  // of other stamps
        fs::rename(temp_ / "room2", recording_ / "room2");
        const std::vector<Images> first = images("."), second = images("room2");
        std::ofstream list(recording_ / "associations.txt");
        int frame = 0;
        const auto walk = [&](const std::vector<Images>& room, int frames) {  // to and fro
            const int last = kFrames - 1;
            for (int i = 0; i < frames; ++i, ++frame) {
                const int phase = i % (2 * last);
                const Images& at = room[static_cast<std::size_t>(phase <= last ? phase : 2 * last - phase)];
                const std::string stamp = std::to_string(2000 + frame / 30.0);
                list << stamp << ' ' << at.color << ' ' << stamp << ' ' << at.depth << '\n';
            }
        };
        walk(first, kInFirst);
        walk(second, kInSecond);
        walk(first, kBackInFirst);
    }

    struct Images {
        std::string color, depth;
    };
    [[nodiscard]] std::vector<Images> images(const std::string& room) const {
        std::ifstream list(recording_ / room / "associations.txt");
        std::vector<Images> images;
        for (std::string stamp, color, depth; list >> stamp >> color >> stamp >> depth;)
            images.push_back({room + "/" + color, room + "/" + depth});
        EXPECT_EQ(images.size(), static_cast<std::size_t>(kFrames));
        return images;
    }

    [[nodiscard]] Result run(const std::vector<std::string>& more = {}) const {
        std::vector<std::string> options{"--no-people", "--relocalisation-lost-after", "2", "--pieces-begin-after",
                                         "5"};
        options.insert(options.end(), more.begin(), more.end());
        return execute(run_of(recording_, options));
    }
    [[nodiscard]] nlohmann::json stats() const { return nlohmann::json::parse(read_all(out() / "stats.json")); }

    fs::path recording_;
};

TEST_F(Pieces, EachIsWrittenAndTheLargestIsTheMap) {
    const Result result = run();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.err.find("warning: the camera is lost and sees what is not in the map; a new piece"),
              std::string::npos)
        << result.err;
    EXPECT_NE(result.err.find("the camera was found in an earlier piece of map"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("warning: the map is in 2 pieces that never met"), std::string::npos) << result.err;
    EXPECT_NE(result.out.find(" trajectory-2.txt map-2.ply"), std::string::npos) << result.out;

    const nlohmann::json pieces = stats()["pieces"];
    ASSERT_EQ(pieces.size(), 2u);
    EXPECT_EQ(pieces[0]["first_frame"], 0);
    EXPECT_EQ(pieces[0]["last_frame"], kInFirst + kInSecond + kBackInFirst - 1);
    EXPECT_GE(pieces[1]["first_frame"], kInFirst);
    EXPECT_LT(pieces[1]["last_frame"], kInFirst + kInSecond + 5);
    EXPECT_GE(stats()["warnings"].size(), 2u);

    const Trajectory first = read_trajectory(out() / "trajectory.txt"),
                     second = read_trajectory(out() / "trajectory-2.txt");
    EXPECT_EQ(first.size(), pieces[0]["tracked"]);
    EXPECT_EQ(second.size(), pieces[1]["tracked"]);
    EXPECT_GE(first.size(), static_cast<std::size_t>(kInFirst + kBackInFirst - 5));
    EXPECT_GE(second.size(), static_cast<std::size_t>(kInSecond - 6));
    for (const StampedPose& pose : second) {
        EXPECT_FALSE(std::any_of(first.begin(), first.end(), [&](const auto& p) { return p.stamp == pose.stamp; }))
            << "a frame is in one piece";
    }
    for (const Trajectory& piece : {first, second}) {
        for (const StampedPose& pose : piece)
            EXPECT_LT(pose.T_world_camera.translation().norm(), 0.5) << "a jump between rooms is no motion";
    }
    EXPECT_GT(read_ply(out() / "map-2.ply").size(), 100u);
}

TEST_F(Pieces, AResumedRunHasThemToo) {
    ASSERT_EQ(run().exit_code, 0);
    std::vector<std::string> whole;
    const std::vector<std::string> files{"trajectory.txt", "map.ply", "trajectory-2.txt", "map-2.ply"};
    for (const std::string& file : files) whole.push_back(read_all(out() / file));
    fs::remove_all(out());
    const std::string done = std::to_string(kInFirst + kInSecond - 2);  // in the second room
    (void)run({"--checkpoint-every", done, "--max-frames", done});
    const Result rest = run({"--checkpoint-every", done, "--resume"});
    EXPECT_EQ(rest.exit_code, 0) << rest.err;
    for (std::size_t i = 0; i < files.size(); ++i) EXPECT_EQ(read_all(out() / files[i]), whole[i]) << files[i];
}

TEST_F(Pieces, AShorterRunLeavesNoneOfAnEarlierOne) {
    ASSERT_EQ(run().exit_code, 0);
    ASSERT_TRUE(fs::exists(out() / "map-2.ply"));
    ASSERT_EQ(run({"--max-frames", "20"}).exit_code, 0);
    EXPECT_FALSE(fs::exists(out() / "map-2.ply"));
    EXPECT_FALSE(fs::exists(out() / "trajectory-2.txt"));
    EXPECT_EQ(stats()["pieces"].size(), 1u);
}

}  // namespace
}  // namespace posefusion::test
