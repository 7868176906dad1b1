// Nothing is lost: not what was computed when a run ends early, and not what was there before.
#include <csignal>
#include <regex>

#include "hosts/io/frame_source.hpp"
#include "tests/hosts/cli/cli_fixture.hpp"

namespace posefusion::test {
namespace {

namespace fs = std::filesystem;

class Output : public Cli {
protected:
    /// A program that finds the disk full when the files below disk() have so many bytes.
    [[nodiscard]] Program on_full_disk(const std::vector<std::string>& arguments, int bytes) const {
        fs::create_directories(disk());
        Program full = program(arguments);
        full.environment = {{"LD_PRELOAD", POSEFUSION_FULL_DISK},
                            {"FULL_DISK_FOLDER", fs::canonical(disk()).string()},
                            {"FULL_DISK_TOTAL_BYTES", std::to_string(bytes)}};
        return full;
    }
    [[nodiscard]] fs::path disk() const { return temp_ / "disk"; }

    /// The error says how many frames are kept; these are those of `source`, in a recording that can be read.
    static void expect_kept(const Result& result, const fs::path& kept, const fs::path& source) {
        expect_error(result, {"No space left on device", "kept in " + kept.string()});
        std::smatch count;
        ASSERT_TRUE(std::regex_search(result.err, count, std::regex("; kept in .*: ([0-9]+) frames?\n")));
        const auto made = open_source(kept), from = open_source(source);
        EXPECT_EQ(made->size(), std::stoul(count[1]));
        EXPECT_TRUE(made->facts().warnings.empty()) << made->facts().warnings[0];
        ASSERT_GT(made->size(), 0u);
        ASSERT_LT(made->size(), from->size());
        for (std::size_t i = 0; i < made->size(); ++i) {
            const RawFrame a = made->read(i), b = from->read(i);
            EXPECT_EQ(a.stamp_text, b.stamp_text);
            EXPECT_TRUE(std::equal(a.color.begin(), a.color.end(), b.color.begin(), b.color.end())) << i;
            EXPECT_TRUE(std::equal(a.depth.begin(), a.depth.end(), b.depth.begin(), b.depth.end())) << i;
        }
    }

    static std::vector<std::string> names_in(const fs::path& folder) {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
        std::sort(names.begin(), names.end());
        return names;
    }
};

TEST_F(Output, ALogOnAFullDiskEndsWithItsLastWholeFrame) {
    const fs::path log = disk() / "log.klg";
    const Result result = execute(on_full_disk({"record", recording().string(), "--out", log.string()}, 400'000));
    expect_kept(result, log, recording());
    EXPECT_EQ(names_in(disk()), (std::vector<std::string>{"log.klg", "log.yaml"}));
}

TEST_F(Output, AFolderOnAFullDiskHasListsOfItsWholeFrames) {
    const fs::path folder = disk() / "made";
    const Result result = execute(on_full_disk({"record", recording().string(), "--out", folder.string()}, 300'000));
    expect_kept(result, folder, recording());
    const std::size_t frames = open_source(folder)->size();
    EXPECT_EQ(names_in(folder / "rgb").size(), frames);
    EXPECT_EQ(names_in(folder / "depth").size(), frames);
}

TEST_F(Output, AFullDiskKeepsWhatSynthMade) {
    const fs::path folder = disk() / "made";
    const Result result =
        execute(on_full_disk({"synth", "--out", folder.string(), "--frames", std::to_string(kFrames), "--people", "1",
                              "--width", std::to_string(kWidth), "--height", std::to_string(kHeight)},
                             200'000));
    expect_kept(result, folder, recording());
}

TEST_F(Output, ADiskTooFullForTheTrueSurfaceKeepsAllFrames) {
    const fs::path folder = disk() / "made";
    const Result result = execute(on_full_disk({"synth", "--out", folder.string(), "--frames", "3", "--people", "1",
                                                "--width", std::to_string(kWidth), "--height", std::to_string(kHeight)},
                                               400'000));
    expect_error(result, {"surface.ply", "No space left on device", "kept in " + folder.string() + ": 3 frames"});
    EXPECT_EQ(open_source(folder)->size(), 3u);
    EXPECT_TRUE(fs::exists(folder / "joints.json"));
}

TEST_F(Output, ADiskThatIsFullAtOnceLeavesTheFolderForAnotherTry) {
    const fs::path folder = disk() / "made";
    const std::vector<std::string> arguments{"record", recording().string(), "--out", folder.string()};
    expect_error(execute(on_full_disk(arguments, 5'000)), {"No space left on device"});
    EXPECT_EQ(execute(program(arguments)).exit_code, 0);
}

TEST_F(Output, AnInterruptedSynthSaysHowManyFramesItMade) {
    Subprocess synth(
        program({"synth", "--out", out().string(), "--frames", "4000", "--static", "--width", "64", "--height", "48"}),
        temp_.path());
    ASSERT_TRUE(synth.wait_for("frame 20/4000")) << synth.error_output();
    synth.send(SIGHUP);
    EXPECT_EQ(synth.exit_code(), 130);
    const std::size_t made = open_source(out())->size();
    EXPECT_GE(made, 20u);
    EXPECT_LT(made, 4000u);
    EXPECT_NE(synth.output().find(": " + std::to_string(made) + " frames"), std::string::npos) << synth.output();
    EXPECT_NE(synth.error_output().find("interrupted after " + std::to_string(made) + " of 4000"), std::string::npos);
}

TEST_F(Output, AnInterruptedRecordingCanBeRead) {
    const fs::path log = temp_ / "log.klg";
    Subprocess record(program({"record", long_recording().string(), "--out", log.string()}), temp_.path());
    ASSERT_TRUE(record.wait_for("frame 20/10000")) << record.error_output();
    record.send(SIGHUP);
    EXPECT_EQ(record.exit_code(), 130);
    const std::size_t kept = open_source(log)->size();
    EXPECT_GE(kept, 20u);
    EXPECT_NE(record.output().find(": " + std::to_string(kept) + " frames"), std::string::npos) << record.output();
}

TEST_F(Output, AnInterruptedBenchShowsItsTable) {
    Subprocess bench(program({"bench", long_recording().string(), "--no-people"}), temp_.path());
    ASSERT_TRUE(bench.wait_for("frame 20/10000")) << bench.error_output();
    bench.send(SIGHUP);
    EXPECT_EQ(bench.exit_code(), 130);
    EXPECT_NE(bench.output().find("whole frame"), std::string::npos) << bench.output();
}

TEST_F(Output, ARecordingIsNoPlaceForResults) {
    const fs::path data = copy_of_recording();
    const auto before = names_in(data);
    const fs::path mask = *fs::directory_iterator(data / "masks");
    const std::string bytes = read_all(mask);
    expect_error(execute(program({"run", data.string(), "--out", data.string(), "--save-masks", "--no-people"})),
                 {data.string(), "holds a recording"});
    expect_error(execute(program({"run", recording().string(), "--out", data.string(), "--no-people"})),
                 {data.string(), "holds a recording"});
    expect_error(execute(program({"synth", "--out", data.string(), "--frames", "2"})), {"holds a recording already"});
    EXPECT_EQ(names_in(data), before);
    EXPECT_EQ(read_all(mask), bytes);

    const fs::path log = temp_.write("log.klg", "precious");
    expect_error(execute(program({"record", data.string(), "--out", log.string()})), {"log.klg", "is there already"});
    EXPECT_EQ(read_all(log), "precious");
}

TEST_F(Output, ARecordingIsNotMixedWithAnother) {
    // whatever it is: layouts of others have no lists; the camera of another log
    const fs::path camera = temp_.write("scene/color/0.jpg", "precious"),
                   other = temp_.write("second.yaml", "precious");
    const std::string scene = (temp_ / "scene").string();
    temp_.write("log/output.txt", "of the console");
    EXPECT_EQ(execute(program({"synth", "--out", (temp_ / "log").string(), "--frames", "1", "--width", "64", "--height",
                               "48", "--people", "0"}))
                  .exit_code,
              0)
        << "other files do no harm";
    const fs::path named = fs::path("color") / "0.jpg";
    expect_error(execute(program({"synth", "--out", scene, "--frames", "2"})),
                 {"holds a recording already", named.string()});
    expect_error(execute(program({"record", recording().string(), "--out", scene})), {"holds a recording already"});
    expect_error(execute(program({"record", recording().string(), "--out", (temp_ / "second.klg").string()})),
                 {"second.yaml", "is there already"});
    for (const fs::path& file : {camera, other}) EXPECT_EQ(read_all(file), "precious");
    EXPECT_EQ(names_in(temp_ / "scene"), std::vector<std::string>{"color"});
}

TEST_F(Output, MasksOfOthersAreKept) {
    fs::create_directories(out());
    fs::copy(recording() / "masks", out() / "masks");
    const auto with_masks = [&](const fs::path& masks) {
        return execute(run_of(recording(), {"--save-masks", "--masks", masks.string()}));
    };
    expect_error(with_masks(out()), {"--save-masks would replace the masks that --masks reads"});
    expect_error(with_masks(out() / "masks"), {"--save-masks would replace the masks that --masks reads"});
    expect_error(with_masks(recording()), {"holds files that no earlier run saved here"});
    const std::vector<std::string> read{"--max-frames", "2", "--masks", out().string()};
    ASSERT_EQ(execute(run_of(recording(), read)).exit_code, 0);
    ASSERT_EQ(execute(run_of(recording(), read)).exit_code, 0);
    EXPECT_EQ(names_in(out() / "masks"), names_in(recording() / "masks"));
}

TEST_F(Output, NothingOfAnEarlierRunStaysBesideTheResults) {
    const auto run = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"run", recording().string(), "--out", out().string(), "--no-people"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Result result = execute(program(arguments));
        ASSERT_EQ(result.exit_code, 0) << result.err;
    };
    run({"--save-masks", "--max-frames", "6", "--checkpoint-every", "3"});
    EXPECT_EQ(names_in(out() / "masks").size(), 6u);
    temp_.write("out/notes.txt", "mine");
    run({"--save-masks", "--max-frames", "3"});
    EXPECT_EQ(names_in(out() / "masks").size(), 3u);
    run({"--no-report", "--max-frames", "2"});
    EXPECT_EQ(names_in(out()),
              (std::vector<std::string>{"config.yaml", "map.ply", "notes.txt", "stats.json", "trajectory.txt"}));
    EXPECT_EQ(poses(), 2u);
}

TEST_F(Output, AConfigurationDoesNotLeadIntoTheResultsItBelongsTo) {
    const std::string map = (temp_ / "room.pfmap").string(), file = (out() / "config.yaml").string();
    ASSERT_EQ(execute(run_of(recording(), {"--no-people", "--max-frames", "3", "--save-map", map})).exit_code, 0);
    const std::string trajectory = read_all(out() / "trajectory.txt"), saved = read_all(map);
    std::vector<std::string> again{"run", recording().string(), "--config", file, "--max-frames", "2"};
    expect_error(execute(program(again)), {file, "belongs to the results", "--out"});
    again.insert(again.end(), {"--out", (temp_ / "new").string()});
    expect_error(execute(program(again)), {file, "room.pfmap", "--save-map"});
    EXPECT_EQ(read_all(out() / "trajectory.txt"), trajectory);
    EXPECT_EQ(read_all(map), saved);
    again.insert(again.end(), {"--save-map", (temp_ / "new.pfmap").string()});
    const Result result = execute(program(again));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(read_all(out() / "trajectory.txt"), trajectory);
    EXPECT_TRUE(fs::exists(temp_ / "new/trajectory.txt"));
}

TEST_F(Output, TwoRunsDoNotWriteIntoOneFolder) {
    fs::create_directories(temp_ / "second");
    Subprocess first(run_of(long_recording(), {"--no-people", "--scale", "0.5"}), temp_.path());
    ASSERT_TRUE(first.wait_for("frame 20/10000")) << first.error_output();
    Subprocess other(run_of(recording()), temp_ / "second");
    EXPECT_EQ(other.exit_code(), 1);
    EXPECT_NE(other.error_output().find(out().string() + ": another posefusion is writing"), std::string::npos)
        << other.error_output();
    first.send(SIGINT);
    EXPECT_EQ(first.exit_code(), 130);
    EXPECT_EQ(execute(run_of(recording())).exit_code, 0) << "the folder is free again";
}

}  // namespace
}  // namespace posefusion::test
