#include "hosts/report/loop_picture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/core/number_text.hpp"
#include "engine/core/pinhole.hpp"
#include "hosts/report/html.hpp"
#include "hosts/report/map_renderer.hpp"
#include "hosts/report/run_loops.hpp"
#include "hosts/report/scalar.hpp"

namespace posefusion {
namespace {

constexpr int kWidth = 1200, kHeight = 900, kLegend = 64;     // pixels
constexpr double kFieldOfView = 25 * std::numbers::pi / 180;  // across; a narrow one keeps walls from leaning outwards
constexpr double kElevation = 65 * std::numbers::pi / 180;    // of the eye; walls show a little
constexpr float kFaded = 0.35f;                               // share of white in the map
constexpr int kFractionBits = 4;                              // of a pixel, of what OpenCV draws
constexpr int kLegendFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kLegendSize = 0.45;
const cv::Scalar kLegendColor(40, 40, 40);

Intrinsics picture_camera() {
    const float f = static_cast<float>(kWidth / 2.0 / std::tan(kFieldOfView / 2));
    return {f, f, static_cast<float>(kWidth - 1) / 2, static_cast<float>(kHeight - 1) / 2, kWidth, kHeight};
}

/// From not moved to moved farthest, BGR.
const cv::Mat& displacement_scale() {
    static const cv::Mat scale = [] {
        cv::Mat ramp(256, 1, CV_8U), colors;
        for (int i = 0; i < ramp.rows; ++i) ramp.at<std::uint8_t>(i) = static_cast<std::uint8_t>(i);
        cv::applyColorMap(ramp, colors, cv::COLORMAP_PLASMA);
        return colors;
    }();
    return scale;
}

class Drawing {
public:
    Drawing(const ColorImage& map, const Intrinsics& camera, const Eigen::Isometry3d& T_world_camera)
        : K_(camera),
          T_camera_world_(T_world_camera.inverse()),
          picture_(map.width(), map.height() + kLegend, {255, 255, 255}),
          image_(picture_.height(), picture_.width(), CV_8UC3, picture_.data()),
          over_map_(image_(cv::Rect(0, 0, map.width(), map.height()))) {
        for (std::size_t i = 0; i < map.size(); ++i) picture_[i] = {fade(map[i].r), fade(map[i].g), fade(map[i].b)};
    }

    void line(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Rgb8 color, int thickness) {
        cv::line(over_map_, pixel(a), pixel(b), scalar(color), thickness, cv::LINE_AA, kFractionBits);
    }
    void disc(const Eigen::Vector3d& at, int radius, Rgb8 color) { disc_at(over_map_, pixel(at), radius, color); }
    void ring(const Eigen::Vector3d& at, int radius, Rgb8 color) {
        cv::circle(over_map_, pixel(at), radius << kFractionBits, scalar(color), 2, cv::LINE_AA, kFractionBits);
    }

    // The legend, from left to right.
    void explain_line(const std::string& text, Rgb8 color, int thickness) {
        cv::line(image_, {u_, kMiddle}, {u_ + 24, kMiddle}, scalar(color), thickness, cv::LINE_AA);
        explain(30, text);
    }
    void explain_disc(const std::string& text, int radius, Rgb8 color) {
        disc_at(image_, {(u_ + 6) << kFractionBits, kMiddle << kFractionBits}, radius, color);
        explain(16, text);
    }
    void explain_ring(const std::string& text, int radius, Rgb8 color) {
        cv::circle(image_, {u_ + 6, kMiddle}, radius, scalar(color), 2, cv::LINE_AA);
        explain(22, text);
    }
    /// @param text  ends with what the least colour stands for
    void explain_scale(const std::string& text, const std::string& most) {
        constexpr int kScale = 100;
        explain(0, text);
        u_ -= 12;
        for (int i = 0; i < kScale; ++i)
            cv::line(image_, {u_ + i, kMiddle - 6}, {u_ + i, kMiddle + 6},
                     scalar(displacement_color(i / (kScale - 1.0))));
        explain(kScale + 8, most);
    }

    /// One metre in pixels, at the distance of the point: above the legend, which may be full.
    void explain_metre(const Eigen::Vector3d& at) {
        constexpr int kRow = kHeight - 16;
        const int length = static_cast<int>(std::lround(K_.fx / (T_camera_world_ * at).z())), end = over_map_.cols - 16;
        for (const int u : {end - length, end}) cv::line(image_, {u, kRow - 5}, {u, kRow + 5}, kLegendColor);
        cv::line(image_, {end - length, kRow}, {end, kRow}, kLegendColor);
        cv::putText(image_, "1 m", {end - length - 34, kRow + 5}, kLegendFont, kLegendSize, kLegendColor, 1,
                    cv::LINE_AA);
    }

    [[nodiscard]] const ColorImage& picture() const { return picture_; }

private:
    static constexpr int kMiddle = kHeight + kLegend / 2;

    static std::uint8_t fade(std::uint8_t value) {
        return static_cast<std::uint8_t>(std::lround((1 - kFaded) * static_cast<float>(value) + kFaded * 255));
    }
    /// Converts to fractions of a pixel.
    [[nodiscard]] cv::Point pixel(const Eigen::Vector3d& point) const {
        constexpr double kUnit = 1 << kFractionBits;
        const Eigen::Vector2d at = kUnit * project(T_camera_world_ * point, K_);
        return {static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y()))};
    }
    static void disc_at(cv::Mat& image, cv::Point at, int radius, Rgb8 color) {
        cv::circle(image, at, (radius + 1) << kFractionBits, cv::Scalar(255, 255, 255), cv::FILLED, cv::LINE_AA,
                   kFractionBits);
        cv::circle(image, at, radius << kFractionBits, scalar(color), cv::FILLED, cv::LINE_AA, kFractionBits);
    }
    void explain(int symbol, const std::string& text) {
        int baseline = 0;
        u_ += symbol;
        cv::putText(image_, text, {u_, kMiddle + 5}, kLegendFont, kLegendSize, kLegendColor, 1, cv::LINE_AA);
        u_ += cv::getTextSize(text, kLegendFont, kLegendSize, 1, &baseline).width + 20;
    }

    Intrinsics K_;
    Eigen::Isometry3d T_camera_world_;
    ColorImage picture_;
    cv::Mat image_, over_map_;  // its pixels, RGB: all, and without the legend
    int u_ = 16;                // x of the next entry of the legend
};

void draw_graph(Drawing& drawing, const LoopGraph& graph, double longest) {
    const auto color = [&](const LoopGraph::Node& node) {
        return displacement_color(longest > 0 ? node.moved.norm() / longest : 0);
    };
    for (const auto& [a, b] : graph.edges) {
        if (a >= graph.map_nodes || b >= graph.map_nodes)
            continue;  // ties to cameras run along the whole trajectory and would hide the map
        drawing.line(graph.nodes[a].position, graph.nodes[b].position, color(graph.nodes[a]), 1);
    }
    for (std::size_t i = 0; i < graph.map_nodes; ++i) drawing.disc(graph.nodes[i].position, 3, color(graph.nodes[i]));
}

void draw_trajectory(Drawing& drawing, const ReportData& data) {
    const auto is_lost = [&](std::size_t frame) {
        return std::any_of(data.lost.begin(), data.lost.end(),
                           [&](const LostInterval& lost) { return frame >= lost.first && frame <= lost.last; });
    };
    for (std::size_t i = 1; i < data.trajectory.size(); ++i)
        drawing.line(data.trajectory[i - 1].T_world_camera.translation(),
                     data.trajectory[i].T_world_camera.translation(),
                     is_lost(i - 1) || is_lost(i) ? kLoopColors.lost : kLoopColors.trajectory, 2);
}

}  // namespace

Rgb8 displacement_color(double share) {
    const auto& bgr =
        displacement_scale().at<cv::Vec3b>(static_cast<int>(std::lround(255 * std::clamp(share, 0.0, 1.0))));
    return {bgr[2], bgr[1], bgr[0]};
}

bool has_loop_picture(const ReportData& data) {
    return data.loop_graph || !loop_links(data).empty() || !relocalised_positions(data).empty();
}

LoopPicture loop_picture(const ReportData& data, const Eigen::Isometry3d& upright) {
    const std::vector<LoopLink> links = loop_links(data);
    const std::vector<Eigen::Vector3d> keyframes = keyframe_positions(data), relocalised = relocalised_positions(data);
    std::vector<Eigen::Vector3d> in_view = keyframes;
    for (const StampedPose& pose : data.trajectory) in_view.push_back(pose.T_world_camera.translation());
    if (data.loop_graph)
        for (std::size_t i = 0; i < data.loop_graph->map_nodes; ++i)
            in_view.push_back(data.loop_graph->nodes[i].position);

    const Eigen::Vector3d forward = upright.linear().col(1), up = upright.linear().col(2);
    LoopPicture result;
    result.camera = picture_camera();
    result.T_world_camera =
        overview_pose(data.map, result.camera, std::sin(kElevation) * up - std::cos(kElevation) * forward, up, in_view);
    Drawing drawing(render_map(data.map, result.camera, result.T_world_camera), result.camera, result.T_world_camera);

    double longest = 0;
    if (data.loop_graph) {
        for (std::size_t i = 0; i < data.loop_graph->map_nodes; ++i)
            longest = std::max(longest, data.loop_graph->nodes[i].moved.norm());
        draw_graph(drawing, *data.loop_graph, longest);
    }
    draw_trajectory(drawing, data);
    for (const LoopLink& link : links) drawing.line(link.live, link.model, kLoopColors.loop, 3);
    for (const Eigen::Vector3d& keyframe : keyframes) drawing.disc(keyframe, 4, kLoopColors.keyframe);
    for (const LoopLink& link : links)
        for (const Eigen::Vector3d& end : {link.live, link.model}) drawing.ring(end, 8, kLoopColors.loop);
    for (const Eigen::Vector3d& place : relocalised) drawing.ring(place, 8, kLoopColors.relocalised);

    drawing.explain_line("trajectory", kLoopColors.trajectory, 2);
    if (!data.lost.empty()) drawing.explain_line("not tracked", kLoopColors.lost, 2);
    if (!keyframes.empty()) drawing.explain_disc("keyframe", 4, kLoopColors.keyframe);
    if (!links.empty()) drawing.explain_line("loop", kLoopColors.loop, 3);
    if (!relocalised.empty()) drawing.explain_ring("relocalised", 8, kLoopColors.relocalised);
    if (data.loop_graph) {
        drawing.explain_disc(
            "deformation graph of the last loop, " + std::to_string(data.loop_graph->map_nodes) + " nodes", 3,
            displacement_color(0.5));
        constexpr double kCentimetres = 100;
        drawing.explain_scale("moved by 0", fixed_text(kCentimetres * longest, 1) + " cm");
    }
    if (!in_view.empty()) drawing.explain_metre(in_view.front());
    result.image = drawing.picture();
    return result;
}

}  // namespace posefusion
