#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "engine/core/error.hpp"
#include "hosts/cli/commands.hpp"
#include "hosts/cli/evaluation_picture.hpp"
#include "hosts/evaluate/time_offset.hpp"
#include "hosts/evaluate/trajectory_pair.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/run/console.hpp"

namespace posefusion {
namespace {

/// Without stamps the motion is measured over one frame.
RelativeErrorConfig relative_error(const EvaluateConfig& config, bool timed) {
    RelativeErrorConfig rpe = config.evaluation.rpe;
    if (timed) return rpe;
    if (!config.delta_unit_given) rpe.unit = DeltaUnit::Frames;
    if (rpe.unit == DeltaUnit::Seconds)
        throw Error("the trajectories have no time stamps; give --delta-unit frames, m or deg");
    return rpe;
}

Stamp time_offset(const EvaluateConfig& config, const TrajectoryPair& pair) {
    const bool wanted = config.find_time_offset || config.time_offset != Stamp{0};
    if (wanted && !pair.timed) throw Error("the trajectories have no time stamps; leave out --time-offset");
    if (!config.find_time_offset) return config.time_offset;
    TimeOffsetConfig search;
    search.scale = config.evaluation.alignment.scale;
    return find_time_offset(pair.groundtruth.poses, pair.estimate.poses, search);
}

nlohmann::ordered_json to_json(const std::filesystem::path& file, const TrajectoryFile& trajectory) {
    return {{"file", file.string()},
            {"format", name_of(trajectory.format)},
            {"time_unit", trajectory.unit ? nlohmann::ordered_json(symbol_of(*trajectory.unit)) : nullptr},
            {"poses", trajectory.poses.size()}};
}

std::string line(const char* what, const TrajectoryFile& trajectory) {
    return fmt::format("{:<13} {}, {} poses\n", what, trajectory.description(), trajectory.poses.size());
}

/// How the estimate was aligned and matched, where it differs from the default.
std::string choices(const Evaluation& evaluation, Stamp offset) {
    std::string text;
    if (offset != Stamp{0}) text += fmt::format("time offset   {} s added to the estimate\n", seconds_text(offset));
    if (evaluation.config.alignment.rule != AlignmentRule::Rigid)
        text += fmt::format("alignment     {}\n", name_of(evaluation.config.alignment.rule));
    if (evaluation.config.alignment.scale) text += fmt::format("scale         {:.6f}\n", evaluation.ate.scale);
    return text;
}

}  // namespace

int evaluate_command(const EvaluateConfig& config) {
    TrajectoryPair pair = read_trajectory_pair(config.groundtruth, config.estimate, config.time_unit);
    Console console;
    for (const TrajectoryFile* file : {&pair.groundtruth, &pair.estimate})
        for (const std::string& text : file->warnings) console.warning(text);
    EvaluationConfig evaluation_config = config.evaluation;
    evaluation_config.rpe = relative_error(config, pair.timed);
    const Stamp offset = time_offset(config, pair);
    pair.estimate.poses = shifted(std::move(pair.estimate.poses), offset);
    Evaluation evaluation = evaluate(pair.groundtruth.poses, pair.estimate.poses, evaluation_config);
    if (!pair.timed) evaluation.duration.reset();
    if (!config.plot.empty())
        write_png(config.plot, evaluation_picture(pair.groundtruth.poses, pair.estimate.poses, evaluation));
    if (config.json) {
        auto json = nlohmann::ordered_json::parse(evaluation_json(evaluation));
        json["time_offset_s"] = to_seconds(offset);
        json["groundtruth"] = to_json(config.groundtruth, pair.groundtruth);
        json["estimate"] = to_json(config.estimate, pair.estimate);
        fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    } else {
        fmt::print("{}{}{}{}", line("ground truth", pair.groundtruth), line("estimate", pair.estimate),
                   choices(evaluation, offset), evaluation_table(evaluation));
    }
    return kExitOk;
}

}  // namespace posefusion
