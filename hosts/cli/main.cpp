#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <exception>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/nearest_name.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/cli/commands.hpp"
#include "hosts/cli/export_arguments.hpp"
#include "hosts/cli/help_formatter.hpp"
#include "hosts/cli/run_arguments.hpp"
#include "hosts/io/sources/openni_source.hpp"
#include "hosts/io/sources/video/video_file.hpp"
#include "hosts/run/run_session.hpp"
#include "hosts/run/signals.hpp"
#ifdef POSEFUSION_HAS_VIEWER
#include "hosts/viewer/view_command.hpp"
#include "hosts/viewer/view_script.hpp"
#endif

namespace posefusion {
namespace {

/// Must not throw, even if nothing can be printed.
void print_error(const std::string& text) { std::fputs(("posefusion: " + text + "\n").c_str(), stderr); }

/// It is not an error if the reader of the output, like `head`, has closed it.
bool reader_has_gone() {
    pollfd output{STDOUT_FILENO, 0, 0};
    return ::poll(&output, 1, 0) == 1 && (output.revents & POLLERR) != 0;
}

bool is_closed_pipe(const std::exception_ptr& error) {
    try {
        std::rethrow_exception(error);
    } catch (const std::system_error& fault) {
        return fault.code() == std::errc::broken_pipe;
    } catch (...) {
        return false;
    }
}

/// The error in the name of the command; empty: none.
std::string fault_of_command(const CLI::App& app, const std::vector<std::string>& arguments) {
    if (!arguments.empty() && arguments.front().starts_with('-')) return "";
    std::string names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        if (!arguments.empty() && command->get_name() == arguments.front()) return "";
        names += (names.empty() ? "" : ", ") + command->get_name();
    }
    return (arguments.empty() ? "no command is given" : "there is no command '" + arguments.front() + "'") +
           "; the commands are " + names + "; see `posefusion --help`";
}

/// `posefusion help` and `posefusion help COMMAND` ask for what `--help` shows; the number after `--web` is its port,
/// whereas any other word is an argument of its own.
std::vector<std::string> arguments_of(int argc, char** argv) {
    std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
    if (!arguments.empty() && arguments.front() == "help") {
        arguments.erase(arguments.begin());
        arguments.insert(arguments.begin() + (arguments.empty() ? 0 : 1), "--help");
    }
    for (std::size_t i = 0; i + 1 < arguments.size(); ++i) {
        const std::string& next = arguments[i + 1];
        if (arguments[i] != "--web" || next.empty() || next.find_first_not_of("0123456789") != next.npos) continue;
        arguments[i] += "=" + next;
        arguments.erase(arguments.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
    return arguments;
}

/// The option as it was given, without a value; empty: it is none.
std::string option_name(const std::string& argument) {
    const bool is_option = argument.size() > 2 && argument.starts_with("--");
    return is_option ? argument.substr(0, argument.find('=')) : "";
}

/// What is wrong with the arguments, in the words of a user; CLI11's own where there are no better ones.
std::string fault_of_arguments(const CLI::App& app, const std::vector<std::string>& arguments,
                               const CLI::ParseError& error) {
    if (arguments.empty() || arguments.front().starts_with('-')) return error.what();
    const CLI::App* command = app.get_subcommand(arguments.front());  // there is one: fault_of_command()
    std::vector<std::string> known;
    for (const CLI::Option* option : command->get_options())
        for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    std::map<std::string, int> times;
    for (const std::string& argument : arguments)
        if (const std::string name = option_name(argument); !name.empty()) ++times[name];
    if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
        for (const auto& [name, count] : times) {
            if (std::find(known.begin(), known.end(), name) == known.end())
                return "there is no option " + name + "; the nearest is " + nearest_name(name, known);
        }
    }
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) {
        const std::string text = error.what();
        for (const auto& [name, count] : times)
            if (count > 1 && text.starts_with(name + ":")) return name + " is given " + counted(count, "time");
    }
    if (dynamic_cast<const CLI::ConversionError*>(&error) != nullptr) {
        const std::string text = error.what(), beginning = "Could not convert: ", between = " = ";
        const std::size_t middle = text.find(between);
        if (text.starts_with(beginning) && middle != std::string::npos)
            return text.substr(beginning.size(), middle - beginning.size()) + ": '" +
                   text.substr(middle + between.size()) + "' is not a number that is possible here";
    }
    return error.what();
}

/// The options about files that `run` writes: `bench` writes none ...
constexpr std::array<std::string_view, 9> kWithoutEffectOnBench{"out",        "report",           "final_adjust",
                                                                "save_masks", "save_background",  "all_surfels",
                                                                "save_map",   "checkpoint_every", "resume"};
/// ... and `view` only what it is asked to.
constexpr std::array<std::string_view, 7> kWithoutEffectOnView{
    "report", "final_adjust", "save_masks", "save_background", "save_map", "checkpoint_every", "resume"};

const CLI::Validator kNotEmpty{[](const std::string& text) { return text.empty() ? "is empty" : std::string(); }, ""};

constexpr const char* kWebOption = "--web";
constexpr const char* kWebGroup = "Watching";
constexpr const char* kFlagAlone = "true";  // what CLI11 makes of a flag without a value

CLI::Option* add_bind_option(CLI::App& command, WebServerConfig& server) {
    return command
        .add_option(
            "--bind", server.address,
            "address to listen at; one that other machines can reach gets a secret folder in the page's address")
        ->capture_default_str()
        ->check(kNotEmpty)
        ->type_name("ADDRESS");
}

int port_of(const std::string& text) {
    constexpr int kLast = 65535;
    int port = -1;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
    if (error != std::errc() || end != text.data() + text.size() || port < 0 || port > kLast)
        throw CLI::ValidationError(kWebOption, "'" + text + "' is no port; give a number from 0 to 65535");
    return port;
}

void add_run_command(CLI::App& app, int& exit_code) {
    CLI::App* sub = app.add_subcommand("run", "compute the camera trajectory and the people-free map of a recording");
    const auto arguments = std::make_shared<RunArguments>(*sub, std::span<const std::string_view>{});
    const auto port = std::make_shared<std::string>();
    const auto server = std::make_shared<WebServerConfig>();
    server->port_option = kWebOption;
    CLI::Option* web = sub->add_flag(
        kWebOption, *port, "show the run in a browser while it is going; PORT: to listen at, 0 = any that is free");
    web->type_name("[PORT]")->group(kWebGroup)->default_str(std::to_string(server->port));
    add_bind_option(*sub, *server)->group(kWebGroup)->needs(web);
    sub->callback([=, &exit_code] {
        arguments->apply();
        if (web->count() > 0 && *port != kFlagAlone) server->port = port_of(*port);
        exit_code = run_command(arguments->recording, arguments->config,
                                web->count() > 0 ? std::optional(*server) : std::nullopt);
    });
}

void add_bench_command(CLI::App& app, int& exit_code) {
    CLI::App* sub = app.add_subcommand("bench", "measure the time per stage on a recording; writes no files");
    const auto arguments = std::make_shared<RunArguments>(*sub, kWithoutEffectOnBench);
    const auto json = std::make_shared<bool>(false);
    sub->add_flag("--json", *json, "print JSON, with the time of every frame, instead of a table");
    sub->callback([arguments, json, &exit_code] {
        arguments->apply();
        exit_code = bench_command(arguments->recording, arguments->config, *json);
    });
}

void add_calibrate_command(CLI::App& app, int& exit_code) {
    CLI::App* sub = app.add_subcommand("calibrate", "what the beginning of a recording says about its camera");
    const auto arguments = std::make_shared<RunArguments>(*sub, kWithoutEffectOnBench);
    const auto write = std::make_shared<std::string>();
    sub->add_option("--write", *write, "camera file to write, if the calibration was corrected")->type_name("a file");
    sub->callback([=, &exit_code] {
        arguments->apply();
        exit_code = calibrate_command(arguments->recording, arguments->config, *write);
    });
}

#ifdef POSEFUSION_HAS_VIEWER
void add_view_command(CLI::App& app, int& exit_code) {
    CLI::App* sub = app.add_subcommand("view", "`run` in a window: the map as it grows, people, images and parameters");
    const auto arguments = std::make_shared<RunArguments>(*sub, kWithoutEffectOnView);
    const auto options = std::make_shared<ViewOptions>();
    sub->add_option("--window-width", options->window.width, "width of the window")
        ->capture_default_str()
        ->type_name("px")
        ->check(CLI::Range(200, 16384).description(""));
    sub->add_option("--window-height", options->window.height, "height of the window")
        ->capture_default_str()
        ->type_name("px")
        ->check(CLI::Range(150, 16384).description(""));
    sub->add_option("--script", options->script, "perform the steps listed in this text file (see below)")
        ->type_name("a file");
    sub->footer("Steps of a script, one per line:\n" + view_script_help());
    sub->callback([=, &exit_code] {
        arguments->apply();
        exit_code = view_command(arguments->recording, arguments->config, *options);
    });
}
#endif

/// A whole number from 0 on.
const CLI::Validator kCount{[](const std::string& text) {
                                const bool digits = !text.empty() && text.find_first_not_of("0123456789") == text.npos;
                                return digits ? ""
                                              : "'" + text + "' is not allowed here; give a whole number from 0 on";
                            },
                            ""};

constexpr const char* kAutomatic = "auto";

/// Runs `parse`; its Error means that the value given for `option` is wrong.
template <class Parse>
void parse_value(const char* option, Parse&& parse) {
    try {
        parse();
    } catch (const Error& error) {
        throw CLI::ValidationError(option, error.what());
    }
}

/// Runs `check`; its Error means that the values given do not go together.
template <class Check>
void check_values(Check&& check) {
    try {
        check();
    } catch (const Error& error) {
        throw CLI::ValidationError(error.what());
    }
}

void add_time_unit(CLI::App& sub, std::string& unit) {
    sub.add_option("--time-unit", unit, "unit of time stamps that do not tell it themselves")
        ->check(CLI::IsMember({kAutomatic, "s", "ms", "us", "ns"}).description(""))
        ->capture_default_str()
        ->type_name("auto | s | ms | us | ns");
}

void add_record_command(CLI::App& app, int& exit_code) {
    struct Arguments {
        std::string source, out;
        SourceOptions reading;
        RecordOptions writing;
        std::string time_unit = kAutomatic;
        bool raw = false;
    };
    CLI::App* sub =
        app.add_subcommand("record", "copy a recording, or what a camera sees, to a TUM folder or .klg log");
    const auto given = std::make_shared<Arguments>();
    sub->add_option("SOURCE", given->source, kSourceHelp)->required()->type_name("");
    sub->add_option("--out", given->out, "folder, or file NAME.klg; both are lossless unless --jpeg is given")
        ->required()
        ->check(kNotEmpty)
        ->type_name("PATH");
    sub->add_option_function<std::string>(
           "--start",
           [given](const std::string& text) {
               parse_value("--start", [&] { given->reading.selection.start = parse_frame_start(text); });
           },
           "first frame that is used; the first of the source is 0")
        ->type_name("a frame | seconds, as 1.5s");
    sub->add_option("--every", given->reading.selection.every, "use every n-th frame only")
        ->capture_default_str()
        ->check(CLI::Range(1, 1'000'000).description(""))
        ->type_name("N");
    sub->add_option("--max-frames", given->writing.max_frames, "number of frames to record; 0 = all")
        ->capture_default_str()
        ->check(kCount)
        ->type_name("N");
    sub->add_option("--jpeg", given->writing.jpeg_quality,
                    ".klg: JPEG quality of the colour images; 0 = not compressed")
        ->capture_default_str()
        ->check(CLI::Range(0, 100).description(""))
        ->type_name("0 .. 100");
    sub->add_flag("--raw", given->raw, ".klg: do not compress depth");
    sub->add_option("--camera", given->reading.camera_file, "camera.yaml to use instead of what the source says")
        ->type_name("PATH");
    sub->add_option("--associations", given->reading.associations_file,
                    "list of image pairs to use instead of the folder's own")
        ->type_name("PATH");
    sub->add_option("--color-topic", given->reading.color_topic, "topic of the colour images in a bag")
        ->type_name("TOPIC");
    sub->add_option("--depth-topic", given->reading.depth_topic, "topic of the depth images in a bag")
        ->type_name("TOPIC");
    add_time_unit(*sub, given->time_unit);
    sub->add_flag("--flip-colors", given->reading.flip_colors, "swap red and blue of a .klg log");
    sub->callback([given, &exit_code] {
        given->writing.compress = !given->raw;
        given->reading.time_unit = time_unit(given->time_unit);
        exit_code = record_command(given->source, given->out, given->reading, given->writing);
    });
}

void add_evaluate_command(CLI::App& app, int& exit_code) {
    struct Arguments {
        EvaluateConfig config;
        std::string time_unit = kAutomatic, time_offset = "0";
        double max_difference = to_seconds(kMaxStampDifference);
    };
    CLI::App* sub =
        app.add_subcommand("evaluate", "ATE and RPE of a trajectory as the TUM RGB-D benchmark, or evo, defines them");
    const auto given = std::make_shared<Arguments>();
    const auto choice = [&](const char* option, auto& value, const auto& values, const char* help) {
        std::string names;
        for (const auto rule : values) names += (names.empty() ? "" : " | ") + std::string(name_of(rule));
        const auto parse = [option, names, &value, &values](const std::string& text) {
            const auto rule = std::find_if(values.begin(), values.end(), [&](auto r) { return text == name_of(r); });
            if (rule == values.end())
                throw CLI::ValidationError(option, "'" + text + "' is not allowed here; give " + names);
            value = *rule;
        };
        return sub->add_option_function<std::string>(option, parse, help)
            ->default_str(name_of(value))
            ->type_name(names);
    };
    EvaluationConfig& evaluation = given->config.evaluation;
    constexpr const char* kFormats = "TUM, EuRoC / ASL or KITTI";
    sub->add_option("GROUNDTRUTH", given->config.groundtruth, std::string("true trajectory: ") + kFormats)
        ->required()
        ->type_name("");
    sub->add_option("ESTIMATE", given->config.estimate, std::string("trajectory to judge: ") + kFormats)
        ->required()
        ->type_name("");
    sub->add_flag("--json", given->config.json, "print JSON (metres, degrees)");
    sub->add_option("--plot", given->config.plot, "draw both paths and the error into this picture")
        ->type_name("FILE.png");
    choice("--align", evaluation.alignment.rule, kAlignmentRules,
           "bring the estimate to the true world: all positions, the first pose");
    sub->add_flag("--scale", evaluation.alignment.scale, "align the scale as well");
    choice("--match", evaluation.matching.rule, kMatchingRules,
           "which poses belong together: tum = each once, the closest pair first; evo = for each of the shorter "
           "trajectory the nearest");
    sub->add_option("--max-difference", given->max_difference, "largest between the stamps of such poses")
        ->capture_default_str()
        ->type_name("s");
    sub->add_option("--time-offset", given->time_offset, "added to the stamps of the estimate; auto = what fits best")
        ->capture_default_str()
        ->type_name("s | auto");
    sub->add_option("--delta", evaluation.rpe.delta, "between the two poses of a relative error")
        ->check(CLI::PositiveNumber.description(""))
        ->capture_default_str()
        ->type_name("N");
    const CLI::Option* delta_unit = choice("--delta-unit", evaluation.rpe.unit, kDeltaUnits,
                                           "of --delta; all but s pair the matched poses as evo does");
    sub->add_flag("--all-pairs", evaluation.rpe.all_pairs,
                  "all pairs that far apart instead of one after the other (by time it is always all)");
    add_time_unit(*sub, given->time_unit);
    sub->callback([=, &exit_code] {
        EvaluateConfig& config = given->config;
        parse_value("--max-difference", [&] {
            if (given->max_difference < 0) throw Error("a difference is not negative");
            config.evaluation.matching.max_difference = stamp_of(given->max_difference);
        });
        config.delta_unit_given = !delta_unit->empty();
        config.time_unit = time_unit(given->time_unit);
        config.find_time_offset = given->time_offset == "auto";
        if (!config.find_time_offset) {
            const auto offset = parse_stamp(given->time_offset);
            if (!offset)
                throw CLI::ValidationError("--time-offset", "'" + given->time_offset + "' is neither seconds nor auto");
            config.time_offset = *offset;
        }
        if (!config.plot.empty() && config.plot.extension() != ".png")
            throw CLI::ValidationError("--plot", config.plot.string() + " is not the name of a .png file");
        exit_code = evaluate_command(config);
    });
}

void add_web_command(CLI::App& app, int& exit_code) {
    CLI::App* sub = app.add_subcommand("web", "show a map, and the run that made it, in a browser");
    const auto config = std::make_shared<WebConfig>();
    sub->add_option("DIR", config->source, "folder of `posefusion run`, map.ply of one, or what --save-map wrote")
        ->required()
        ->type_name("");
    sub->add_option("--port", config->server.port, "port to listen at; 0 = any that is free")
        ->capture_default_str()
        ->check(CLI::Range(0, 65535).description(""))
        ->type_name("0 .. 65535");
    add_bind_option(*sub, config->server);
    sub->add_option("--min-confidence", config->min_confidence, "surfels with less confidence are left out")
        ->default_str("those that are not stable")
        ->check(CLI::NonNegativeNumber.description(""))
        ->type_name("N");
    sub->add_option("--recording", config->recording, "of the run, for the images of its keyframes")
        ->default_str("where it was when it was run")
        ->type_name("PATH");
    sub->callback([config, &exit_code] { exit_code = web_command(*config); });
}

void add_synth_command(CLI::App& app, int& exit_code) {
    CLI::App* sub =
        app.add_subcommand("synth", "make a synthetic recording of a room with moving people, with exact ground truth");
    const auto config = std::make_shared<SynthConfig>();
    const auto no_people = std::make_shared<bool>(false);
    const auto clean = std::make_shared<bool>(false);
    sub->add_option("--out", config->out, "folder for the recording")
        ->required()
        ->check(kNotEmpty)
        ->type_name("a folder");
    std::map<std::string, SynthScenario> scenarios;
    for (const SynthScenario scenario : {SynthScenario::Room, SynthScenario::Loop, SynthScenario::LoopPeople,
                                         SynthScenario::Kidnap, SynthScenario::Movers})
        scenarios.emplace(scenario_name(scenario), scenario);
    const auto scenario = std::make_shared<std::string>(scenario_name(config->scenario));
    sub->add_option("--scenario", *scenario, "what happens; docs/synth.md describes each")
        ->transform(CLI::IsMember(scenarios, CLI::ignore_case).description(""))
        ->capture_default_str()
        ->type_name("room | loop | loop-people | kidnap | movers");
    const auto sensor = std::make_shared<std::string>(config->sensor.name);
    std::vector<std::string> sensors;
    for (const synth::SensorModel& model : synth::sensor_models()) sensors.emplace_back(model.name);
    sub->add_option("--sensor", *sensor, "kind of camera, with the errors it has; docs/synth.md describes each")
        ->check(CLI::IsMember(sensors).description(""))
        ->capture_default_str()
        ->type_name(fmt::format("{}", fmt::join(sensors, " | ")));
    const CLI::Option* frames =
        sub->add_option("--frames", config->frames, "length of the recording")
            ->type_name("frames")
            ->default_str(fmt::format("{}, walks {}, kidnap {}", usual_frames(SynthScenario::Room),
                                      usual_frames(SynthScenario::Loop), usual_frames(SynthScenario::Kidnap)));
    sub->add_option("--people", config->people, "number of people")->capture_default_str()->type_name("0 .. 6");
    sub->add_option("--seed", config->seed, "seed of room, people, motion, camera and noise")
        ->capture_default_str()
        ->check(kCount)
        ->type_name("number");
    sub->add_option("--width", config->width, "image width")->capture_default_str()->type_name("px");
    sub->add_option("--height", config->height, "image height")->capture_default_str()->type_name("px");
    sub->add_option("--fps", config->fps, "frame rate")->capture_default_str()->type_name("1/s");
    sub->add_option("--camera-speed", config->camera_speed, "pace of the hand-held camera; 1 = calm")
        ->capture_default_str()
        ->type_name("factor");
    sub->add_option("--threads", config->threads, "CPU threads; 0 = all; the images do not depend on it")
        ->capture_default_str()
        ->type_name("threads");
    sub->add_flag("--static", *no_people, "a static scene, without people");
    sub->add_flag("--still-camera", config->still_camera, "the camera stands still");
    sub->add_flag("--easy", config->easy, "walk in daylight between textured walls: hardly any drift");
    sub->add_flag("--no-noise", *clean, "no noise, no blur, depth everywhere; the rest of the sensor stays");
    sub->callback([=, &exit_code] {
        if (*no_people) config->people = 0;
        config->noise = !*clean;
        config->scenario = scenarios.at(*scenario);
        config->sensor = synth::sensor_model(*sensor);
        if (frames->empty()) config->frames = usual_frames(config->scenario);
        check_values([&] { check(*config); });
        exit_code = synth_command(*config);
    });
}

/// With a line on each thing that not every build has.
std::string version_text() {
#ifdef POSEFUSION_HAS_VIEWER
    constexpr bool kHasViewer = true;
#else
    constexpr bool kHasViewer = false;
#endif
    const auto line = [](bool has, const char* what) { return std::string(has ? "\nwith " : "\nwithout ") + what; };
    return "posefusion " POSEFUSION_VERSION +
           line(has_video(), "video: recordings of Azure Kinect (.mkv) and of Stray Scanner") +
           line(has_openni(), "OpenNI2: cameras (openni2:)") + line(kHasViewer, "viewer: posefusion view");
}

int run_program(int argc, char** argv) {
    int exit_code = kExitOk;
    CLI::App app("Dense RGB-D SLAM for rooms in which people move.", "posefusion");
    app.set_version_flag("--version", version_text(), "show the version");
    app.require_subcommand(1);
    app.formatter(std::make_shared<HelpFormatter>());
    app.set_help_flag("-h,--help", "show this help");
    app.set_help_all_flag("--help-all", "the same with the advanced options");
    app.footer(
        "Exit codes: 0 success, 1 error (described in one line), 2 wrong command line, 130 interrupted by Ctrl-C.\n"
        "After an error or an interruption, everything computed so far is written.");
    add_run_command(app, exit_code);
#ifdef POSEFUSION_HAS_VIEWER
    add_view_command(app, exit_code);
#endif
    add_bench_command(app, exit_code);
    add_calibrate_command(app, exit_code);
    add_record_command(app, exit_code);
    add_evaluate_command(app, exit_code);
    add_export_command(app, exit_code);
    add_web_command(app, exit_code);
    add_synth_command(app, exit_code);
    CLI::App* devices = app.add_subcommand("devices", "list the Vulkan devices and what each lacks, if anything");
    devices->callback([&] { exit_code = devices_command(); });
    const std::vector<std::string> arguments = arguments_of(argc, argv);
    if (const std::string fault = fault_of_command(app, arguments); !fault.empty()) {
        print_error(fault);
        return kExitUsage;
    }
    try {
        app.parse(std::vector<std::string>(arguments.rbegin(),
                                           arguments.rend()));  // in the order in which CLI11 expects them
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(error);  // --help
        print_error(fault_of_arguments(app, arguments, error) +
                    "; see `posefusion --help` and `posefusion COMMAND --help`");
        return kExitUsage;
    }
    return exit_code;
}

}  // namespace
}  // namespace posefusion

int main(int argc, char** argv) {
    using namespace posefusion;
    handle_signals();
    try {
        const int exit_code = run_program(argc, argv);
        if ((std::fflush(stdout) != 0 || std::ferror(stdout) != 0) && !reader_has_gone()) {
            throw Error("cannot write to the standard output; is the disk full?");
        }
        return exit_code;
    } catch (const SourceCancelled& cancelled) {  // before there was anything to save
        print_error(cancelled.what());
        return kExitInterrupted;
    } catch (...) {
        if (!is_closed_pipe(std::current_exception()) || !reader_has_gone())
            print_error(error_text(std::current_exception()));
        return kExitError;
    }
}
