#include "hosts/report/report.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numeric>
#include <string_view>

#include "engine/core/installed_file.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/report/html.hpp"
#include "hosts/report/loop_picture.hpp"
#include "hosts/report/page_assets.hpp"
#include "hosts/report/page_text.hpp"
#include "hosts/report/run_json.hpp"
#include "hosts/report/run_loops.hpp"
#include "hosts/report/run_objects.hpp"
#include "hosts/report/run_pictures.hpp"
#include "hosts/report/upright.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;
constexpr int kJpegQuality = 88;
constexpr const char* kLoopPictureName = "loops.png";

std::string_view asset(std::string_view name) { return text_of(report_page_assets(), name); }

std::string read_if_there(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

double median(std::vector<double> values) {
    values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }),
                 values.end());
    return error_statistics(std::move(values)).median;
}

/// 1234567 as 1 234 567, with narrow no-break spaces.
std::string grouped(std::size_t number) {
    std::string digits = std::to_string(number);
    for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, "\xE2\x80\xAF");
    return digits;
}

std::string tile(const std::string& value, const char* meaning) {
    return "<div class=\"tile\"><b>" + escaped(value) + "</b><span>" + escaped(meaning) + "</span></div>\n";
}

/// Sum of the GPU stages, frame by frame.
std::vector<double> gpu_totals(const ReportData& data) {
    std::vector<double> totals;
    for (const StageSeries& stage : data.gpu_stages) {
        totals.resize(std::max(totals.size(), stage.milliseconds.size()), 0.0);
        for (std::size_t i = 0; i < stage.milliseconds.size(); ++i)
            if (std::isfinite(stage.milliseconds[i])) totals[i] += stage.milliseconds[i];
    }
    return totals;
}

std::string tiles(const ReportData& data) {
    std::string html = tile(std::to_string(data.trajectory.size()), "frames");
    if (data.evaluation) {
        html += tile(fixed_text(100 * data.evaluation->ate.translation.rmse, 2) + " cm", "ATE RMSE");
        if (data.evaluation->rpe) {
            html +=
                tile(fixed_text(100 * data.evaluation->rpe->translation.rmse, 2) + " cm/s", "RPE RMSE, translation");
            html += tile(fixed_text(data.evaluation->rpe->rotation.rmse, 2) + " \xC2\xB0/s", "RPE RMSE, rotation");
        }
    }
    html += tile(grouped(data.map.size()), "stable surfels");
    if (!data.keyframes.empty()) html += tile(grouped(data.keyframes.size()), "keyframes");
    if (const std::size_t links = loop_links(data).size(); links > 0)
        html += tile(std::to_string(links), "loops closed");
    std::size_t lost = 0;
    for (const LostInterval& interval : data.lost) lost += interval.frames();
    if (lost > 0) html += tile(std::to_string(lost), "frames without tracking");
    if (!data.people.empty())
        html += tile(std::to_string(*std::max_element(data.people.begin(), data.people.end())),
                     "people at most in a frame");
    if (!data.objects.empty()) html += tile(std::to_string(data.objects.size()), "objects that moved");
    if (const auto totals = gpu_totals(data); !totals.empty())
        html += tile(fixed_text(median(totals), 0) + " ms", "GPU per frame, median");
    return html;
}

std::string warnings(const ReportData& data) {
    if (data.warnings.empty()) return {};
    std::string html = "<section class=\"warnings\"><h2>Warnings</h2>\n<ul>\n";
    for (const std::string& w : data.warnings) html += "<li>" + escaped(w) + "</li>\n";
    return html + "</ul></section>\n";
}

std::string error_row(const char* name, const ErrorStatistics& s, double factor, const char* unit) {
    std::string html = std::string("<tr><td>") + name + "</td>";
    for (const double value : {s.rmse, s.mean, s.median, s.std, s.min, s.max})
        html += "<td class=\"number\">" + fixed_text(factor * value, 3) + "</td>";
    return html + "<td>" + unit + "</td></tr>\n";
}

std::string error_table(const ReportData& data) {
    if (!data.evaluation) return "<p>No ground truth to compare with.</p>\n";
    std::string html = "<table><tr><th></th>";
    for (const char* column : {"RMSE", "mean", "median", "std", "min", "max"})
        html += std::string("<th class=\"number\">") + column + "</th>";
    html += "<th></th></tr>\n" + error_row("ATE translation", data.evaluation->ate.translation, 100, "cm");
    if (data.evaluation->rpe) {
        html += error_row("RPE translation", data.evaluation->rpe->translation, 100, "cm/s");
        html += error_row("RPE rotation", data.evaluation->rpe->rotation, 1, "\xC2\xB0/s");
    }
    return html + "</table>\n";
}

std::string data_url(const char* type, const std::string& bytes) {
    return std::string("data:image/") + type + ";base64," + base64(bytes);
}

std::string samples(const ReportData& data) {
    if (data.samples.empty()) return {};
    const Stamp start = data.trajectory.empty() ? Stamp{0} : data.trajectory.front().stamp;
    std::string html = "<section>\n<h2>People found</h2>\n<div class=\"samples\">\n";
    for (const SampleFrame& s : data.samples) {
        const std::string picture = encode_jpeg(draw_people(s.color, s.labels, s.people), kJpegQuality);
        html += "<figure><img loading=\"lazy\" alt=\"Sample frame\" src=\"" + data_url("jpeg", picture) +
                "\"><figcaption>frame " + std::to_string(s.index) + ", " + fixed_text(to_seconds(s.stamp - start), 2) +
                " s" + "</figcaption></figure>\n";
    }
    return html + "</div>\n</section>\n";
}

std::string facts(const ReportData& data) {
    std::string html = "<table>\n";
    for (const auto& [name, value] : data.facts)
        html += "<tr><td>" + escaped(name) + "</td><td>" + escaped(value) + "</td></tr>\n";
    return html + "</table>\n";
}

std::string configuration(const ReportData& data) {
    if (data.configuration.empty()) return {};
    return "<details><summary>Configuration</summary><pre>" + escaped(data.configuration) + "</pre></details>\n";
}

constexpr const char* kChartLibraryName = "chart.umd.js";

/// Chart.js as installed along with the program, else where tools/setup put it.
fs::path default_chart_library() {
    return installed_file(&kChartLibraryName, kChartLibraryName).value_or(fs::path(POSEFUSION_CHART_LIBRARY));
}

}  // namespace

std::vector<std::string> write_report(const fs::path& folder, const ReportData& data, const fs::path& chart_library) {
    const Eigen::Isometry3d upright = upright_axes(data.map, data.trajectory);
    std::vector<std::string> pictures;
    const auto write_picture = [&](const char* name, const ColorImage& picture) {
        const std::string png = encode_png(picture);
        write_file_atomically(folder / name, png);
        pictures.emplace_back(name);
        return png;
    };
    const std::string trajectory =
        write_picture("trajectory.png", trajectory_picture(data, upright_paths(data, upright)));
    const ColorImage overview = map_overview(data.map, upright), view = map_from_start(data.map, data);
    write_picture("map.png", overview);
    write_picture("map_view.png", view);
    std::string loops;  // a figure
    if (has_loop_picture(data)) {
        loops = "<figure><img src=\"" +
                data_url("png", write_picture(kLoopPictureName, loop_picture(data, upright).image)) +
                "\" alt=\"Loops over the map\"><figcaption>From above: the camera's path, its keyframes, and what "
                "loops changed in the map</figcaption></figure>\n";
    } else {
        std::error_code none;
        fs::remove(folder / kLoopPictureName, none);  // of an earlier run
    }

    const fs::path library = chart_library.empty() ? default_chart_library() : chart_library;
    write_file_atomically(
        folder / "report.html",
        fill(asset("page.html"), {{"recording", escaped(data.recording)},
                                  {"css", std::string(asset("page.css"))},
                                  {"js", std::string(asset("page.js"))},
                                  {"tiles", tiles(data)},
                                  {"warnings", warnings(data)},
                                  {"map_overview", data_url("jpeg", encode_jpeg(overview, kJpegQuality))},
                                  {"map_view", data_url("jpeg", encode_jpeg(view, kJpegQuality))},
                                  {"trajectory", data_url("png", trajectory)},
                                  {"errors", error_table(data)},
                                  {"marks", marks_html(data)},
                                  {"objects", objects_html(data)},
                                  {"loops", loops_html(data, loops)},
                                  {"samples", samples(data)},
                                  {"facts", facts(data)},
                                  {"configuration", configuration(data)},
                                  {"run", run_json(data, upright)},
                                  {"chart_library", read_if_there(library)}}));
    return pictures;
}

}  // namespace posefusion
