#include "hosts/report/plot.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/core/number_text.hpp"

namespace posefusion {
namespace {

constexpr int kLeft = 70, kRight = 18, kTop = 54, kBottom = 52;  // room for labels round the plot, pixels
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kTextSize = 0.42;
constexpr int kTextHeight = 14, kDot = 4;  // pixels
const cv::Scalar kGrid(225, 225, 225), kFrame(120, 120, 120), kText(40, 40, 40);

struct Range {
    double low = 0, high = 1;
    [[nodiscard]] double size() const { return high - low; }
    [[nodiscard]] double centre() const { return (low + high) / 2; }
    void widen_to(double new_size) { *this = {centre() - new_size / 2, centre() + new_size / 2}; }
};

Range range_of(const std::vector<PlotLine>& lines, int axis) {
    Range range{1, 0};
    for (const PlotLine& line : lines) {
        for (const Eigen::Vector2d& p : line.points) {
            if (!p.allFinite()) continue;
            range = range.low > range.high ? Range{p[axis], p[axis]}
                                           : Range{std::min(range.low, p[axis]), std::max(range.high, p[axis])};
        }
    }
    if (range.low > range.high) return {0, 1};
    constexpr double kMargin = 1.08, kSmallest = 1e-3;
    range.widen_to(std::max(range.size() * kMargin, kSmallest));
    return range;
}

/// 1, 2 or 5 times a power of ten, so that about `count` steps fill the range.
double tick_step(double size, int count) {
    const double rough = size / count, power = std::pow(10.0, std::floor(std::log10(rough)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (factor * power >= rough) return factor * power;
    return 10 * power;
}

std::string tick_text(double value, double step) {
    const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
    return fixed_text(std::abs(value) < step / 2 ? 0.0 : value, decimals);
}

class Plot {
public:
    Plot(const std::vector<PlotLine>& lines, const PlotConfig& config)
        : config_(config),
          image_(config.height, config.width, CV_8UC3, cv::Scalar(255, 255, 255)),
          area_(kLeft, kTop, config.width - kLeft - kRight, config.height - kTop - kBottom),
          x_(range_of(lines, 0)),
          y_(range_of(lines, 1)) {
        if (config.y_from_zero) y_.low = std::min(0.0, y_.low);
        if (config.equal_axes) equalise();
    }

    void draw(const std::vector<PlotLine>& lines) {
        for (const PlotSpan& span : config_.spans) draw_span(span);
        draw_grid();
        for (const PlotLine& line : lines) draw_line(line);
        for (const PlotLine& line : lines)
            if (line.named_at_start) draw_name(line);
        cv::rectangle(image_, area_, kFrame, 1, cv::LINE_AA);
        draw_text(config_.title, {area_.x, 22}, 0.5);
        draw_text(config_.x_label, {area_.x + area_.width / 2 - text_width(config_.x_label) / 2, config_.height - 12},
                  kTextSize);
        draw_text(config_.y_label, {8, kTop - 8}, kTextSize);
        draw_legend(lines);
    }

    [[nodiscard]] ColorImage picture() const {
        ColorImage result(image_.cols, image_.rows);
        for (int v = 0; v < image_.rows; ++v) {
            const auto* row = image_.ptr<cv::Vec3b>(v);
            for (int u = 0; u < image_.cols; ++u) result(u, v) = {row[u][0], row[u][1], row[u][2]};
        }
        return result;
    }

private:
    void equalise() {
        const double metres_per_pixel = std::max(x_.size() / area_.width, y_.size() / area_.height);
        x_.widen_to(metres_per_pixel * area_.width);
        y_.widen_to(metres_per_pixel * area_.height);
    }
    [[nodiscard]] cv::Point to_pixel(const Eigen::Vector2d& p) const {
        return {static_cast<int>(std::lround(area_.x + (p.x() - x_.low) / x_.size() * area_.width)),
                static_cast<int>(std::lround(area_.y + (y_.high - p.y()) / y_.size() * area_.height))};
    }
    void draw_grid() {
        const double x_step = tick_step(x_.size(), 6), y_step = tick_step(y_.size(), 6);
        for (double x = std::ceil(x_.low / x_step) * x_step; x <= x_.high; x += x_step) {
            const int u = to_pixel({x, y_.low}).x;
            cv::line(image_, {u, area_.y}, {u, area_.y + area_.height}, kGrid);
            const std::string text = tick_text(x, x_step);
            draw_text(text, {u - text_width(text) / 2, area_.y + area_.height + 16}, kTextSize);
        }
        for (double y = std::ceil(y_.low / y_step) * y_step; y <= y_.high; y += y_step) {
            const int v = to_pixel({x_.low, y}).y;
            cv::line(image_, {area_.x, v}, {area_.x + area_.width, v}, kGrid);
            const std::string text = tick_text(y, y_step);
            draw_text(text, {area_.x - text_width(text) - 6, v + 4}, kTextSize);
        }
    }
    void draw_span(const PlotSpan& span) {
        if (!(span.to >= x_.low && span.from <= x_.high)) return;
        const int left = to_pixel({std::max(span.from, x_.low), y_.low}).x,
                  right = to_pixel({std::min(span.to, x_.high), y_.low}).x;
        cv::rectangle(image_, {left, area_.y}, {right, area_.y + area_.height},
                      cv::Scalar(span.color.r, span.color.g, span.color.b), cv::FILLED);
    }
    void draw_line(const PlotLine& line) {
        const cv::Scalar color(line.color.r, line.color.g, line.color.b);
        for (std::size_t i = 1; i < line.points.size(); ++i)
            if (line.points[i - 1].allFinite() && line.points[i].allFinite())
                cv::line(image_, to_pixel(line.points[i - 1]), to_pixel(line.points[i]), color, 2, cv::LINE_AA);
    }
    /// A dot at the first point, and the name beside it.
    void draw_name(const PlotLine& line) {
        const auto first = std::find_if(line.points.begin(), line.points.end(),
                                        [](const Eigen::Vector2d& point) { return point.allFinite(); });
        if (first == line.points.end()) return;
        const cv::Point at = to_pixel(*first);
        cv::circle(image_, at, kDot, cv::Scalar(line.color.r, line.color.g, line.color.b), cv::FILLED, cv::LINE_AA);
        const int right = area_.x + area_.width - text_width(line.name) - kDot;
        draw_text(line.name, {std::min(at.x + 2 * kDot, right), std::max(at.y - kDot, area_.y + kTextHeight)},
                  kTextSize);
    }
    void draw_legend(const std::vector<PlotLine>& lines) {
        int u = config_.width - kRight;
        for (auto line = lines.rbegin(); line != lines.rend(); ++line) {
            if (line->name.empty() || line->named_at_start) continue;
            u -= text_width(line->name);
            draw_text(line->name, {u, kTop - 8}, kTextSize);
            cv::line(image_, {u - 26, kTop - 12}, {u - 6, kTop - 12},
                     cv::Scalar(line->color.r, line->color.g, line->color.b), 3);
            u -= 42;
        }
    }
    void draw_text(const std::string& text, cv::Point at, double size) {
        cv::putText(image_, text, at, kFont, size, kText, 1, cv::LINE_AA);
    }
    [[nodiscard]] static int text_width(const std::string& text) {
        int baseline = 0;
        return cv::getTextSize(text, kFont, kTextSize, 1, &baseline).width;
    }

    const PlotConfig& config_;
    cv::Mat image_;  // RGB
    cv::Rect area_;
    Range x_, y_;
};

}  // namespace

ColorImage draw_plot(const std::vector<PlotLine>& lines, const PlotConfig& config) {
    Plot plot(lines, config);
    plot.draw(lines);
    return plot.picture();
}

ColorImage beside(const std::vector<ColorImage>& pictures) {
    int width = 0, height = 0;
    for (const ColorImage& p : pictures) {
        width += p.width();
        height = std::max(height, p.height());
    }
    ColorImage row(width, height, {255, 255, 255});
    int left = 0;
    for (const ColorImage& p : pictures) {
        for (int v = 0; v < p.height(); ++v)
            for (int u = 0; u < p.width(); ++u) row(left + u, v) = p(u, v);
        left += p.width();
    }
    return row;
}

}  // namespace posefusion
