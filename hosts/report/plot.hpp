#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/core/image.hpp"

/// Line plots as images, for use without a browser.
namespace posefusion {

struct PlotLine {
    std::string name;
    Rgb8 color;
    std::vector<Eigen::Vector2d> points;  ///< a point that is not finite interrupts the line
    bool named_at_start = false;          ///< the name is written at its first point, else in the legend
};

/// An interval of the x axis, shaded from top to bottom; a line if its length is 0.
struct PlotSpan {
    double from = 0, to = 0;
    Rgb8 color;
};

struct PlotConfig {
    std::string title, x_label, y_label;
    bool equal_axes = false;  ///< the same scale in x and y
    bool y_from_zero = false;
    std::vector<PlotSpan> spans;    ///< drawn behind the lines, clipped to their range
    int width = 640, height = 480;  ///< pixels
};

[[nodiscard]] ColorImage draw_plot(const std::vector<PlotLine>& lines, const PlotConfig& config);

/// Images of equal height, side by side.
[[nodiscard]] ColorImage beside(const std::vector<ColorImage>& pictures);

}  // namespace posefusion
