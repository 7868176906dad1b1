#include "hosts/run/stats_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

namespace posefusion {
namespace {

using Json = nlohmann::ordered_json;

/// Milliseconds, rounded to microseconds; null if not measured.
Json milliseconds(double value) { return std::isnan(value) ? Json() : Json(std::round(value * 1000) / 1000); }
Json milliseconds(const std::optional<double>& value) { return value ? milliseconds(*value) : Json(); }

/// A float without the extra digits of its conversion to double.
Json shortest(float value) { return Json::parse(fmt::format("{}", value), nullptr, false); }

Json summary_json(const TimeSummary& summary) {
    return {{"frames", summary.count},
            {"median_ms", milliseconds(summary.median)},
            {"mean_ms", milliseconds(summary.mean)},
            {"p95_ms", milliseconds(summary.p95)}};
}

Json stages_json(const std::vector<StageSeries>& stages) {
    Json out = Json::object();
    for (const StageSeries& stage : stages) out[stage.name] = summary_json(summarize(stage.milliseconds));
    return out;
}

Json device_json(const DeviceInfo& device) {
    return {{"name", device.name},
            {"kind", device.kind},
            {"driver", device.driver},
            {"vulkan", device.api_version},
            {"memory_bytes", device.memory_bytes},
            {"subgroup_size", device.subgroup_size},
            {"int64_atomics", device.int64_atomics}};
}

/// A recording wherever it is looked for from; a camera by its address.
std::string place_of(const Recording& recording) {
    return recording.live() ? recording.location() : std::filesystem::absolute(recording.location()).string();
}

Json recording_json(const Recording& recording) {
    const Intrinsics& camera = recording.intrinsics();
    return {{"folder", place_of(recording)},
            {"frames", recording.size() == FrameSource::kEndless ? Json(nullptr) : Json(recording.size())},
            {"width", camera.width},
            {"height", camera.height},
            {"fx", shortest(camera.fx)},
            {"fy", shortest(camera.fy)},
            {"cx", shortest(camera.cx)},
            {"cy", shortest(camera.cy)}};
}

Json configuration_json(const std::vector<Option>& options) {
    Json out = Json::object();
    for (const Option& option : options) {
        Json& group = option.group().empty() ? out : out[option.group()];
        const std::string value = option.get();
        switch (option.kind) {
            case Option::Kind::Text:
            case Option::Kind::Choice:
                group[option.name()] = value;
                break;
            case Option::Kind::List:
                group[option.name()] = Json::parse("[" + value + "]");
                break;
            case Option::Kind::Switch:
            case Option::Kind::Number:
                group[option.name()] = Json::parse(value);
        }
    }
    return out;
}

Json loop_json(const LoopEvent& event) {
    return {{"frame", event.frame},
            {"kind", name_of(event.kind)},
            {"model_frame", event.model_frame},
            {"accepted", event.accepted},
            {"reason", event.reason},
            {"overlap", shortest(event.overlap)},
            {"inlier_ratio", shortest(event.inlier_ratio)},
            {"icp_rmse_m", shortest(event.icp_rmse_m)},
            {"photometric_rmse", shortest(event.photometric_rmse)},
            {"correlation", shortest(event.correlation)},
            {"residual_before_m", event.residual_before_m},
            {"residual_after_m", event.residual_after_m},
            {"nodes", event.nodes},
            {"milliseconds", milliseconds(event.milliseconds)},
            {"solve_ms", milliseconds(event.solve_milliseconds)}};
}

Json lost_intervals_json(const std::vector<LostInterval>& intervals) {
    Json out = Json::array();
    for (const LostInterval& lost : intervals)
        out.push_back({{"first_frame", lost.first}, {"last_frame", lost.last}, {"found_again", lost.found_again}});
    return out;
}

/// The first is that of trajectory.txt and map.ply.
Json pieces_json(const RunRecord& record) {
    Json out = Json::array();
    for (const PieceRecord& piece : record.pieces) {
        Json entry = {{"frames", piece.frames.size()}, {"tracked", record.tracked(piece)}};
        if (!piece.frames.empty()) {
            entry["first_frame"] = piece.frames.front();
            entry["last_frame"] = piece.frames.back();
        }
        out.push_back(std::move(entry));
    }
    return out;
}

/// The rigid things that moved, by label.
Json objects_json(const RunRecord& record) {
    struct Seen {
        std::size_t frames = 0, first = 0, last = 0;
    };
    std::map<int, Seen> seen;
    for (std::size_t i = 0; i < record.frames.size(); ++i)
        for (const MovingObject& object : record.frames[i].result.objects) {
            Seen& entry = seen[object.label];
            if (entry.frames++ == 0) entry.first = i;
            entry.last = i;
        }
    Json out = Json::array();
    for (const auto& [label, entry] : seen)
        out.push_back(
            {{"label", label}, {"frames", entry.frames}, {"first_frame", entry.first}, {"last_frame", entry.last}});
    return out;
}

Json frame_json(const FrameRecord& frame) {
    const FrameResult& result = frame.result;
    Json gpu = Json::object(), objects = Json::array();
    for (const MovingObject& object : result.objects) objects.push_back(object.label);
    for (const StageTime& time : result.gpu_times) {
        gpu[time.name] = milliseconds(gpu.value(time.name, 0.0) + time.milliseconds);
    }
    return {{"stamp", to_seconds(frame.stamp)},
            {"index", frame.index},
            {"tracking", name_of(result.tracking)},
            {"people", frame.people},
            {"people_carried", frame.carried},
            {"moving_share", shortest(result.moving_share)},
            {"objects", objects},
            {"icp_inliers", result.icp_inliers},
            {"icp_rmse_m", shortest(result.icp_rmse_m)},
            {"photometric_inliers", result.photometric_inliers},
            {"photometric_rmse", shortest(result.photometric_rmse)},
            {"exposure", {shortest(result.exposure[0]), shortest(result.exposure[1]), shortest(result.exposure[2])}},
            {"valid_pixels", result.valid_pixels},
            {"iterations", result.iterations},
            {"start_inliers", result.start_inliers},
            {"start_used", result.start_used},
            {"surfels", result.surfels},
            {"stable_surfels", result.stable_surfels},
            {"keyframes", result.keyframes},
            {"device_bytes", result.device_bytes},
            {"read_ms", milliseconds(frame.read_ms)},
            {"joints_ms", milliseconds(frame.joints_ms)},
            {"segmentation_ms", milliseconds(frame.segmentation_ms)},
            {"features_ms", milliseconds(frame.features_ms)},
            {"slam_ms", milliseconds(frame.slam_ms)},
            {"latency_ms", milliseconds(frame.latency_ms)},
            {"frame_ms", milliseconds(frame.interval_ms)},
            {"gpu_ms", gpu}};
}

Json summary_of_run(const RunRecord& record) {
    const FrameRecord& last = record.frames.back();
    const auto count = [&](auto&& predicate) {
        return std::count_if(record.frames.begin(), record.frames.end(), predicate);
    };
    std::size_t loops_closed = 0;
    for (const FrameRecord& frame : record.frames) {
        loops_closed +=
            static_cast<std::size_t>(std::count_if(frame.result.loops.begin(), frame.result.loops.end(),
                                                   [](const LoopEvent& event) { return event.closes_loop(); }));
    }
    Json summary = {
        {"frames", record.frames.size()},
        {"wall_seconds", record.wall_seconds},
        {"frame_time", summary_json(summarize(record.intervals()))},
        {"surfels", record.surfels},
        {"stable_surfels", record.stable_surfels},
        {"tracking_failures", count([](const auto& f) { return !has_pose(f.result.tracking); })},
        {"loops_closed", loops_closed},
        {"relocalisations", count([](const auto& f) { return f.result.tracking == TrackingState::Relocalised; })},
        {"sparse_starts", count([](const auto& f) { return f.result.start_used; })},
        {"keyframes", last.result.keyframes},
        {"frames_with_people", count([](const auto& f) { return f.people > 0; })},
        {"frames_with_movers", count([](const auto& f) { return f.result.moving_share > 0; })},
        {"peak_memory_bytes", record.peak_memory_bytes},
        {"device_bytes", last.result.device_bytes}};
    if (record.dropped) summary["dropped_frames"] = *record.dropped;
    summary["skipped_frames"] = record.skipped;
    return summary;
}

/// Milliseconds.
Json sensor_json(const FoundTiming& sensor) {
    const auto times = [](const SensorTimes& seconds) {
        const auto ms = [&](int i) { return std::round(1e4 * seconds[i]) / 10; };
        return Json{{"depth_delay_ms", ms(0)}, {"depth_readout_ms", ms(1)}, {"color_readout_ms", ms(2)}};
    };
    return {{"corrected", !sensor.shutter.is_global()},
            {"estimate", times(sensor.estimate.times)},
            {"standard_deviation", times(sensor.estimate.sigma)},
            {"pairs_of_frames", sensor.estimate.pairs}};
}

/// Pixels of the images that it was found in, and 1/m.
Json calibration_json(const FoundCalibration& found) {
    const Calibration& c = found.calibration;
    const auto list = [](const auto& values) {
        Json out = Json::array();
        for (const double value : values) out.push_back(std::round(value * 1e5) / 1e5);
        return out;
    };
    const CameraParameters sigma = c.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    return {{"corrected", found.camera.has_value()},
            {"corrects", {{"intrinsics", c.intrinsics}, {"deformation", c.deformation}, {"times", c.times}}},
            {"keyframes", c.keyframes},
            {"landmarks", c.landmarks},
            {"observations", c.observations},
            {"image", {found.image.width, found.image.height}},
            {"variance", c.variance},
            {"held_out_before", c.held_out_before},
            {"held_out", c.held_out},
            {"agreement", found.agreement},
            {"intrinsics",
             {{"given", list(intrinsics_part(c.given))},
              {"estimate", list(intrinsics_part(c.estimate))},
              {"standard_deviation", list(intrinsics_part(sigma))}}},
            {"deformation",
             {{"estimate", list(deformation_part(c.estimate))}, {"standard_deviation", list(deformation_part(sigma))}}},
            {"times_ms",
             {{"given", list(1e3 * times_part(c.given))},
              {"estimate", list(1e3 * times_part(c.estimate))},
              {"standard_deviation", list(1e3 * times_part(sigma))}}}};
}

const char* name_of(Way way) { return way == Way::Straight ? "straight" : "smooth"; }

Json adjustment_json(const FinalAdjustment& adjustment) {
    Json out{{"used", !adjustment.poses.empty()},
             {"keyframes", adjustment.keyframes},
             {"landmarks", adjustment.landmarks},
             {"observations", adjustment.observations},
             {"way", name_of(adjustment.way)},
             {"frames_placed", adjustment.placed},
             {"held_out_before", adjustment.held_out_before},
             {"held_out", adjustment.held_out},
             {"mean_change_m", adjustment.mean_change_m},
             {"largest_change_m", adjustment.largest_change_m}};
    if (adjustment.times)
        out["times_ms"] = {{"depth_delay", 1e3 * adjustment.times->depth_delay},
                           {"depth_readout", 1e3 * adjustment.times->depth_readout},
                           {"color_readout", 1e3 * adjustment.times->color_readout}};
    if (!adjustment.reason.empty()) out["reason"] = adjustment.reason;
    return out;
}

const char* status_name(RunStatus status) {
    switch (status) {
        case RunStatus::Finished:
            return "finished";
        case RunStatus::Interrupted:
            return "interrupted";
        case RunStatus::Failed:
            return "failed";
    }
    return "";
}

}  // namespace

std::string stats_json(const RunRecord& record, const Recording& recording, const std::vector<Option>& options,
                       const std::optional<Evaluation>& evaluation) {
    Json out;
    out["posefusion"] = POSEFUSION_VERSION;
    out["status"] = status_name(record.status);
    if (!record.error.empty()) out["error"] = record.error;
    out["pieces"] = pieces_json(record);
    out["recording"] = recording_json(recording);
    out["device"] = device_json(record.device);
    out["people"] = record.people_description;
    if (record.sensor) out["sensor"] = sensor_json(*record.sensor);
    if (record.calibration) out["calibration"] = calibration_json(*record.calibration);
    if (record.adjustment) out["adjustment"] = adjustment_json(*record.adjustment);
    if (!record.frames.empty()) out["summary"] = summary_of_run(record);
    if (evaluation) out["evaluation"] = Json::parse(evaluation_json(*evaluation));
    out["stages"] = {{"host", stages_json(record.host_stages())}, {"gpu", stages_json(record.gpu_stages())}};
    out["warnings"] = record.warnings;
    out["configuration"] = configuration_json(options);
    out["loops"] = Json::array();
    for (const FrameRecord& frame : record.frames) {
        for (const LoopEvent& event : frame.result.loops) out["loops"].push_back(loop_json(event));
    }
    out["lost"] = lost_intervals_json(record.lost_intervals());
    out["objects"] = objects_json(record);
    out["frames"] = Json::array();
    for (const FrameRecord& frame : record.frames) out["frames"].push_back(frame_json(frame));
    return out.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string failure_json(const std::string& recording, const std::string& error, const std::vector<Option>& options) {
    Json out;
    out["posefusion"] = POSEFUSION_VERSION;
    out["status"] = status_name(RunStatus::Failed);
    out["error"] = error;
    out["recording"] = {{"folder", recording}};
    out["warnings"] = Json::array();
    out["configuration"] = configuration_json(options);
    out["frames"] = Json::array();
    return out.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace posefusion
