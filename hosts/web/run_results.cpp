#include "hosts/web/run_results.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kSameStamp = 1e-6;  // s; stats.json writes stamps as doubles
constexpr double kCentimetres = 100;

/// The frame of stats.json with the stamp of each pose; frames without a pose are in between.
std::vector<std::size_t> frames_of_poses(const Trajectory& trajectory, const Json& frames, const fs::path& file) {
    std::vector<std::size_t> numbers;
    std::size_t frame = 0;
    for (const StampedPose& pose : trajectory) {
        const double stamp = to_seconds(pose.stamp);
        while (frame < frames.size() && frames[frame].at("stamp").get<double>() < stamp - kSameStamp) ++frame;
        if (frame == frames.size() || frames[frame].at("stamp").get<double>() > stamp + kSameStamp)
            throw Error(file.string() + ": is of another run than trajectory.txt beside it, which has a pose at " +
                        seconds_text(pose.stamp) + " s");
        numbers.push_back(frame++);
    }
    return numbers;
}

/// A frame became a keyframe where their number grew; those without a pose cannot be shown.
std::vector<std::size_t> keyframe_poses(const std::vector<std::size_t>& frames_of_poses, const Json& frames) {
    std::vector<std::size_t> keyframes;
    const auto count = [&](std::size_t frame) { return frames[frame].value("keyframes", std::size_t{0}); };
    for (std::size_t pose = 0; pose < frames_of_poses.size(); ++pose) {
        const std::size_t frame = frames_of_poses[pose], before = frame == 0 ? 0 : count(frame - 1);
        if (count(frame) > before) keyframes.push_back(pose);
    }
    return keyframes;
}

std::optional<Intrinsics> camera_of(const Json& recording) {
    if (!recording.contains("fx")) return std::nullopt;
    Intrinsics camera;
    camera.width = recording.at("width").get<int>();
    camera.height = recording.at("height").get<int>();
    camera.fx = recording.at("fx").get<float>();
    camera.fy = recording.at("fy").get<float>();
    camera.cx = recording.at("cx").get<float>();
    camera.cy = recording.at("cy").get<float>();
    const bool usable = camera.width > 0 && camera.height > 0 && camera.fx > 0 && camera.fy > 0;
    return usable ? std::optional(camera) : std::nullopt;
}

double path_length(const Trajectory& trajectory) {
    double length = 0;
    for (std::size_t i = 1; i < trajectory.size(); ++i)
        length += (trajectory[i].T_world_camera.translation() - trajectory[i - 1].T_world_camera.translation()).norm();
    return length;
}

void put_trajectory_facts(RunResults& results) {
    const Trajectory& path = results.trajectory;
    results.facts.emplace_back("Duration", fixed_text(to_seconds(path.back().stamp - path.front().stamp), 1) + " s");
    results.facts.emplace_back("Frames", std::to_string(results.frames_of_run));
    if (path.size() < results.frames_of_run)
        results.facts.emplace_back("Without tracking", std::to_string(results.frames_of_run - path.size()));
    results.facts.emplace_back("Camera path", fixed_text(path_length(path), 2) + " m");
}

void put_run_facts(RunResults& results, const Json& stats) {
    const Json summary = stats.value("summary", Json::object());
    const auto put_count = [&](const char* name, const char* key) {
        if (const auto count = summary.value(key, 0L); count > 0)
            results.facts.emplace_back(name, std::to_string(count));
    };
    put_count("Loops closed", "loops_closed");
    put_count("Frames with people", "frames_with_people");
    if (const Json evaluation = stats.value("evaluation", Json()); evaluation.is_object()) {
        const double rmse = evaluation.at("ate").at("translation_m").at("rmse").get<double>();
        results.facts.emplace_back("ATE RMSE", fixed_text(kCentimetres * rmse, 2) + " cm");
    }
    if (const std::string status = stats.value("status", ""); status != "finished")
        results.facts.emplace_back("Run", status);
}

void take_stats(RunResults& results, const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw Error(file.string() + ": cannot be read");
    try {
        const Json stats = Json::parse(in);
        const Json& frames = stats.at("frames");
        results.frames_of_run = frames.size();
        results.frames = frames_of_poses(results.trajectory, frames, file);
        results.keyframes = keyframe_poses(results.frames, frames);
        results.camera = camera_of(stats.at("recording"));
        put_trajectory_facts(results);
        put_run_facts(results, stats);
    } catch (const Json::exception&) {
        throw Error(file.string() + ": is not what `posefusion run` writes; run it again, or export map.ply alone");
    }
}

}  // namespace

RunResults read_run_results(const fs::path& folder) {
    RunResults results;
    results.trajectory = read_trajectory(folder / "trajectory.txt");
    if (const fs::path people = folder / "people.json"; fs::exists(people)) results.people = read_people(people);
    const fs::path stats = folder / "stats.json";
    if (fs::exists(stats)) {
        take_stats(results, stats);
        return results;
    }
    results.frames_of_run = results.trajectory.size();
    for (std::size_t i = 0; i < results.frames_of_run; ++i) results.frames.push_back(i);
    put_trajectory_facts(results);
    return results;
}

}  // namespace posefusion
