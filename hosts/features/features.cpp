#include "hosts/features/features.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace posefusion {
namespace {

/// The intensity image in which features are sought: the colour image, halved until it is small enough.
cv::Mat search_image(const ColorImage& color) {
    // OpenCV has no view of constant pixels; these are only read
    const cv::Mat rgb(color.height(), color.width(), CV_8UC3, const_cast<Rgb8*>(color.data()));
    cv::Mat gray;
    cv::cvtColor(rgb, gray, cv::COLOR_RGB2GRAY);
    while (gray.cols > FeatureConfig::kMaxWidth) {
        cv::Mat half;
        cv::resize(gray, half, {gray.cols / 2, gray.rows / 2}, 0, 0, cv::INTER_AREA);
        gray = half;
    }
    return gray;
}

/// The strongest of them, no cell of the image having many more than the others; in the order of `found`.
std::vector<cv::KeyPoint> spread(const std::vector<cv::KeyPoint>& found, cv::Size size, std::size_t count) {
    std::vector<std::uint32_t> by_strength(found.size());
    std::iota(by_strength.begin(), by_strength.end(), 0u);
    std::stable_sort(by_strength.begin(), by_strength.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return found[a].response > found[b].response; });

    // the n-th strongest of its cell is kept before the n+1-th of any
    const int columns = size.width / FeatureConfig::kCell + 1;
    std::vector<int> in_cell(static_cast<std::size_t>(columns * (size.height / FeatureConfig::kCell + 1)), 0);
    std::vector<std::pair<int, std::uint32_t>> ranked;  // rank in its cell, index
    for (const std::uint32_t i : by_strength) {
        const int u = static_cast<int>(found[i].pt.x) / FeatureConfig::kCell,
                  v = static_cast<int>(found[i].pt.y) / FeatureConfig::kCell;
        const auto cell = static_cast<std::size_t>(v) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(u);
        ranked.emplace_back(in_cell[cell]++, i);
    }
    std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    ranked.resize(std::min(ranked.size(), count));

    std::vector<std::uint32_t> kept;
    for (const auto& [rank, i] : ranked) kept.push_back(i);
    std::sort(kept.begin(), kept.end());
    std::vector<cv::KeyPoint> result;
    for (const std::uint32_t i : kept) result.push_back(found[i]);
    return result;
}

/// The depth of a point: the median of its neighbourhood, if that is one surface; else 0.
float depth_at(const DepthImage& depth, const Eigen::Vector2f& pixel) {
    constexpr int kReach = 2;          // pixels: depth may have a grid of holes
    constexpr std::size_t kLeast = 3;  // of these pixels must have depth
    constexpr float kMaxStep = 0.05f;  // of the depth: an edge, where the depth at a corner can be that of either side
    const int u0 = static_cast<int>(std::lround(pixel.x())), v0 = static_cast<int>(std::lround(pixel.y()));
    std::vector<float> near;
    for (int v = v0 - kReach; v <= v0 + kReach; ++v) {
        for (int u = u0 - kReach; u <= u0 + kReach; ++u) {
            if (depth.contains(u, v) && depth(u, v) > 0) near.push_back(depth(u, v));
        }
    }
    if (near.size() < kLeast) return 0;
    std::sort(near.begin(), near.end());
    const float median = near[near.size() / 2];
    return near.back() - near.front() < kMaxStep * median ? median : 0;
}

cv::Mat descriptors_of(const Features& features) {
    cv::Mat rows(static_cast<int>(features.size()), static_cast<int>(sizeof(Feature::descriptor)), CV_8U);
    for (int i = 0; i < rows.rows; ++i)
        std::memcpy(rows.ptr(i), features[static_cast<std::size_t>(i)].descriptor.data(), sizeof(Feature::descriptor));
    return rows;
}

}  // namespace

Features find_features(const ColorImage& color, const DepthImage& depth, const LabelImage& labels,
                       const FeatureConfig& config) {
    const cv::Mat gray = search_image(color);
    const float shrink = static_cast<float>(color.width()) / static_cast<float>(gray.cols);
    const auto whole_pixel = [&](const cv::KeyPoint& point) -> Eigen::Vector2f {
        return {(point.pt.x + 0.5f) * shrink - 0.5f, (point.pt.y + 0.5f) * shrink - 0.5f};
    };

    constexpr int kPatch = 31;  // pixels, as the descriptor was trained for
    const auto orb =
        cv::ORB::create(config.count * FeatureConfig::kCandidates, FeatureConfig::kLevelScale, FeatureConfig::kLevels,
                        kPatch / 2, 0, 2, cv::ORB::HARRIS_SCORE, kPatch, FeatureConfig::kFastThreshold);
    std::vector<cv::KeyPoint> points;
    orb->detect(gray, points);
    std::erase_if(points, [&](const cv::KeyPoint& point) {
        const Eigen::Vector2f pixel = whole_pixel(point);
        const int u = static_cast<int>(std::lround(pixel.x())), v = static_cast<int>(std::lround(pixel.y()));
        const bool is_static = color.contains(u, v) && (labels.empty() || labels(u, v) == 0);
        return !is_static || depth_at(depth, pixel) == 0;
    });
    points = spread(points, gray.size(), static_cast<std::size_t>(config.count));
    cv::Mat descriptors;
    orb->compute(gray, points, descriptors);

    Features features;
    for (std::size_t i = 0; i < points.size(); ++i) {
        Feature feature;
        feature.pixel = whole_pixel(points[i]);
        const float level = std::pow(FeatureConfig::kLevelScale, static_cast<float>(points[i].octave));
        feature.sigma = FeatureConfig::kPixelSigma * shrink * level;
        feature.depth = depth_at(depth, feature.pixel);
        std::memcpy(feature.descriptor.data(), descriptors.ptr(static_cast<int>(i)), sizeof(feature.descriptor));
        features.push_back(feature);
    }
    return features;
}

std::vector<FeatureMatch> match_features(const Features& earlier, const Features& current) {
    std::vector<FeatureMatch> matches;
    if (earlier.size() < 2 || current.empty()) return matches;
    std::vector<std::vector<cv::DMatch>> nearest;
    cv::BFMatcher(cv::NORM_HAMMING).knnMatch(descriptors_of(current), descriptors_of(earlier), nearest, 2);

    // of several that take the same earlier feature, the nearest one has it
    std::vector<float> best(earlier.size(), FeatureConfig::kMaxBits + 1);
    const auto is_clear = [](const std::vector<cv::DMatch>& two) {
        return two[0].distance <= FeatureConfig::kMaxBits &&
               two[0].distance < FeatureConfig::kMaxRatio * two[1].distance;
    };
    for (const auto& two : nearest) {
        float& least = best[static_cast<std::size_t>(two[0].trainIdx)];
        if (is_clear(two)) least = std::min(least, two[0].distance);
    }
    for (const auto& two : nearest) {
        float& least = best[static_cast<std::size_t>(two[0].trainIdx)];
        if (!is_clear(two) || two[0].distance != least) continue;
        least = -1;  // taken
        matches.push_back({static_cast<std::uint32_t>(two[0].trainIdx), static_cast<std::uint32_t>(two[0].queryIdx)});
    }
    return matches;
}

}  // namespace posefusion
