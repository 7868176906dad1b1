// Whatever the user gets wrong ends with one clear line, a non-zero exit code, and what was computed on the disk.
#include <fstream>

#include "hosts/io/image_file.hpp"
#include "tests/hosts/cli/cli_fixture.hpp"

namespace posefusion::test {
namespace {

namespace fs = std::filesystem;

class BadInput : public Cli {
protected:
    /// Does something to every image of a kind ("rgb" or "depth"), or to the fourth only.
    template <class Action>
    static void spoil(const fs::path& recording, const std::string& kind, bool all, Action&& action) {
        std::vector<fs::path> files;
        for (const auto& entry : fs::directory_iterator(recording / kind)) files.push_back(entry.path());
        std::sort(files.begin(), files.end());
        ASSERT_GT(files.size(), 3u);
        for (std::size_t i = 0; i < files.size(); ++i) {
            if (all || i == 3) action(files[i]);
        }
    }

    /// A single spoilt image is skipped with a warning; when all are, the run ends with an error.
    template <class Action>
    void expect_skipped_when_single_and_error_when_all(const std::string& kind, const std::string& word,
                                                       Action&& action) {
        const fs::path recording = copy_of_recording();
        spoil(recording, kind, false, action);
        const Result single = execute(run_of(recording));
        EXPECT_EQ(single.exit_code, 0) << single.err;
        EXPECT_NE(single.err.find("posefusion: warning: "), std::string::npos) << single.err;
        EXPECT_NE(single.err.find(word), std::string::npos) << single.err;
        EXPECT_EQ(poses(), static_cast<std::size_t>(kFrames - 1));

        spoil(recording, kind, true, action);
        expect_error(execute(run_of(recording)), {word});
    }
};

TEST_F(BadInput, MissingFolder) { expect_error(execute(run_of(temp_ / "nowhere")), {"nowhere", "not found"}); }

TEST_F(BadInput, FolderWithoutLists) {
    fs::create_directories(temp_ / "empty");
    expect_error(execute(run_of(temp_ / "empty")), {"rgb.txt"});
    const std::string stats = read_all(out() / "stats.json");  // for those who read no console
    EXPECT_NE(stats.find("\"status\": \"failed\""), std::string::npos) << stats;
    EXPECT_NE(stats.find("rgb.txt"), std::string::npos) << stats;
}

TEST_F(BadInput, EmptyOrMalformedLists) {
    const fs::path recording = copy_of_recording();
    fs::remove(recording / "associations.txt");
    const std::string good = read_all(recording / "rgb.txt");
    for (const char* list : {"rgb.txt", "depth.txt"}) {
        for (const char* content : {"", "# only a comment\n", "no numbers here\n\x01\x02\n"}) {
            const std::string before = read_all(recording / list);
            std::ofstream(recording / list) << content;
            expect_error(execute(run_of(recording)), {list});
            std::ofstream(recording / list) << before;
        }
    }
    fs::remove(recording / "depth.txt");
    expect_error(execute(run_of(recording)), {"depth.txt"});
}

TEST_F(BadInput, StampsTooFarApart) {
    const fs::path recording = copy_of_recording();
    fs::remove(recording / "associations.txt");
    std::ofstream(recording / "depth.txt") << "5.0 depth/1000.000000.png\n";
    expect_error(execute(run_of(recording)), {"20 ms"});
}

TEST_F(BadInput, TruncatedImages) {
    const auto truncate = [](const fs::path& file) { fs::resize_file(file, fs::file_size(file) / 2); };
    expect_skipped_when_single_and_error_when_all("depth", ".png", truncate);
}

TEST_F(BadInput, EmptyImages) {
    expect_skipped_when_single_and_error_when_all("rgb", ".jpg",
                                                  [](const fs::path& file) { fs::resize_file(file, 0); });
}

TEST_F(BadInput, MissingImages) {
    expect_skipped_when_single_and_error_when_all("rgb", ".jpg", [](const fs::path& file) { fs::remove(file); });
}

TEST_F(BadInput, ImagesOfWrongSize) {
    expect_skipped_when_single_and_error_when_all(
        "depth", "160", [](const fs::path& file) { write_depth(file, DepthImage(kWidth / 2, kHeight, 1.0f), 5000); });
}

TEST_F(BadInput, ImagesOfWrongType) {
    expect_skipped_when_single_and_error_when_all("depth", ".png", [](const fs::path& file) {
        write_png(file, ColorImage(kWidth, kHeight, {100, 100, 100}));
    });
}

TEST_F(BadInput, NoDepthAtAll) {
    expect_skipped_when_single_and_error_when_all(
        "depth", "no measurement", [](const fs::path& file) { write_depth(file, DepthImage(kWidth, kHeight), 5000); });
}

TEST_F(BadInput, BlackFrames) {
    expect_skipped_when_single_and_error_when_all(
        "rgb", "black", [](const fs::path& file) { write_jpeg(file, ColorImage(kWidth, kHeight), 90); });
}

TEST_F(BadInput, IntrinsicsMissing) {
    const fs::path recording = copy_of_recording();
    fs::rename(recording / "camera.yaml", temp_ / "kept.yaml");
    expect_error(execute(run_of(recording)), {"--camera"});
    const Result given = execute(run_of(recording, {"--no-people", "--camera", (temp_ / "kept.yaml").string()}));
    EXPECT_EQ(given.exit_code, 0) << given.err;
    EXPECT_EQ(poses(), static_cast<std::size_t>(kFrames));
}

TEST_F(BadInput, IntrinsicsNotPositiveOrMalformed) {
    const fs::path recording = copy_of_recording();
    for (const char* fx : {"0", "-133", "nan", "wide", ""}) {
        temp_.write("recording/camera.yaml",
                    std::string("width: 160\nheight: 120\nfx: ") + fx + "\nfy: 133\ncx: 79.5\ncy: 59.5\n");
        expect_error(execute(run_of(recording)), {"camera.yaml", "fx"});
    }
    temp_.write("recording/camera.yaml", "width: 160\nheight: [120\n");
    expect_error(execute(run_of(recording)), {"camera.yaml"});
}

TEST_F(BadInput, PoseModelMissingOrCorrupt) {
    expect_error(execute(run_of(recording(), {"--pose-model", (temp_ / "nothing.onnx").string()})), {"nothing.onnx"});
    const fs::path corrupt = temp_.write("corrupt.onnx", "this is no network");
    expect_error(execute(run_of(recording(), {"--pose-model", corrupt.string()})), {"corrupt.onnx"});
    expect_error(execute(run_of(recording(), {"--pose-runtime", "opencv", "--pose-model", corrupt.string()})),
                 {"corrupt.onnx"});
}

TEST_F(BadInput, MasksMissingOrUnusable) {
    expect_error(execute(run_of(recording(), {"--masks", (temp_ / "nowhere").string()})), {"nowhere"});
    expect_error(execute(run_of(recording(), {"--masks", recording().string(), "--no-people"})),
                 {"--masks", "--no-people"});
}

TEST_F(BadInput, NoVulkanDevice) {
    Program run = run_of(recording());
    run.environment = {{"VK_ICD_FILENAMES", "/nonexistent/icd.json"}, {"VK_DRIVER_FILES", "/nonexistent/icd.json"}};
    expect_error(execute(run), {"Vulkan"});
    Program devices = program({"devices"});
    devices.environment = run.environment;
    expect_error(execute(devices), {"Vulkan"});
}

TEST_F(BadInput, DeviceOfThatNameOrIndexDoesNotExist) {
    expect_error(execute(run_of(recording(), {"--no-people", "--device", "Voodoo"})), {"Voodoo"});
    expect_error(execute(run_of(recording(), {"--no-people", "--device", "99"})), {"99"});
}

TEST_F(BadInput, MapLargerThanAllowedKeepsWhatWasComputed) {
    // About 16 thousand surfels come with the first frame and more with every other.
    const Result result =
        execute(run_of(recording(), {"--no-people", "--map-initial-capacity", "1024", "--map-max-capacity", "20000"}));
    expect_error(result, {"max_capacity"});
    EXPECT_GE(poses(), 1u);
    EXPECT_LT(poses(), static_cast<std::size_t>(kFrames));
    EXPECT_TRUE(fs::exists(out() / "map.ply"));
    EXPECT_NE(read_all(out() / "stats.json").find("\"failed\""), std::string::npos);
}

TEST_F(BadInput, MemoryExhausted) {
    Program run = run_of(recording(),
                         {"--no-people", "--map-initial-capacity", "1000000000", "--map-max-capacity", "1000000000"});
    run.max_address_bytes = rlim_t{3} << 30;
    expect_error(execute(run), {"memory"});
}

TEST_F(BadInput, OutputFolderNotWritable) {
    temp_.write("file", "in the way");
    Program run = program({"run", recording().string(), "--no-people", "--out", (temp_ / "file/out").string()});
    expect_error(execute(run), {"file/out"});
    run.arguments.back() = (temp_ / "file").string();
    expect_error(execute(run), {"file"});
    run.arguments.back() = "/proc/posefusion";
    expect_error(execute(run), {"/proc/posefusion"});
}

TEST_F(BadInput, DiskFullKeepsWhatFits) {
    Program run = run_of(recording(), {"--no-people", "--all-surfels"});
    run.environment = {{"LD_PRELOAD", POSEFUSION_FULL_DISK},
                       {"FULL_DISK_FOLDER", fs::canonical(temp_.path()).string()},
                       {"FULL_DISK_BYTES", "100000"}};  // the map needs more, the trajectory less
    expect_error(execute(run), {"map.ply", "No space left on device"});
    EXPECT_EQ(poses(), static_cast<std::size_t>(kFrames));
    EXPECT_FALSE(fs::exists(out() / "map.ply")) << "half a map under the final name";
    EXPECT_TRUE(fs::exists(out() / "config.yaml"));
}

// ulimit -f: a driver that keeps device memory in files must not crash on it. Older ones do not and may go on.
TEST_F(BadInput, FilesMayNotGrow) {
    Program run = run_of(recording(), {"--no-people", "--all-surfels"});
    run.max_file_bytes = 100'000;
    const Result result = execute(run);
    EXPECT_EQ(result.exit_code, 1);
    const bool before = result.err.find("ulimit -f") != std::string::npos;
    const bool after = result.err.find("map.ply") != std::string::npos;
    EXPECT_TRUE(before || after) << result.err;
}

TEST_F(BadInput, StandardOutputFull) {
    const std::string truth = (recording() / "groundtruth.txt").string();
    for (Program full : {program({"evaluate", truth, truth}), run_of(recording())}) {
        full.standard_output = "/dev/full";
        expect_error(execute(full), {"standard output"});
    }
    EXPECT_EQ(poses(), static_cast<std::size_t>(kFrames));

    Program nowhere_to_complain = program({"evaluate", truth, truth});
    nowhere_to_complain.max_file_bytes = 10;
    EXPECT_EQ(execute(nowhere_to_complain).exit_code, 1);
}

TEST_F(BadInput, EvaluateWithoutUsableTrajectories) {
    const std::string truth = (recording() / "groundtruth.txt").string();
    expect_error(execute(program({"evaluate", truth, (temp_ / "nothing.txt").string()})), {"nothing.txt"});
    const std::string later = temp_.write("later.txt", "5000 0 0 0 0 0 0 1\n5001 0 0 0 0 0 0 1\n").string();
    EXPECT_EQ(execute(program({"evaluate", truth, later})).exit_code, 1);
}

TEST_F(BadInput, WrongCommandLinesAreExplained) {
    for (const std::vector<std::string>& arguments :
         std::vector<std::vector<std::string>>{{},
                                               {"fly"},
                                               {"run"},
                                               {"run", "a", "b"},
                                               {"run", "a", "--unknown", "1"},
                                               {"run", "a", "--scale"},
                                               {"evaluate", "a"}}) {
        const Result result = execute(program(arguments));
        EXPECT_EQ(result.exit_code, 2) << result.err;
        EXPECT_TRUE(result.err.starts_with("posefusion: ")) << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    }
}

TEST_F(BadInput, WrongValuesOnTheCommandLineAreExplained) {
    const auto expect_usage = [&](const Program& wrong, const std::vector<std::string>& words) {
        const Result result = execute(wrong);
        EXPECT_EQ(result.exit_code, 2) << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        for (const std::string& word : words) EXPECT_NE(result.err.find(word), std::string::npos) << result.err;
    };
    for (const char* scale : {"2", "nan", "1e30", "-1", "", "half"})
        expect_usage(run_of(recording(), {"--scale", scale}), {"--scale", "'" + std::string(scale) + "'"});
    expect_usage(run_of(recording(), {"--report"}), {"--no-report", "--report"});
    expect_usage(run_of(recording(), {"--scale", ".25", "--scale", ".5"}), {"--scale is given 2 times"});
    expect_usage(run_of(recording(), {"--out", "elsewhere"}), {"--out"});
    const std::string made = out().string();
    expect_usage(program({"synth", "--out", made, "--frames", "3", "--frames", "4"}), {"--frames"});
    expect_usage(program({"record", recording().string(), "--out", made, "--out", made}), {"--out"});
    expect_usage(program({"record", recording().string(), "--out", made, "--max-frames", "-1"}),
                 {"--max-frames", "-1"});
    expect_usage(program({"synth", "--out", made, "--seed", "-5"}), {"--seed", "'-5'", "a whole number from 0 on;"});
    expect_usage(program({"synth", "--out", made, "--frames", "-3"}), {"frames must be at least 1, it is -3"});
    expect_usage(program({"synth", "--out", made, "--frames", "x"}), {"--frames", "'x' is not a number"});
    expect_usage(program({"evaluate", made, made, "--max-difference", "-1"}), {"--max-difference", "not negative"});
    expect_usage(run_of(recording(), {"--scal", "0.5"}), {"no option --scal; the nearest is --scale"});
    EXPECT_FALSE(fs::exists(out()));
}

TEST_F(BadInput, NamesThatAreTooLong) {
    const std::string name(300, 'a'), path = (temp_ / name).string();
    for (const Program& wrong :
         {program({"run", path}), program({"run", recording().string(), "--no-people", "--out", path}),
          program({"record", recording().string(), "--out", path}), program({"synth", "--out", path}),
          program({"record", recording().string(), "--out", path + ".klg"})}) {
        const Result result = execute(wrong);
        expect_error(result, {path});
        EXPECT_EQ(result.err.find("filesystem error"), std::string::npos) << result.err;
    }
}

TEST_F(BadInput, TheCommandsAreListedWhereNoneIsGiven) {
    for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{{}, {"frobnicate"}}) {
        const Result result = execute(program(arguments));
        EXPECT_EQ(result.exit_code, 2);
        for (const char* command :
             {"run", "bench", "calibrate", "record", "evaluate", "export", "web", "synth", "devices"})
            EXPECT_NE(result.err.find(std::string(command)), std::string::npos) << result.err;
    }
    EXPECT_EQ(execute(program({"help"})).out, execute(program({"--help"})).out);
    EXPECT_EQ(execute(program({"help", "run"})).out, execute(program({"run", "--help"})).out);
    EXPECT_EQ(execute(program({"help", "frobnicate"})).exit_code, 2);
}

TEST_F(BadInput, AReaderThatWantsNoMoreIsNoFault) {
    const Program program_and_reader{
        {"/bin/sh", "-c", "(" POSEFUSION_PROGRAM " run --help-all; echo code $? >&2) | head -c 1"}};
    const Result result = execute(program_and_reader);
    EXPECT_EQ(result.err, "code 0\n");
}

TEST_F(BadInput, ConfigurationFileWithUnknownKey) {
    const fs::path file = temp_.write("my.yaml", "scale: 1\ntracking:\n  icq: true\n");
    expect_error(execute(run_of(recording(), {"--config", file.string()})),
                 {"my.yaml:3", "tracking.icq", "tracking.icp"});
}

}  // namespace
}  // namespace posefusion::test
