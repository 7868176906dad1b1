#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/error.hpp"
#include "hosts/cli/commands.hpp"
#include "hosts/config/config_file.hpp"
#include "hosts/config/option_table.hpp"
#include "hosts/run/run_session.hpp"
#include "hosts/run/signals.hpp"
#ifdef POSEFUSION_HAS_VIEWER
#include "hosts/viewer/view_command.hpp"
#include "hosts/viewer/view_script.hpp"
#endif

namespace posefusion {
namespace {

/// Must not throw: there may be nowhere to print to.
void print_error(const std::string& text) { std::fputs(("posefusion: " + text + "\n").c_str(), stderr); }

constexpr const char* kSourceHelp =
    "folder in TUM layout or of colour and depth images, .klg, .bag or .oni file, or openni2: for a camera";

/// What stands in the help for the value of an option.
std::string placeholder(const Option& option) {
    switch (option.kind) {
        case Option::Kind::Switch:
            return "";
        case Option::Kind::Number:
            return "N";
        case Option::Kind::List:
            return "A,B,...";
        case Option::Kind::Choice:
            return "NAME";
        case Option::Kind::Text:
            return option.allowed.starts_with("a ") ? "PATH" : "TEXT";  // "a file", "a folder"
    }
    return "";
}

/// "--no-report" for "--report"; nothing for what is a negation itself.
std::string negation(const Option& option) {
    const std::string flag = option.flag();
    return option.kind != Option::Kind::Switch || flag.starts_with("--no-") ? "" : "--no-" + flag.substr(2);
}

/// "meaning [default 0.1 m; 0.001 .. 10]"
std::string description(const Option& option) {
    const std::string value = option.get().empty() ? "none" : option.get();
    std::string text = option.help + " [default " + value + (option.unit.empty() ? "" : " " + option.unit);
    if (option.kind != Option::Kind::Switch)
        text += "; " + option.allowed;
    else if (value == "true")
        text += "; " + negation(option) + " turns it off";
    return text + "]";
}

/// The arguments of `run` and `bench`: a recording, a configuration file and the options of the table.
class RunArguments {
public:
    explicit RunArguments(CLI::App& app) : options_(option_table(config)) {
        app.add_option("RECORDING", recording, kSourceHelp)->required()->type_name("");
        app.add_option("--config", file_,
                       "YAML file with options; the command line goes before it [default none; a file]")
            ->type_name("PATH");
        for (const Option& option : options_) declare(app, option);
    }

    void apply() {
        if (!file_.empty()) load_config(file_, options_);
        for (std::size_t i = 0; i < options_.size(); ++i) {
            const Declared& given = declared_[i];
            if (given.negation != nullptr && given.negation->count() > 0) {
                if (given.option->count() > 0)
                    throw Error(negation(options_[i]) + " contradicts " + options_[i].flag());
                options_[i].set("false");
            }
            if (given.option->count() > 0) set(options_[i], given.option->results().back());
        }
        check_config(config);
    }

    std::filesystem::path recording;
    RunConfig config;

private:
    struct Declared {
        CLI::Option* option;
        CLI::Option* negation;  // null: there is none
    };

    void declare(CLI::App& app, const Option& option) {
        Declared declared{nullptr, nullptr};
        const std::string help = description(option);
        if (option.kind == Option::Kind::Switch) {
            declared.option = app.add_flag(option.flag(), help);
        } else {
            declared.option = app.add_option(option.flag(), help)->type_name(placeholder(option));
        }
        declared.option->group(option.group().empty() ? "Options" : option.group());
        if (const std::string no = negation(option); !no.empty()) {
            declared.negation = app.add_flag(no)->group("");  // not shown in the help
        }
        declared_.push_back(declared);
    }

    static void set(const Option& option, const std::string& text) {
        try {
            option.set(text);
        } catch (const Error& error) {
            throw Error(option.flag() + ": " + error.what());
        }
    }

    std::string file_;
    std::vector<Option> options_;
    std::vector<Declared> declared_;
};

using Command = int (*)(const std::filesystem::path&, RunConfig&);

void add_run_command(CLI::App& app, const std::string& name, const std::string& help, Command command, int& exit_code) {
    CLI::App* sub = app.add_subcommand(name, help);
    const auto arguments = std::make_shared<RunArguments>(*sub);
    sub->callback([arguments, command, &exit_code] {
        arguments->apply();
        exit_code = command(arguments->recording, arguments->config);
    });
}

#ifdef POSEFUSION_HAS_VIEWER
void add_view_command(CLI::App& app, int& exit_code) {
    CLI::App* sub = app.add_subcommand("view", "`run` in a window: the map as it grows, the people, the parameters");
    const auto arguments = std::make_shared<RunArguments>(*sub);
    const auto options = std::make_shared<ViewOptions>();
    sub->add_option("--window-width", options->window.width, "of the window")
        ->capture_default_str()
        ->type_name("px")
        ->check(CLI::Range(200, 16384));
    sub->add_option("--window-height", options->window.height, "of the window")
        ->capture_default_str()
        ->type_name("px")
        ->check(CLI::Range(150, 16384));
    sub->add_option("--script", options->script, "do what this text file says, line by line (see below)")
        ->type_name("a file");
    sub->footer("The steps of a script, one a line:\n" + view_script_help());
    sub->callback([=, &exit_code] {
        arguments->apply();
        exit_code = view_command(arguments->recording, arguments->config, *options);
    });
}
#endif

void add_record_command(CLI::App& app, int& exit_code) {
    struct Arguments {
        std::string source, out;
        SourceOptions reading;
        RecordOptions writing;
        bool raw = false;
    };
    CLI::App* sub = app.add_subcommand("record", "a recording, or what a camera sees, as TUM folder or .klg log");
    const auto given = std::make_shared<Arguments>();
    sub->add_option("SOURCE", given->source, kSourceHelp)->required()->type_name("");
    sub->add_option("--out", given->out,
                    "a folder, or a file NAME.klg; nothing is lost in either unless --jpeg is given")
        ->required()
        ->type_name("PATH");
    sub->add_option("--max-frames", given->writing.max_frames, "stop after so many; 0 = all")
        ->capture_default_str()
        ->type_name("N");
    sub->add_option("--jpeg", given->writing.jpeg_quality, ".klg: colour as JPEG of this quality; 0 = as it is")
        ->capture_default_str()
        ->check(CLI::Range(0, 100))
        ->type_name("0 .. 100");
    sub->add_flag("--raw", given->raw, ".klg: depth not compressed");
    sub->add_option("--camera", given->reading.camera_file, "camera.yaml to use instead of what the source says")
        ->type_name("PATH");
    sub->add_option("--associations", given->reading.associations_file,
                    "list of image pairs instead of the folder's own")
        ->type_name("PATH");
    sub->add_option("--color-topic", given->reading.color_topic, "colour images of a bag")->type_name("TOPIC");
    sub->add_option("--depth-topic", given->reading.depth_topic, "depth images of a bag")->type_name("TOPIC");
    sub->add_flag("--flip-colors", given->reading.flip_colors, "exchange red and blue of a .klg log");
    sub->callback([given, &exit_code] {
        given->writing.compress = !given->raw;
        exit_code = record_command(given->source, given->out, given->reading, given->writing);
    });
}

void add_evaluate_command(CLI::App& app, int& exit_code) {
    struct Arguments {
        std::string groundtruth, estimate;
        bool json = false;
    };
    CLI::App* sub =
        app.add_subcommand("evaluate", "ATE and RPE of a trajectory as the TUM RGB-D benchmark defines them");
    const auto arguments = std::make_shared<Arguments>();
    sub->add_option("GROUNDTRUTH", arguments->groundtruth, "true trajectory, TUM format")->required();
    sub->add_option("ESTIMATE", arguments->estimate, "trajectory to judge, TUM format")->required();
    sub->add_flag("--json", arguments->json, "print JSON (metres, degrees)");
    sub->callback([arguments, &exit_code] {
        exit_code = evaluate_command(arguments->groundtruth, arguments->estimate, arguments->json);
    });
}

void add_export_command(CLI::App& app, int& exit_code) {
    CLI::App* sub = app.add_subcommand("export", "a mesh or a point cloud of a map");
    const auto config = std::make_shared<ExportConfig>();
    sub->add_option("MAP", config->map, "map.ply written by `posefusion run`, or the folder it is in")
        ->required()
        ->type_name("");
    sub->add_option("--mesh", config->mesh, "surface through the surfels, open where there are none")
        ->type_name("FILE.ply | FILE.obj");
    sub->add_option("--cloud", config->cloud, "points with normals and colours")->type_name("FILE.pcd | FILE.ply");
    sub->add_option("--min-confidence", config->min_confidence, "surfels below this take no part")
        ->capture_default_str()
        ->type_name("N");
    sub->add_option("--resolution", config->reconstruction.resolution, "smallest detail of the mesh")
        ->capture_default_str()
        ->type_name("m");
    sub->callback([config, &exit_code] { exit_code = export_command(*config); });
}

void add_synth_command(CLI::App& app, int& exit_code) {
    CLI::App* sub =
        app.add_subcommand("synth", "make a recording of a room in which people move, with exact ground truth");
    const auto config = std::make_shared<SynthConfig>();
    const auto nobody = std::make_shared<bool>(false);
    const auto clean = std::make_shared<bool>(false);
    sub->add_option("--out", config->out, "folder of the recording")->required()->type_name("a folder");
    std::map<std::string, SynthScenario> scenarios;
    for (const SynthScenario scenario :
         {SynthScenario::Room, SynthScenario::Loop, SynthScenario::LoopPeople, SynthScenario::Kidnap})
        scenarios.emplace(scenario_name(scenario), scenario);
    const auto scenario = std::make_shared<std::string>(scenario_name(config->scenario));
    sub->add_option("--scenario", *scenario, "what happens; README.md describes each")
        ->transform(CLI::IsMember(scenarios, CLI::ignore_case).description(""))
        ->capture_default_str()
        ->type_name("room | loop | loop-people | kidnap");
    const CLI::Option* frames =
        sub->add_option("--frames", config->frames, "length")
            ->type_name("frames")
            ->default_str(fmt::format("{}, walks {}, kidnap {}", usual_frames(SynthScenario::Room),
                                      usual_frames(SynthScenario::Loop), usual_frames(SynthScenario::Kidnap)));
    sub->add_option("--people", config->people, "how many people")->capture_default_str()->type_name("0 .. 6");
    sub->add_option("--seed", config->seed, "decides room, people, motion, camera and noise")
        ->capture_default_str()
        ->type_name("number");
    sub->add_option("--width", config->width, "image width")->capture_default_str()->type_name("px");
    sub->add_option("--height", config->height, "image height")->capture_default_str()->type_name("px");
    sub->add_option("--fps", config->fps, "frame rate")->capture_default_str()->type_name("1/s");
    sub->add_option("--camera-speed", config->camera_speed, "pace of the hand-held motion, 1 = calm")
        ->capture_default_str()
        ->type_name("factor");
    sub->add_option("--threads", config->threads, "CPU threads, 0 = all; the pixels do not depend on it")
        ->capture_default_str()
        ->type_name("threads");
    sub->add_flag("--static", *nobody, "a static scene: nobody in it");
    sub->add_flag("--still-camera", config->still_camera, "the camera stands still");
    sub->add_flag("--easy", config->easy, "walks in daylight between walls with texture: hardly any drift");
    sub->add_flag("--no-noise", *clean, "exact depth and clean colour instead of the sensor model");
    sub->callback([=, &exit_code] {
        if (*nobody) config->people = 0;
        config->noise = !*clean;
        config->scenario = scenarios.at(*scenario);
        if (frames->empty()) config->frames = usual_frames(config->scenario);
        exit_code = synth_command(*config);
    });
}

int run_program(int argc, char** argv) {
    int exit_code = kExitOk;
    CLI::App app("Dense RGB-D SLAM for rooms in which people move.", "posefusion");
    app.set_version_flag("--version", "posefusion " POSEFUSION_VERSION);
    app.require_subcommand(1);
    app.get_formatter()->column_width(46);
    app.footer(
        "Exit codes: 0 done, 1 error (one line says which; what was computed is written), 2 wrong command line,\n"
        "130 interrupted by Ctrl-C (what was computed is written).");
    add_run_command(app, "run", "camera trajectory and people-free map of a recording", run_command, exit_code);
#ifdef POSEFUSION_HAS_VIEWER
    add_view_command(app, exit_code);
#endif
    add_run_command(app, "bench", "time per stage on a recording; writes no files", bench_command, exit_code);
    add_record_command(app, exit_code);
    add_evaluate_command(app, exit_code);
    add_export_command(app, exit_code);
    add_synth_command(app, exit_code);
    CLI::App* devices = app.add_subcommand("devices", "Vulkan devices and what each lacks, if anything");
    devices->callback([&] { exit_code = devices_command(); });
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(error);  // --help
        print_error(std::string(error.what()) + "; see `posefusion --help` and `posefusion COMMAND --help`");
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
        if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
            throw Error("the standard output cannot be written; is the disk full?");
        }
        return exit_code;
    } catch (...) {
        print_error(error_text(std::current_exception()));
        return kExitError;
    }
}
