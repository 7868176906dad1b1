#include "hosts/export/keyframes.hpp"

#include <algorithm>
#include <numbers>
#include <optional>

#include "engine/core/median.hpp"

namespace posefusion {
namespace {

/// Grey values at half the size; negative where a label is.
Image<float> half_size_grey(const ColorImage& color, const LabelImage& labels) {
    constexpr float kLabelled = -1;
    Image<float> grey(color.width() / 2, color.height() / 2);
    for (int v = 0; v < grey.height(); ++v) {
        for (int u = 0; u < grey.width(); ++u) {
            float sum = 0;
            bool labelled = false;
            for (const auto& [x, y] : {std::pair(0, 0), {1, 0}, {0, 1}, {1, 1}}) {
                const Rgb8 c = color(2 * u + x, 2 * v + y);
                sum += 0.299f * static_cast<float>(c.r) + 0.587f * static_cast<float>(c.g) +
                       0.114f * static_cast<float>(c.b);  // luma of ITU-R BT.601
                labelled = labelled || (!labels.empty() && labels(2 * u + x, 2 * v + y) != 0);
            }
            grey(u, v) = labelled ? kLabelled : sum / 4;
        }
    }
    return grey;
}

/// From one camera to the other in steps: at 1 it is time for another view.
double steps_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, const KeyframeConfig& config) {
    const double distance = (a.translation() - b.translation()).norm();
    const double turn = Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() * 180 / std::numbers::pi;
    return std::max(distance / config.distance, turn / config.angle);
}

std::vector<bool> find_blurred(const std::vector<KeyframeCandidate>& candidates, const KeyframeConfig& config) {
    std::vector<bool> blurred(candidates.size());
    std::vector<double> around;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const std::size_t begin = i - std::min(i, config.neighbours);
        const std::size_t end = std::min(candidates.size(), i + config.neighbours + 1);
        around.clear();
        for (std::size_t k = begin; k < end; ++k) around.push_back(candidates[k].sharpness);
        blurred[i] = candidates[i].sharpness < config.blurred * upper_median(around);
    }
    return blurred;
}

}  // namespace

double sharpness(const ColorImage& color, const LabelImage& labels) {
    const Image<float> grey = half_size_grey(color, labels);
    double sum = 0, squares = 0;
    std::size_t count = 0;
    for (int v = 1; v + 1 < grey.height(); ++v) {
        for (int u = 1; u + 1 < grey.width(); ++u) {
            const float left = grey(u - 1, v), right = grey(u + 1, v), up = grey(u, v - 1), down = grey(u, v + 1);
            if (std::min({grey(u, v), left, right, up, down}) < 0) continue;
            const double laplacian = static_cast<double>(left + right + up + down - 4 * grey(u, v));
            sum += laplacian;
            squares += laplacian * laplacian;
            ++count;
        }
    }
    if (count == 0) return 0;
    const double mean = sum / static_cast<double>(count);
    return squares / static_cast<double>(count) - mean * mean;
}

std::vector<std::size_t> choose_keyframes(const std::vector<KeyframeCandidate>& candidates,
                                          const KeyframeConfig& config) {
    const std::vector<bool> blurred = find_blurred(candidates, config);
    const auto steps = [&](std::size_t a, std::size_t b) {
        return steps_between(candidates[a].T_world_camera, candidates[b].T_world_camera, config);
    };
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < candidates.size();) {
        if (!chosen.empty() && steps(chosen.back(), i) < 1) {
            ++i;
            continue;
        }
        const std::size_t begin = i;
        std::optional<std::size_t> best;  // where all are blurred, the window goes on
        for (; i < candidates.size() && (!best || steps(begin, i) < config.window); ++i)
            if (!blurred[i] && (!best || candidates[i].sharpness > candidates[*best].sharpness)) best = i;
        if (!best) break;
        chosen.push_back(*best);
        i = *best + 1;
    }
    return chosen;
}

}  // namespace posefusion
