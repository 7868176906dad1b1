#include "hosts/adjust/patch_alignment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

namespace posefusion {
namespace {

using Eigen::Vector2d;

Image<float> halved(const Image<float>& image) {
    Image<float> half(image.width() / 2, image.height() / 2);
    for (int v = 0; v < half.height(); ++v)
        for (int u = 0; u < half.width(); ++u)
            half(u, v) = 0.25f * (image(2 * u, 2 * v) + image(2 * u + 1, 2 * v) + image(2 * u, 2 * v + 1) +
                                  image(2 * u + 1, 2 * v + 1));
    return half;
}

/// Intensity and its gradient, bilinear.
struct Sample {
    double value, du, dv;
};

Sample sample(const Image<float>& image, const Vector2d& at) {
    const double x = std::clamp(at.x(), 0.0, image.width() - 1.001),
                 y = std::clamp(at.y(), 0.0, image.height() - 1.001);
    const int u = static_cast<int>(x), v = static_cast<int>(y);
    const double a = x - u, b = y - v;
    const auto p = [&](int i, int j) { return static_cast<double>(image(u + i, v + j)); };
    const double top = p(0, 0) + a * (p(1, 0) - p(0, 0)), bottom = p(0, 1) + a * (p(1, 1) - p(0, 1));
    return {top + b * (bottom - top), (1 - b) * (p(1, 0) - p(0, 0)) + b * (p(1, 1) - p(0, 1)), bottom - top};
}

Vector2d at_level(const Vector2d& pixel, double size) {
    return (pixel + Vector2d::Constant(0.5)) / size - Vector2d::Constant(0.5);
}

constexpr int kSide = 2 * PatchConfig::kReach + 1;
constexpr std::size_t kPixels = kSide * kSide;

}  // namespace

IntensityPyramid intensity_pyramid(const ColorImage& color) {
    Image<float> intensity(color.width(), color.height());
    for (std::size_t i = 0; i < color.size(); ++i)
        intensity[i] = 0.299f * color[i].r + 0.587f * color[i].g + 0.114f * color[i].b;  // Rec. 601
    IntensityPyramid pyramid{std::move(intensity)};
    while (pyramid.size() < PatchConfig::kLevels) pyramid.push_back(halved(pyramid.back()));
    return pyramid;
}

std::optional<FoundPatch> find_patch(const IntensityPyramid& here, const SurfacePatch& patch,
                                     const IntensityPyramid& there, const PlaceThere& seen_there) {
    if (there.back().width() < 2 || there.back().height() < 2) return std::nullopt;
    /// Where a pixel near the centre is seen; nullopt behind the camera.
    const auto moved = [&](const Vector2d& offset) -> std::optional<Vector2d> {
        const double inverse = patch.inverse_depth + patch.slope.dot(offset);
        if (!(inverse > 0.25 * patch.inverse_depth)) return std::nullopt;  // far outside of the plane that was seen
        return seen_there(patch.pixel + offset, inverse);
    };
    const auto centre = moved(Vector2d::Zero());
    if (!centre) return std::nullopt;

    Vector2d shift = Vector2d::Zero();
    double variance = 0, correlation = 0;
    Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
    for (int level = PatchConfig::kLevels - 1; level >= 0; --level) {
        const auto l = static_cast<std::size_t>(level);
        const double size = 1 << level;
        std::array<double, kPixels> wanted{};
        std::array<Vector2d, kPixels> places;
        std::size_t n = 0;
        for (int v = -PatchConfig::kReach; v <= PatchConfig::kReach; ++v) {
            for (int u = -PatchConfig::kReach; u <= PatchConfig::kReach; ++u, ++n) {
                const Vector2d offset = size * Vector2d(u, v);
                const auto place = moved(offset);
                if (!place) return std::nullopt;
                wanted[n] = sample(here[l], at_level(patch.pixel + offset, size)).value;
                places[n] = *place;
            }
        }
        double mean_wanted = 0;
        for (const double w : wanted) mean_wanted += w / kPixels;
        for (int step = 0; step < PatchConfig::kSteps; ++step) {
            // contrast and brightness in closed form, then a step of the shift
            std::array<Sample, kPixels> seen{};
            double mean = 0, cross = 0, square = 0, square_seen = 0;
            for (std::size_t i = 0; i < kPixels; ++i) {
                seen[i] = sample(there[l], at_level(places[i] + shift, size));
                mean += seen[i].value / kPixels;
            }
            for (std::size_t i = 0; i < kPixels; ++i) {
                const double a = wanted[i] - mean_wanted, b = seen[i].value - mean;
                cross += a * b, square += a * a, square_seen += b * b;
            }
            if (!(square > 0) || !(square_seen > 0)) return std::nullopt;
            const double gain = cross / square;
            correlation = cross / std::sqrt(square * square_seen);
            Eigen::Matrix2d H = 1e-6 * Eigen::Matrix2d::Identity();
            Vector2d b = Vector2d::Zero();
            double squares = 0;
            for (std::size_t i = 0; i < kPixels; ++i) {
                const double r = seen[i].value - mean - gain * (wanted[i] - mean_wanted);
                const Vector2d J(seen[i].du / size, seen[i].dv / size);
                H += J * J.transpose();
                b -= J * r;
                squares += r * r;
            }
            variance = squares / (kPixels - 4);
            information = H;
            const Vector2d update = H.ldlt().solve(b);
            shift += update;
            if (!(shift.norm() < PatchConfig::kMostShift)) return std::nullopt;
            if (update.norm() < PatchConfig::kConverged * size) break;
        }
    }
    if (correlation < PatchConfig::kLeastCorrelation) return std::nullopt;
    const Vector2d pixel = *centre + shift;
    constexpr double kBorder = PatchConfig::kReach + 1;
    if (pixel.x() < kBorder || pixel.y() < kBorder || pixel.x() > there[0].width() - 1 - kBorder ||
        pixel.y() > there[0].height() - 1 - kBorder)
        return std::nullopt;
    const double least =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(information, Eigen::EigenvaluesOnly).eigenvalues()(0);
    return FoundPatch{pixel, std::sqrt(variance / least)};
}

}  // namespace posefusion
