#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/core/image.hpp"

/// Line plots as pictures, for people without a browser.
namespace posefusion {

struct PlotLine {
    std::string name;
    Rgb8 color;
    std::vector<Eigen::Vector2d> points;  ///< a point that is not finite interrupts the line
};

/// A stretch of the x axis, shaded from top to bottom; a line where it has no length.
struct PlotSpan {
    double from = 0, to = 0;
    Rgb8 color;
};

struct PlotConfig {
    std::string title, x_label, y_label;
    bool equal_axes = false;  ///< one unit is as long in x as in y
    bool y_from_zero = false;
    std::vector<PlotSpan> spans;    ///< behind the lines; what lies outside of their range is cut off
    int width = 640, height = 480;  ///< pixels
};

[[nodiscard]] ColorImage draw_plot(const std::vector<PlotLine>& lines, const PlotConfig& config);

/// Pictures of equal height beside each other.
[[nodiscard]] ColorImage beside(const std::vector<ColorImage>& pictures);

}  // namespace posefusion
