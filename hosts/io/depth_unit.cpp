#include "hosts/io/depth_unit.hpp"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <vector>

#include "engine/core/number_text.hpp"

namespace posefusion {
namespace {

constexpr std::size_t kFramesToMeasure = 3, kFramesToTry = 10;
constexpr std::size_t kLeastPixels = 100;  ///< an image with fewer measurements is not representative

constexpr float kNearest = 0.05f, kFarthest = 50.0f;  ///< medians of rooms lie between, metres
constexpr float kTypical = 2.0f;                      ///< and mostly near this one
/// Millimetres read in TUM's units place a room of 5 m here, metres; real rooms are seldom so near.
constexpr float kSuspicious = 1.0f;
/// TUM's units are fifths of a millimetre, of sensors that measure whole millimetres: if that many values are multiples
/// of five, and there are so many different ones, the images are in TUM's units.
constexpr std::uint16_t kTumUnitsPerMillimetre = 5;
constexpr double kNearlyAll = 0.99;
constexpr std::size_t kDifferentValues = 20;
constexpr float kMillimetres = 1000.0f, kTumUnits = 5000.0f;
/// Scales in use: metres, centimetres, 1/256 m (KITTI), millimetres, TUM, Replica, SUN3D without its bits rotated back,
/// tenths of a millimetre.
constexpr float kScales[] = {1, 100, 256, kMillimetres, kTumUnits, 6553.5f, 8000, 10000};

/// The measurements of the first images.
std::vector<std::uint16_t> first_values(const FrameSource& source) {
    std::vector<std::uint16_t> values;
    std::size_t measured = 0;
    for (std::size_t i = 0; i < std::min(source.size(), kFramesToTry) && measured < kFramesToMeasure; ++i) {
        try {
            const RawDepth depth = source.read(i).depth;
            const std::size_t before = values.size();
            std::copy_if(depth.begin(), depth.end(), std::back_inserter(values),
                         [](std::uint16_t d) { return d != 0 && d != 65535; });
            if (values.size() - before < kLeastPixels)
                values.resize(before);
            else
                ++measured;
        } catch (const Error&) {
            continue;  // reported when the frame is loaded for use
        }
    }
    return values;
}

/// There must be some.
float median_of(std::vector<std::uint16_t> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

bool are_whole_millimetres_of_tum(const std::vector<std::uint16_t>& values) {
    std::bitset<std::numeric_limits<std::uint16_t>::max() + 1> seen;
    for (const std::uint16_t value : values) seen.set(value);
    if (seen.count() < kDifferentValues) return false;
    const auto fives =
        std::count_if(values.begin(), values.end(), [](std::uint16_t d) { return d % kTumUnitsPerMillimetre == 0; });
    return static_cast<double>(fives) >= kNearlyAll * static_cast<double>(values.size());
}

std::string metres_text(float metres) {
    const bool readable = metres >= 0.01f && metres <= 100'000;
    return (readable ? fixed_text(static_cast<double>(metres), 2) : shortest_text(metres)) + " m";
}

/// The scale that brings the median nearest to that of a room.
float fitting_scale(float value) {
    return *std::min_element(std::begin(kScales), std::end(kScales), [&](float a, float b) {
        return std::abs(std::log(value / a / kTypical)) < std::abs(std::log(value / b / kTypical));
    });
}

}  // namespace

std::optional<std::string> judge_depth_unit(const std::vector<std::uint16_t>& values, float depth_scale,
                                            const std::string& location) {
    if (values.empty()) return std::nullopt;
    const float median_value = median_of(values), median = median_value / depth_scale;
    const std::string seen = location + ": the median depth of the first images is " + metres_text(median) +
                             " (depth_scale: " + shortest_text(depth_scale) + ")";
    if (median < kNearest || median > kFarthest) {
        const float better = fitting_scale(median_value);
        throw Error(seen + ", which no room has; with depth_scale: " + shortest_text(better) + " it would be " +
                    metres_text(median_value / better) + "; set depth_scale in the camera file (--camera FILE)");
    }
    if (median < kSuspicious && depth_scale == kTumUnits && !are_whole_millimetres_of_tum(values)) {
        return seen + "; if the images are in millimetres (" + metres_text(median_value / kMillimetres) +
               "), set depth_scale: 1000 in the camera file (--camera FILE)";
    }
    return std::nullopt;
}

std::optional<std::string> check_depth_unit(const FrameSource& source) {
    if (source.facts().live) return std::nullopt;
    return judge_depth_unit(first_values(source), source.camera().depth_scale, source.facts().location);
}

}  // namespace posefusion
