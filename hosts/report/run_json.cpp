#include "hosts/report/run_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "hosts/report/page_text.hpp"
#include "hosts/report/person_colors.hpp"
#include "hosts/report/run_loops.hpp"
#include "hosts/report/run_objects.hpp"
#include "hosts/report/run_pictures.hpp"

namespace posefusion {
namespace {

using Json = nlohmann::ordered_json;

/// Five digits are more than a plot shows; the page stays small.
Json short_number(double value) {
    if (!std::isfinite(value)) return nullptr;
    if (value == 0) return 0;
    const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 4);
    const double rounded = std::round(value / unit) * unit;
    return rounded;
}

template <class Values>
Json numbers(const Values& values) {
    Json list = Json::array();
    for (const auto value : values) list.push_back(short_number(static_cast<double>(value)));
    return list;
}

/// One value per frame, taken out of the engine's results.
template <class Get>
Json per_frame(const std::vector<FrameResult>& frames, Get get) {
    Json list = Json::array();
    for (const FrameResult& frame : frames) list.push_back(short_number(static_cast<double>(get(frame))));
    return list;
}

Json points(const std::vector<Eigen::Vector3d>& positions) {
    Json list = Json::array();
    for (const Eigen::Vector3d& p : positions)
        list.push_back({short_number(p.x()), short_number(p.y()), short_number(p.z())});
    return list;
}

Json objects(const std::vector<ObjectPath>& paths) {
    Json list = Json::array();
    for (const ObjectPath& path : paths)
        list.push_back(
            {{"label", path.label}, {"color", css_color(label_color(path.label))}, {"path", points(path.positions)}});
    return list;
}

Json stages(const std::vector<StageSeries>& series) {
    Json list = Json::array();
    for (const StageSeries& s : series) list.push_back({{"name", s.name}, {"ms", numbers(s.milliseconds)}});
    return list;
}

std::vector<double> relative(const std::vector<Stamp>& stamps, Stamp start) {
    std::vector<double> result;
    for (const Stamp t : stamps) result.push_back(to_seconds(t - start));
    return result;
}

Json errors(const Evaluation& e, Stamp start) {
    Json json{{"ate_t", numbers(relative(e.ate.stamps, start))}, {"ate_m", numbers(e.ate.errors)}};
    if (e.rpe) {
        json["rpe_t"] = numbers(relative(e.rpe->stamps, start));
        json["rpe_m"] = numbers(e.rpe->translation_errors);
        json["rpe_deg"] = numbers(e.rpe->rotation_errors);
    }
    return json;
}

Json per_frame_series(const ReportData& data) {
    const auto ratio = [](const FrameResult& f) {
        return f.valid_pixels == 0 ? std::nan("") : static_cast<double>(f.icp_inliers) / f.valid_pixels;
    };
    return {
        {"inliers", per_frame(data.frames, ratio)},
        {"icp_rmse_m", per_frame(data.frames, [](const FrameResult& f) { return f.icp_rmse_m; })},
        {"photometric_rmse", per_frame(data.frames, [](const FrameResult& f) { return f.photometric_rmse; })},
        {"red", per_frame(data.frames, [](const FrameResult& f) { return f.exposure[0]; })},
        {"green", per_frame(data.frames, [](const FrameResult& f) { return f.exposure[1]; })},
        {"blue", per_frame(data.frames, [](const FrameResult& f) { return f.exposure[2]; })},
        {"surfels", per_frame(data.frames, [](const FrameResult& f) { return f.surfels; })},
        {"stable_surfels", per_frame(data.frames, [](const FrameResult& f) { return f.stable_surfels; })},
        {"device_mib",
         per_frame(data.frames, [](const FrameResult& f) { return static_cast<double>(f.device_bytes) / (1 << 20); })},
        {"keyframes", per_frame(data.frames, [](const FrameResult& f) { return f.keyframes; })},
        {"people", numbers(data.people)}};
}

void put_loops(Json& json, const ReportData& data, const Eigen::Isometry3d& upright) {
    const Eigen::Isometry3d T_upright_world = upright.inverse();
    const auto upright_points = [&](std::vector<Eigen::Vector3d> positions) {
        for (Eigen::Vector3d& p : positions) p = T_upright_world * p;
        return points(positions);
    };
    json["loops"] = Json::array();
    for (const LoopAttempt& attempt : loop_attempts(data))
        json["loops"].push_back(
            {{"frame", attempt.frame}, {"kind", name_of(attempt.event.kind)}, {"accepted", attempt.event.accepted}});
    json["loop_links"] = Json::array();
    for (const LoopLink& link : loop_links(data)) json["loop_links"].push_back(upright_points({link.live, link.model}));
    json["lost"] = Json::array();
    for (const LostInterval& lost : data.lost) json["lost"].push_back({lost.first, lost.last});
    json["keyframes"] = keyframes_of_run(data);
    json["keyframe_positions"] = upright_points(keyframe_positions(data));
}

}  // namespace

std::string run_json(const ReportData& data, const Eigen::Isometry3d& upright) {
    const Stamp start = data.trajectory.empty() ? Stamp{0} : data.trajectory.front().stamp;
    Json json;
    std::vector<double> times;
    for (const StampedPose& pose : data.trajectory) times.push_back(to_seconds(pose.stamp - start));
    const Paths paths = upright_paths(data, upright);
    json["time_s"] = numbers(times);
    json["estimate"] = points(paths.estimate);
    json["groundtruth"] = points(paths.groundtruth);
    json["objects"] = objects(paths.objects);
    if (data.evaluation) json["errors"] = errors(*data.evaluation, start);
    json["host_stages"] = stages(data.host_stages);
    json["gpu_stages"] = stages(data.gpu_stages);
    json["frames"] = per_frame_series(data);
    put_loops(json, data, upright);
    return script_json(json.dump(-1, ' ', true, Json::error_handler_t::replace));
}

}  // namespace posefusion
