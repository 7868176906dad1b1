#include "hosts/texture/exposure.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>

namespace posefusion {
namespace {

constexpr float kDarkest = 8, kBrightest = 247;
constexpr double kFarFromOthers = 0.35;  // logarithm: 40 %
/// A place of the map counts as this part of a sample: it is what all views together made of it.
constexpr double kMapWeight = 0.1;
constexpr double kPrior = 1;  // samples' worth of a factor of 1: views with few samples stay as they are

bool usable(float value) { return value >= kDarkest && value <= kBrightest; }

struct LogSample {
    std::uint32_t place = 0, view = 0;
    double value = 0;
};

/// Minimises sum (x_p - value - gain_v)^2 over the colours x of places and the gains, x eliminated.
Eigen::VectorXd solve(const std::vector<LogSample>& samples, const std::vector<double>& map, Eigen::Index views) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Identity(views, views) * kPrior;
    Eigen::VectorXd b = Eigen::VectorXd::Zero(views);
    for (std::size_t begin = 0, end = 0; begin < samples.size(); begin = end) {
        const std::uint32_t place = samples[begin].place;
        double sum = kMapWeight * map[place];
        for (end = begin; end < samples.size() && samples[end].place == place; ++end) sum += samples[end].value;
        const double count = kMapWeight + static_cast<double>(end - begin), mean = sum / count;
        for (std::size_t i = begin; i < end; ++i) {
            b[samples[i].view] += mean - samples[i].value;
            A(samples[i].view, samples[i].view) += 1;
            for (std::size_t k = begin; k < end; ++k) A(samples[i].view, samples[k].view) -= 1 / count;
        }
    }
    return A.ldlt().solve(b);
}

/// Without those that differ from the mean of their place, gains applied, by too much.
std::vector<LogSample> without_outliers(const std::vector<LogSample>& samples, const std::vector<double>& map,
                                        const Eigen::VectorXd& gains) {
    std::vector<LogSample> good;
    for (std::size_t begin = 0, end = 0; begin < samples.size(); begin = end) {
        const std::uint32_t place = samples[begin].place;
        double sum = kMapWeight * map[place];
        for (end = begin; end < samples.size() && samples[end].place == place; ++end)
            sum += samples[end].value + gains[samples[end].view];
        const double mean = sum / (kMapWeight + static_cast<double>(end - begin));
        std::copy_if(samples.begin() + static_cast<std::ptrdiff_t>(begin),
                     samples.begin() + static_cast<std::ptrdiff_t>(end), std::back_inserter(good),
                     [&](const LogSample& s) { return std::abs(s.value + gains[s.view] - mean) < kFarFromOthers; });
    }
    return good;
}

}  // namespace

std::vector<Eigen::Vector3f> level_exposure(const std::vector<ColorSample>& samples,
                                            const std::vector<Eigen::Vector3f>& map, std::size_t views) {
    std::vector<ColorSample> by_place = samples;
    std::stable_sort(by_place.begin(), by_place.end(),
                     [](const ColorSample& a, const ColorSample& b) { return a.place < b.place; });
    std::vector<Eigen::Vector3f> factors(views, Eigen::Vector3f::Ones());
    for (Eigen::Index channel = 0; channel < 3; ++channel) {
        std::vector<double> log_map;
        for (const Eigen::Vector3f& color : map)
            log_map.push_back(std::log(static_cast<double>(std::max(color[channel], 1.0f))));
        std::vector<LogSample> logs;
        for (const ColorSample& s : by_place)
            if (usable(s.color[channel]) && usable(map[s.place][channel]))
                logs.push_back({s.place, s.view, std::log(static_cast<double>(s.color[channel]))});
        const auto count = static_cast<Eigen::Index>(views);
        const Eigen::VectorXd first = solve(logs, log_map, count);
        const Eigen::VectorXd gains = solve(without_outliers(logs, log_map, first), log_map, count);
        for (std::size_t i = 0; i < views; ++i)
            factors[i][channel] = static_cast<float>(std::exp(gains[static_cast<Eigen::Index>(i)]));
    }
    return factors;
}

}  // namespace posefusion
