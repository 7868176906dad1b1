#include "hosts/run/finished_run.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

#include "engine/core/error.hpp"
#include "hosts/config/config_file.hpp"
#include "hosts/run/run_session.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

fs::path present_recording_of(const fs::path& folder) {
    const fs::path recording = recording_of_run(folder);
    if (recording.empty())
        throw Error((folder / "stats.json").string() +
                    ": does not say which recording was run; give it with --recording PATH");
    if (is_camera(recording))
        throw Error(folder.string() +
                    ": is the run of a camera, whose images are gone; record them first with "
                    "`posefusion record`, and run the recording");
    std::error_code error;
    if (!fs::exists(recording, error))
        throw Error(recording.string() +
                    ": the recording of the run is not there (any more); give its place with "
                    "--recording PATH");
    return recording;
}

}  // namespace

bool FinishedRun::saved_masks() const {
    std::error_code error;
    return config.save_masks && fs::is_directory(masks(), error);
}

SourceOptions FinishedRun::source_options() const {
    SourceOptions options = posefusion::source_options(config);
    options.scale = 1;
    const fs::path refined = folder / "camera_refined.yaml";
    std::error_code error;
    if (fs::exists(refined, error)) options.calibrated = read_camera_file(refined);
    return options;
}

fs::path recording_of_run(const fs::path& folder) {
    std::ifstream stream(folder / "stats.json");
    const auto stats = nlohmann::json::parse(stream, nullptr, false);
    const auto place = nlohmann::json::json_pointer("/recording/folder");
    if (stats.is_discarded() || !stats.contains(place) || !stats[place].is_string()) return {};
    return stats[place].get<std::string>();
}

FinishedRun read_finished_run(const fs::path& folder, const fs::path& recording) {
    FinishedRun run;
    run.folder = folder;
    const fs::path configuration = folder / "config.yaml";
    std::error_code error;
    if (!fs::is_directory(folder, error) || !fs::exists(configuration, error))
        throw Error(folder.string() + ": is not the output folder of `posefusion run`, which has a config.yaml");
    load_config(configuration, option_table(run.config));
    TrajectoryFile trajectory = read_trajectory_file(folder / "trajectory.txt");
    run.trajectory = std::move(trajectory.poses);
    run.warnings = std::move(trajectory.warnings);
    run.recording = recording.empty() ? present_recording_of(folder) : recording;
    return run;
}

}  // namespace posefusion
