#pragma once
#include <CLI/CLI.hpp>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hosts/config/option_table.hpp"

namespace posefusion {

/// The possible values of SOURCE and RECORDING, for the help.
inline constexpr const char* kSourceHelp =
    "folder in TUM layout or of colour and depth images, or of rosbag2 or Stray Scanner; .klg, .bag, .mcap, .db3, .oni "
    "or "
    ".mkv (Azure Kinect) file; openni2: for a camera; raw:- for frames on standard input";

/// The arguments of `run`, `view` and `bench`: a recording, a configuration file and the options of the table.
class RunArguments {
public:
    /// @param without_effect  keys of options that the command accepts, so that it can be called with the same
    /// arguments as `run`, but that have no effect there
    RunArguments(CLI::App& app, std::span<const std::string_view> without_effect);

    /// After parsing: fills `config` from the file and the command line. @throws Error of the file, CLI::ParseError of
    /// the command line
    void apply();

    std::filesystem::path recording;
    RunConfig config;

private:
    struct Declared {
        CLI::Option* option;
        CLI::Option* negation;  // null: there is none
    };
    void declare(CLI::App& app, const Option& option, const std::string& heading);
    /// The configuration that a run wrote with its results names their paths; another run must not write there unless
    /// asked to.
    void keep_results_of_file() const;

    std::string file_;
    std::vector<Option> options_;  ///< in the order of the help
    std::vector<Declared> declared_;
};

}  // namespace posefusion
