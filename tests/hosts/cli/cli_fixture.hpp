#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/hosts/support/subprocess.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion::test {

/// Runs the real program on a small recording that it makes itself.
class Cli : public ::testing::Test {
protected:
    struct Result {
        int exit_code = 0;
        std::string out, err;
    };

    static constexpr int kFrames = 12, kWidth = 160, kHeight = 120;

    /// Made once per program: one person in a room.
    static const std::filesystem::path& recording() {
        static const TempRecording made;
        return made.folder;
    }

    /// A copy of recording() that a test may spoil.
    [[nodiscard]] std::filesystem::path copy_of_recording() const {
        const std::filesystem::path copy = temp_ / "recording";
        std::filesystem::copy(recording(), copy, std::filesystem::copy_options::recursive);
        return copy;
    }

    /// A copy whose twelve images stand in a list of 10000 frames: a run of minutes.
    [[nodiscard]] std::filesystem::path long_recording() const {
        const std::filesystem::path recording = copy_of_recording();
        std::ifstream list(recording / "associations.txt");
        std::vector<std::string> colors, depths;
        for (std::string stamp, color, depth; list >> stamp >> color >> stamp >> depth;) {
            colors.push_back(color);
            depths.push_back(depth);
        }
        list.close();
        EXPECT_EQ(colors.size(), static_cast<std::size_t>(kFrames));
        std::ofstream longer(recording / "associations.txt");
        for (int i = 0; i < 10000; ++i) {
            const auto at = static_cast<std::size_t>(i % kFrames);
            const std::string stamp = std::to_string(2000 + i / 30.0);
            longer << stamp << ' ' << colors[at] << ' ' << stamp << ' ' << depths[at] << '\n';
        }
        return recording;
    }

    [[nodiscard]] std::filesystem::path out() const { return temp_ / "out"; }

    [[nodiscard]] static Program program(const std::vector<std::string>& arguments) {
        Program program{{POSEFUSION_PROGRAM}};
        program.arguments.insert(program.arguments.end(), arguments.begin(), arguments.end());
        return program;
    }

    /// posefusion run RECORDING --out out() ...; without people unless asked for, which spares the network
    [[nodiscard]] Program run_of(const std::filesystem::path& recording,
                                 const std::vector<std::string>& more = {"--no-people"}) const {
        std::vector<std::string> arguments{"run", recording.string(), "--out", out().string(), "--no-report"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return program(arguments);
    }

    [[nodiscard]] Result execute(const Program& program) const {
        Subprocess process(program, temp_.path());
        Result result;
        result.exit_code = process.exit_code();
        result.out = process.output();
        result.err = process.error_output();
        return result;
    }

    /// It must end with exit code 1 and one line that contains all of `words`, after any warnings and progress.
    static void expect_error(const Result& result, const std::vector<std::string>& words, int exit_code = 1) {
        EXPECT_EQ(result.exit_code, exit_code) << result.err;
        std::vector<std::string> errors;
        std::istringstream lines(result.err);
        for (std::string line; std::getline(lines, line);) {
            if (line.starts_with("posefusion: ") && !line.starts_with("posefusion: warning: ")) errors.push_back(line);
        }
        ASSERT_EQ(errors.size(), 1u) << result.err;
        for (const std::string& word : words)
            EXPECT_NE(errors[0].find(word), std::string::npos) << "no '" << word << "' in: " << errors[0];
    }

    /// Poses in out()/trajectory.txt; 0 if there is none.
    [[nodiscard]] std::size_t poses() const {
        std::istringstream lines(read_all(out() / "trajectory.txt"));
        std::size_t count = 0;
        for (std::string line; std::getline(lines, line);) count += !line.empty() && line[0] != '#' ? 1 : 0;
        return count;
    }

    TempFolder temp_;

private:
    struct TempRecording {
        TempRecording()
            : folder(std::filesystem::temp_directory_path() / ("posefusion_recording_" + std::to_string(getpid()))) {
            std::filesystem::create_directories(folder);
            Subprocess synth(
                program({"synth", "--out", folder.string(), "--frames", std::to_string(kFrames), "--people", "1",
                         "--width", std::to_string(kWidth), "--height", std::to_string(kHeight)}),
                folder);
            if (synth.exit_code() != 0) ADD_FAILURE() << synth.error_output();
        }
        ~TempRecording() {
            std::error_code ignored;
            std::filesystem::remove_all(folder, ignored);
        }
        std::filesystem::path folder;
    };
};

}  // namespace posefusion::test
