#include "hosts/viewer/view_script.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string_view>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr std::uintmax_t kMaxBytes = 1 << 20;  // a script is written by hand

struct Verb {
    std::string_view name;
    std::string_view words;  ///< what follows, separated by spaces; upper case N, X, Y: numbers
    std::string_view meaning;
};

constexpr std::array kVerbs{
    Verb{"play", "", "run freely"},
    Verb{"pause", "", "stop before the next frame, and wait for that"},
    Verb{"step", "N", "process N frames, then pause"},
    Verb{"wait", "N", "until N frames are done"},
    Verb{"wait-end", "", "until the last frame is done"},
    Verb{"reset", "", "back to the start, with an empty map, paused"},
    Verb{"orbit", "X Y", "turn by X degrees to the right and Y down"},
    Verb{"pan", "X Y", "shift by X right and Y down, in heights of the window"},
    Verb{"zoom", "X", "go to X times the distance"},
    Verb{"follow", "SWITCH", "follow the camera: on | off"},
    Verb{"colour", "MODE", "photo | normal | confidence | age | time"},
    Verb{"confidence", "X", "draw only surfels of at least this confidence"},
    Verb{"set", "KEY VALUE", "change an option of the run, from the next frame on"},
    Verb{"show", "WHAT SWITCH", "map | path | frustum | skeletons | mask | objects | images | panels | help, on | off"},
    Verb{"resize", "N N", "the window, pixels: width and height"},
    Verb{"minimise", "", "the window"},
    Verb{"restore", "", "the window"},
    Verb{"key", "NAME", "press a key, by its name in the help"},
    Verb{"draw", "N", "until N more frames of the window are drawn"},
    Verb{"screenshot", "FILE", "save a picture of the window (PNG)"},
    Verb{"save-map", "FILE", "save the stable surfels (PLY)"},
    Verb{"save-trajectory", "FILE", "save the trajectory so far (TUM)"},
    Verb{"close", "", "the window; so does the end of the script"},
};

/// What a script may ask for; larger windows than that are in nobody's reach.
constexpr double kMaxCount = 1e9, kMaxWindow = 16384;

std::vector<std::string> split(const std::string& text) {
    std::istringstream stream(text);
    return {std::istream_iterator<std::string>(stream), {}};
}

std::optional<double> number(const std::string& word) {
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

void check_words(const Verb& verb, const ScriptStep& step) {
    const std::vector<std::string> expected = split(std::string(verb.words));
    if (step.words.size() != expected.size()) {
        throw Error(fmt::format("{}: '{}' takes {} words{}{}", step.where, step.verb, expected.size(),
                                expected.empty() ? "" : ": ", verb.words));
    }
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const std::string& word = step.words[i];
        const bool is_count = expected[i] == "N";
        if (!is_count && expected[i].size() > 1) continue;  // not a number
        const std::optional<double> value = number(word);
        if (!value || (is_count && (*value < 0 || *value != std::floor(*value) || *value > kMaxCount))) {
            throw Error(fmt::format("{}: '{}' is no {}", step.where, word, is_count ? "whole number" : "number"));
        }
        if (step.verb == "resize" && (*value < 1 || *value > kMaxWindow))
            throw Error(fmt::format("{}: a window cannot be {} pixels; give 1 .. {}", step.where, word, kMaxWindow));
    }
}

}  // namespace

double script_number(const std::string& word) { return number(word).value(); }

std::vector<ScriptStep> parse_view_script(const std::string& text, const std::string& name) {
    std::vector<ScriptStep> steps;
    std::istringstream lines(text);
    std::size_t number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        std::vector<std::string> words = split(line.substr(0, line.find('#')));
        if (words.empty()) continue;
        ScriptStep step;
        step.line = number;
        step.where = fmt::format("{}:{}", name, number);
        step.verb = words.front();
        step.words.assign(words.begin() + 1, words.end());
        const auto verb =
            std::find_if(kVerbs.begin(), kVerbs.end(), [&](const Verb& v) { return v.name == step.verb; });
        if (verb == kVerbs.end()) {
            throw Error(fmt::format("{}: '{}' is no step of a script; `posefusion view --help` lists them", step.where,
                                    step.verb));
        }
        check_words(*verb, step);
        steps.push_back(std::move(step));
    }
    return steps;
}

std::vector<ScriptStep> load_view_script(const std::filesystem::path& file) {
    std::error_code failed;
    const std::uintmax_t bytes = std::filesystem::file_size(file, failed);
    std::ifstream stream(file, std::ios::binary);
    if (failed || !stream) throw Error("cannot read the script " + file.string() + "; give a text file");
    if (bytes > kMaxBytes) throw Error("the script " + file.string() + " is too large to be one; give a text file");
    return parse_view_script({std::istreambuf_iterator<char>(stream), {}}, file.string());
}

std::string view_script_help() {
    std::string text;
    for (const Verb& verb : kVerbs) {
        text += fmt::format("  {:<24}{}\n", fmt::format("{} {}", verb.name, verb.words), verb.meaning);
    }
    return text;
}

}  // namespace posefusion
