// The same frames give the same trajectory and the same map, to the byte, whatever format they come in.
#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "hosts/io/frame_source.hpp"
#include "tests/hosts/cli/cli_fixture.hpp"
#include "tests/hosts/io/sources/bag_writer.hpp"
#include "tests/hosts/io/sources/cdr_writer.hpp"
#include "tests/hosts/io/sources/db3_writer.hpp"
#include "tests/hosts/io/sources/mcap_writer.hpp"

namespace posefusion::test {
namespace {

namespace fs = std::filesystem;

class Sources : public Cli {
protected:
    /// trajectory.txt and map.ply of a run; masks from the recording, so that people are cut out.
    std::pair<std::string, std::string> results(const fs::path& source, const std::vector<std::string>& more = {}) {
        std::vector<std::string> arguments{"--masks", recording().string(), "--all-surfels"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Result result = execute(run_of(source, arguments));
        EXPECT_EQ(result.exit_code, 0) << result.err;
        EXPECT_EQ(poses(), static_cast<std::size_t>(kFrames));
        std::pair<std::string, std::string> found{read_all(out() / "trajectory.txt"), read_all(out() / "map.ply")};
        EXPECT_GT(found.second.size(), 100'000u) << "a map with surfels in it";
        return found;
    }
    /// The program of docs/raw_stream.md that feeds a folder into a pipe.
    [[nodiscard]] fs::path feed_program() const {
        const std::string page = read_all(POSEFUSION_DOCS "/raw_stream.md"), fence = "```python\n";
        const std::size_t begin = page.find(fence) + fence.size();
        return temp_.write("feed.py", page.substr(begin, page.find("```", begin) - begin));
    }
    Result record(const fs::path& from, const fs::path& to, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments{"record", from.string(), "--out", to.string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return execute(program(arguments));
    }
    /// The recording as a bag; the unit of its depth is told with --camera.
    fs::path bag() const {
        const auto source = open_source(recording());
        BagWriter bag("lz4");
        for (std::size_t i = 0; i < source->size(); ++i) {
            const RawFrame frame = source->read(i);
            const auto seconds = static_cast<std::uint32_t>(std::stoul(frame.stamp_text));
            const auto nanoseconds =
                static_cast<std::uint32_t>(std::stoul(frame.stamp_text.substr(frame.stamp_text.find('.') + 1)) * 1000);
            const auto add = [&](const char* topic, const char* encoding, const auto& image) {
                const std::string bytes(reinterpret_cast<const char*>(image.data()),
                                        image.size() * sizeof(*image.data()));
                bag.add(topic, "sensor_msgs/Image", seconds, nanoseconds,
                        BagWriter::image(seconds, nanoseconds, image.width(), image.height(), encoding, bytes));
            };
            add("/camera/rgb/image_color", "rgb8", frame.color);
            add("/camera/depth/image", "16UC1", frame.depth);
            bag.end_chunk();
        }
        return temp_.write("frames.bag", bag.finish());
    }
    /// The recording as messages of ROS 2.
    template <class Writer>
    void add_frames(Writer& bag) const {
        const auto source = open_source(recording());
        for (std::size_t i = 0; i < source->size(); ++i) {
            const RawFrame frame = source->read(i);
            const auto stamp = static_cast<std::uint64_t>(frame.stamp.count());
            const auto add = [&](const char* topic, const char* encoding, const auto& image) {
                const std::string bytes(reinterpret_cast<const char*>(image.data()),
                                        image.size() * sizeof(*image.data()));
                bag.add(topic, "sensor_msgs/msg/Image", stamp,
                        cdr_image({stamp, image.width(), image.height(), encoding, bytes}));
            };
            add("/camera/color/image_raw", "rgb8", frame.color);
            add("/camera/aligned_depth_to_color/image_raw", "16UC1", frame.depth);
        }
    }
};

TEST_F(Sources, OfAnyFormatGiveTheSameBytes) {
    const auto expected = results(recording());
    ASSERT_EQ(record(recording(), temp_ / "log.klg").exit_code, 0);
    ASSERT_EQ(record(recording(), temp_ / "raw.klg", {"--raw"}).exit_code, 0);
    ASSERT_EQ(record(temp_ / "log.klg", temp_ / "folder").exit_code, 0);
    for (const char* name : {"log.klg", "raw.klg", "folder"}) {
        const auto found = results(temp_ / name);
        EXPECT_EQ(found.first, expected.first) << "trajectory of " << name;
        EXPECT_TRUE(found.second == expected.second) << "map of " << name;
    }
    fs::remove(temp_ / "folder/associations.txt");
    fs::remove(temp_ / "folder/rgb.txt");
    fs::remove(temp_ / "folder/depth.txt");
    EXPECT_TRUE(results(temp_ / "folder") == expected) << "a folder without lists";
    const std::vector<std::string> camera{"--camera", (recording() / "camera.yaml").string()};
    EXPECT_TRUE(results(bag(), camera) == expected) << "a bag of ROS 1";
    McapWriter::Options packed;
    packed.packing = "zstd";
    McapWriter mcap(packed);
    add_frames(mcap);
    EXPECT_TRUE(results(temp_.write("frames.mcap", mcap.finish()), camera) == expected) << "a bag of ROS 2, MCAP";
    temp_.write("ros2/metadata.yaml", "rosbag2_bagfile_information:\n  relative_file_paths: [ros2_0.db3]\n");
    {
        Db3Writer db3(temp_ / "ros2/ros2_0.db3");
        add_frames(db3);
    }
    EXPECT_TRUE(results(temp_ / "ros2", camera) == expected) << "a bag of ROS 2, a folder";
    EXPECT_TRUE(results(temp_ / "ros2/ros2_0.db3", camera) == expected) << "a bag of ROS 2, its file";
}

TEST_F(Sources, RecordSaysWhatItDid) {
    const Result done = record(recording(), temp_ / "log.klg", {"--max-frames", "3", "--jpeg", "80"});
    EXPECT_EQ(done.exit_code, 0) << done.err;
    EXPECT_NE(done.out.find("log.klg: 3 frames of 160 x 120"), std::string::npos) << done.out;
    expect_error(record(temp_ / "nothing", temp_ / "x"), {"nothing", "not found"});
    expect_error(record(recording(), recording()), {"holds a recording already"});
    EXPECT_EQ(record(recording(), temp_ / "y.klg", {"--jpeg", "101"}).exit_code, 2);
}

/// With the camera that OpenNI2 brings along for tests: somebody has to tell it to stop.
TEST_F(Sources, ACameraIsRecordedAndTracked) {
    const auto camera = temp_.write("c.yaml", "fx: 300\nfy: 300\ncx: 160\ncy: 120\nwidth: 320\nheight: 240\n");
    const std::vector<std::string> few{"--camera", camera.string(), "--max-frames", "3"};
    const Result recorded = record("openni2:Dummy", temp_ / "seen.klg", few);
    if (recorded.err.find("no such camera") != std::string::npos) GTEST_SKIP() << "OpenNI2 without its test driver";
    EXPECT_EQ(recorded.exit_code, 0) << recorded.err;
    EXPECT_EQ(open_source(temp_ / "seen.klg")->size(), 3u);
    std::vector<std::string> tracked = few;
    tracked.push_back("--no-people");
    const Result run = execute(run_of("openni2:Dummy", tracked));
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_GE(poses(), 1u) << "its frames are noise: nothing can be tracked in them";
    const std::string stats = read_all(out() / "stats.json");
    EXPECT_NE(stats.find("\"frames\": null"), std::string::npos) << "an endless recording";
    EXPECT_NE(stats.find("\"frames\": 3"), std::string::npos) << "of which three were processed";
}

/// With the program that the documentation gives, as a shell starts it.
TEST_F(Sources, APipeIsRecordedAndTracked) {
    const fs::path feed = feed_program();
    const auto piped = [&](const std::string& command) {
        return execute(
            {{"/bin/sh", "-c",
              "python3 '" + feed.string() + "' '" + recording().string() + "' | " POSEFUSION_PROGRAM " " + command}});
    };
    const std::string log = (temp_ / "piped.klg").string();
    const Result recorded = piped("record raw:- --out " + log);
    EXPECT_EQ(recorded.exit_code, 0) << recorded.err;
    EXPECT_EQ(recorded.err.find("warning"), std::string::npos) << recorded.err;
    EXPECT_TRUE(results(log) == results(recording())) << "every frame, bit by bit";
    const Result run = piped("run raw:- --no-people --out " + out().string());
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_GE(poses(), 1u) << "frames that come too fast are left out";

    expect_error(execute({{"/bin/sh", "-c", "echo nonsense | " POSEFUSION_PROGRAM " record raw:- --out " + log + "2"}}),
                 {"raw:-: does not begin with the line"});
}

/// A pipe whose writing end stays open, as that of a program that hangs.
class SilentPipe {
public:
    explicit SilentPipe(fs::path place) : place_(std::move(place)) {
        EXPECT_EQ(mkfifo(place_.c_str(), 0600), 0);
        descriptor_ = open(place_.c_str(), O_RDWR | O_CLOEXEC);
    }
    ~SilentPipe() { close(descriptor_); }
    SilentPipe(const SilentPipe&) = delete;
    SilentPipe& operator=(const SilentPipe&) = delete;

    [[nodiscard]] std::string place() const { return place_.string(); }
    void write(const std::string& text) const {
        EXPECT_EQ(::write(descriptor_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
    }
    /// Whether its reader has taken all, within a minute.
    [[nodiscard]] bool runs_dry() const {
        for (int attempt = 0; attempt < 6000; ++attempt) {
            int left = 0;
            if (ioctl(descriptor_, FIONREAD, &left) == 0 && left == 0) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return false;
    }

private:
    fs::path place_;
    int descriptor_ = -1;
};

TEST_F(Sources, ASilentPipeCanBeInterrupted) {
    const fs::path recording = long_recording(), log = temp_ / "piped.klg", others = temp_ / "feeder";
    fs::create_directory(others);
    const SilentPipe pipe(temp_ / "pipe");
    const auto from_pipe = [&](const std::string& command) {
        return Program{{"/bin/sh", "-c", "exec " POSEFUSION_PROGRAM " " + command + " <'" + pipe.place() + "'"}};
    };
    const auto feed_until = [&](Subprocess& process, const std::string& text) {
        const std::string command = "exec python3 '" + feed_program().string() + "' '" + recording.string() + "'";
        Subprocess feeder({{"/bin/sh", "-c", command + " >'" + pipe.place() + "'"}}, others);
        return process.wait_for(text);
    };
    constexpr double kPatience = 30;  // seconds after which a silent stream is an error
    const auto seconds_to_end = [&](Subprocess& process, int exit_code) {
        EXPECT_TRUE(pipe.runs_dry());
        process.send(SIGINT);
        const auto begin = std::chrono::steady_clock::now();
        EXPECT_EQ(process.exit_code(), exit_code) << process.error_output();
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    };
    {
        Subprocess run(from_pipe("run raw:- --no-people --no-report --out '" + out().string() + "'"), temp_.path());
        ASSERT_TRUE(feed_until(run, "frame 20")) << run.error_output();
        EXPECT_LT(seconds_to_end(run, 130), kPatience / 3) << "saving the results included";
        EXPECT_GE(poses(), 1u);
        EXPECT_TRUE(fs::exists(out() / "map.ply"));
        EXPECT_NE(read_all(out() / "stats.json").find("\"status\": \"interrupted\""), std::string::npos);
    }
    {
        Subprocess record(from_pipe("record raw:- --out '" + log.string() + "'"), temp_.path());
        ASSERT_TRUE(feed_until(record, "frame 20")) << record.error_output();
        EXPECT_LT(seconds_to_end(record, 0), kPatience / 3);
        EXPECT_GE(open_source(log)->size(), 20u);
    }
    Subprocess unheard(from_pipe("run raw:- --no-people --out '" + out().string() + "'"), temp_.path());
    pipe.write("posefusion-raw 1\n");
    EXPECT_LT(seconds_to_end(unheard, 130), kPatience / 3);
    EXPECT_NE(unheard.error_output().find("raw:-: interrupted while waiting"), std::string::npos)
        << unheard.error_output();
}

TEST_F(Sources, BadFilesEndInOneLine) {
    for (const char* name : {"x.klg", "x.bag", "x.mcap", "x.db3", "x.db3.zstd", "x.oni", "x.mp4"})
        expect_error(execute(run_of(temp_.write(name, "this is something else entirely"))), {name});
    expect_error(execute(run_of("openni2:nothing")), {"openni2:nothing"});
}

TEST_F(Sources, ClassesPickThePeople) {
    const auto people = results(recording());
    const auto others = results(recording(), {"--classes", "77"});
    EXPECT_NE(people.second, others.second) << "nobody is of that class, so nobody is cut out";
    expect_error(execute(run_of(recording(), {"--classes", "1"})), {"--classes needs --masks"});
}

}  // namespace
}  // namespace posefusion::test
