// `posefusion evaluate`, and time stamps from the recording to the trajectory. The numbers:
// ../evaluate/reference_test.py.
#include <nlohmann/json.hpp>
#include <sstream>

#include "hosts/io/image_file.hpp"
#include "tests/hosts/cli/cli_fixture.hpp"

namespace posefusion::test {
namespace {

namespace fs = std::filesystem;

class Evaluate : public Cli {
protected:
    [[nodiscard]] Result evaluate(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), "evaluate");
        return execute(program(arguments));
    }
    std::string truth = (recording() / "groundtruth.txt").string();
};

TEST_F(Evaluate, SaysWhatTheFilesWereTakenFor) {
    const std::string kitti =
        temp_.write("k.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 1 0 0 1 0\n").string();
    const Result table = evaluate({truth, truth});
    EXPECT_EQ(table.exit_code, 0) << table.err;
    EXPECT_TRUE(table.out.starts_with("ground truth  TUM, stamps in s, 12 poses\nestimate      TUM, stamps in s, 12"))
        << table.out;
    const Result unstamped = evaluate({kitti, kitti, "--scale"});
    EXPECT_NE(unstamped.out.find("KITTI, without stamps, 3 poses\nscale         1.000000\n"), std::string::npos)
        << unstamped.out;
    EXPECT_NE(unstamped.out.find("RPE: consecutive pairs of poses 1 frame apart\n"), std::string::npos);
    const auto json = nlohmann::json::parse(evaluate({truth, truth, "--json"}).out);
    EXPECT_EQ(json["groundtruth"]["format"], "TUM");
    EXPECT_EQ(json["estimate"]["time_unit"], "s");
}

TEST_F(Evaluate, WarnsOfWhatItMended) {
    const std::string odd = temp_.write("odd.txt", read_all(truth) + read_all(truth)).string();
    const Result result = evaluate({truth, odd});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_NE(result.err.find("posefusion: warning: " + odd + ": time stamps are not in order"), std::string::npos)
        << result.err;
    EXPECT_NE(result.err.find("12 of its time stamps were there before"), std::string::npos) << result.err;
}

TEST_F(Evaluate, DrawsThePaths) {
    const fs::path picture = temp_ / "plot.png";
    ASSERT_EQ(evaluate({truth, truth, "--plot", picture.string()}).exit_code, 0);
    const ColorImage image = read_color(picture, {3 * 640, 480});
    const auto colored = std::count_if(image.begin(), image.end(), [](Rgb8 c) { return c.b > c.r + 50; });
    EXPECT_GT(colored, 100) << "the line of the estimate";
    expect_error(evaluate({truth, truth, "--plot", "plot.jpg"}), {"--plot", "plot.jpg", ".png"}, 2);
}

TEST_F(Evaluate, RefusesWhatMakesNoSense) {
    const std::string kitti = temp_.write("k.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n").string();
    expect_error(evaluate({truth, truth, "--align", "best"}), {"--align", "'best'", "rigid | origin | none"}, 2);
    EXPECT_EQ(evaluate({truth, truth, "--time-unit", "hours"}).exit_code, 2);
    expect_error(evaluate({truth, truth, "--time-offset", "late"}), {"--time-offset", "'late'"}, 2);
    expect_error(evaluate({truth, truth, "--delta", "0"}), {"--delta"}, 2);
    expect_error(evaluate({truth, truth, "--max-difference", "nan"}), {"--max-difference", "is no time"}, 2);
    expect_error(evaluate({kitti, kitti, "--delta-unit", "s"}), {"no time stamps", "--delta-unit frames"});
    expect_error(evaluate({kitti, kitti, "--time-offset", "1"}), {"no time stamps"});
    expect_error(evaluate({truth, kitti}), {"k.txt", "equally many poses"});
    expect_error(evaluate({truth, temp_.write("t.txt", "1 2 3\n").string()}), {"t.txt, line 1", "3 numbers"});
}

/// Lists in nanoseconds, with three digits more than a double of seconds can hold.
TEST_F(Evaluate, ARunKeepsTheDigitsOfTheStamps) {
    const fs::path copy = copy_of_recording();
    fs::remove(copy / "associations.txt");
    fs::remove(copy / "groundtruth.txt");
    std::vector<std::string> expected;
    for (const char* name : {"rgb.txt", "depth.txt"}) {
        std::istringstream list(read_all(copy / name));
        std::string lines;
        for (std::string stamp, file, line; std::getline(list, line);) {
            if (line.starts_with('#')) continue;
            std::istringstream(line) >> stamp >> file;
            const std::size_t point = stamp.find('.');
            lines += stamp.substr(0, point) + stamp.substr(point + 1) + "584 " + file + "\n";
            if (name[0] == 'r') expected.push_back(stamp + "584");
        }
        std::ofstream(copy / name) << lines;
    }
    const Result result = execute(run_of(copy, {"--no-people", "--real-time"}));  // at the pace of nanoseconds
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.err.find("rgb.txt: time stamps are taken as ns"), std::string::npos) << result.err;
    ASSERT_EQ(execute(run_of(copy)).exit_code, 0);
    std::istringstream poses(read_all(out() / "trajectory.txt"));
    std::vector<std::string> found;
    for (std::string line; std::getline(poses, line);)
        if (!line.starts_with('#')) found.push_back(line.substr(0, line.find(' ')));
    EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace posefusion::test
