#include "hosts/adjust/landmarks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/pinhole.hpp"
#include "hosts/adjust/patch_alignment.hpp"
#include "hosts/features/features.hpp"

namespace posefusion {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// What a frame measures at a position.
struct Measurement {
    Vector2d pixel;
    double depth = 0;
    Vector2d slope = Vector2d::Zero();  ///< of the inverse depth over the image, 1/m per pixel
};

/// The depth at a position whose neighbourhood is one plane: the inverse depth of a plane is linear in the image.
/// nullopt: it is none, or too little of it was measured.
std::optional<Measurement> depth_at(const DepthImage& depth, const Vector2d& pixel, const DepthNoise& noise) {
    constexpr int kReach = 6;            // pixels
    constexpr double kLeastShare = 0.6;  // of the neighbourhood has depth
    constexpr double kMostSigmas = 4;    // of the farthest measurement
    const int u0 = static_cast<int>(std::lround(pixel.x())), v0 = static_cast<int>(std::lround(pixel.y()));
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Vector3d b = Vector3d::Zero();
    const auto visit = [&](auto&& use) {
        for (int v = v0 - kReach; v <= v0 + kReach; ++v)
            for (int u = u0 - kReach; u <= u0 + kReach; ++u)
                if (depth.contains(u, v) && depth(u, v) > 0)
                    use(Vector3d(1, u - pixel.x(), v - pixel.y()), 1 / static_cast<double>(depth(u, v)));
    };
    visit([&](const Vector3d& at, double inverse) {
        H += at * at.transpose();
        b += at * inverse;
    });
    const int side = 2 * kReach + 1;
    if (H(0, 0) < kLeastShare * side * side) return std::nullopt;
    const Vector3d plane = H.ldlt().solve(b);
    if (!(plane.x() > 0)) return std::nullopt;
    double farthest = 0;
    visit(
        [&](const Vector3d& at, double inverse) { farthest = std::max(farthest, std::abs(inverse - at.dot(plane))); });
    const double z = 1 / plane.x(), sigma = static_cast<double>(noise.sigma(static_cast<float>(z))) / (z * z);
    if (farthest > kMostSigmas * sigma) return std::nullopt;
    return Measurement{pixel, z, plane.tail<2>()};
}

}  // namespace

class LandmarkSearch::Tracks {
public:
    Tracks(const std::vector<KeyframeImages>& keyframes, const Intrinsics& camera, const DepthNoise& noise,
           const std::optional<RowTimes>& times)
        : keyframes_(keyframes),
          camera_(camera),
          noise_(noise),
          rolling_(times.has_value()),
          rows_{camera, times.value_or(RowTimes{})} {}

    Bundle run(const std::function<void()>& keyframe_done) {
        Bundle bundle;
        bundle.width = camera_.width, bundle.height = camera_.height;
        bundle.camera = parameters_of(camera_, {}, rows_.times);
        bundle.stamp_row = rows_.times.stamp_row;
        for (const KeyframeImages& k : keyframes_) {
            if (rolling_) bundle.readouts.push_back(k.readout);
            bundle.T_camera_world.push_back(k.T_world_camera.inverse());
            pyramids_.push_back(intensity_pyramid(k.color));
        }
        taken_.resize(keyframes_.size());
        for (std::size_t k = 0; k < keyframes_.size(); ++k) {
            begin_landmarks(k);
            keyframe_done();
        }
        std::erase_if(tracks_, [](const Track& track) { return track.seen.size() < LandmarkConfig::kFewestViews; });
        for (Track& track : tracks_) {
            const auto landmark = static_cast<std::uint32_t>(bundle.landmarks.size());
            bundle.landmarks.push_back(track.point);
            for (Observation& o : track.seen) {
                o.landmark = landmark;
                // Errors of depth are those of the surface more than of the frame: all views together say as much as
                // one.
                o.inverse_depth_sigma *= std::sqrt(static_cast<double>(track.seen.size()));
                bundle.observations.push_back(o);
            }
        }
        return bundle;
    }

    std::vector<Observation> find_in(const KeyframeImages& frame, std::span<const std::size_t> near) const {
        std::vector<std::uint32_t> candidates;
        for (std::uint32_t i = 0; i < tracks_.size(); ++i) {
            const auto& seen = tracks_[i].seen;
            if (std::any_of(seen.begin(), seen.end(), [&](const Observation& o) {
                    return std::find(near.begin(), near.end(), o.keyframe) != near.end();
                }))
                candidates.push_back(i);
        }
        const std::size_t step = (candidates.size() + LandmarkConfig::kPerFrame - 1) / LandmarkConfig::kPerFrame;
        const IntensityPyramid pyramid = intensity_pyramid(frame.color);
        std::vector<Observation> found;
        for (std::size_t i = 0; i < candidates.size(); i += step) {
            const Track& track = tracks_[candidates[i]];
            auto seen = find_again(track, frame, pyramid);
            if (!seen) continue;
            seen->landmark = candidates[i];
            seen->inverse_depth_sigma *= std::sqrt(static_cast<double>(track.seen.size()));
            found.push_back(*seen);
        }
        return found;
    }

private:
    struct Track {
        std::size_t first = 0;              ///< keyframe that saw it first
        SurfacePatch patch;                 ///< there
        Vector3d point = Vector3d::Zero();  ///< world
        std::vector<Observation> seen;
    };

    [[nodiscard]] bool is_static(const KeyframeImages& k, const Vector2d& pixel) const {
        if (k.labels.empty()) return true;
        const auto at = [](double position, int from, int to) {
            return std::clamp(static_cast<int>((position + 0.5) * to / from), 0, to - 1);
        };
        return k.labels(at(pixel.x(), camera_.width, k.labels.width()),
                        at(pixel.y(), camera_.height, k.labels.height())) == 0;
    }

    /// What a keyframe measures at a position of its colour image.
    [[nodiscard]] std::optional<Measurement> measure(const KeyframeImages& k, const Vector2d& pixel) const {
        if (!is_static(k, pixel)) return std::nullopt;
        return depth_at(k.depth, pixel, noise_);
    }

    [[nodiscard]] Observation observation(std::size_t keyframe, const Measurement& m, double sigma) const {
        Observation o;
        o.keyframe = static_cast<std::uint32_t>(keyframe);
        o.pixel = m.pixel;
        o.inverse_depth = 1 / m.depth;
        o.slope = m.slope;
        o.pixel_sigma = std::hypot(sigma, LandmarkConfig::kPixelSigma);
        o.inverse_depth_sigma = static_cast<double>(noise_.sigma(static_cast<float>(m.depth))) / (m.depth * m.depth);
        return o;
    }

    [[nodiscard]] bool is_free(std::size_t keyframe, const Vector2d& pixel) const {
        return std::none_of(taken_[keyframe].begin(), taken_[keyframe].end(), [&](const Vector2d& other) {
            return (other - pixel).squaredNorm() < LandmarkConfig::kSpacing * LandmarkConfig::kSpacing;
        });
    }

    /// New landmarks of keyframe k, followed into all later ones.
    void begin_landmarks(std::size_t k) {
        const KeyframeImages& keyframe = keyframes_[k];
        FeatureConfig features;
        features.count = LandmarkConfig::kPerKeyframe;
        const std::size_t first = tracks_.size();
        for (const Feature& feature : find_features(keyframe.color, keyframe.depth, {}, features)) {
            const Vector2d pixel = feature.pixel.cast<double>();
            if (!is_free(k, pixel)) continue;
            const auto measured = measure(keyframe, pixel);
            if (!measured) continue;
            Track& track = tracks_.emplace_back();
            track.first = k;
            const double z = rows_.depth_with_color(pixel, 1 / measured->depth, measured->slope, keyframe.readout);
            track.point = keyframe.T_world_camera * rows_.point_at(pixel, z, keyframe.readout);
            track.seen.push_back(observation(k, *measured, 0));
            taken_[k].push_back(pixel);
            track.patch = {pixel, 1 / z, measured->slope};
        }
        const std::size_t end = tracks_.size();
        for (std::size_t later = k + 1; later < keyframes_.size(); ++later) follow(later, first, end);
    }

    [[nodiscard]] bool can_be_seen(const Isometry3d& a, const Isometry3d& b, const Vector3d& point) const {
        const Vector3d in_a = a.inverse() * point, in_b = b.inverse() * point;
        if (in_b.z() <= 0) return false;
        const double scale = in_a.z() / in_b.z();
        if (scale > LandmarkConfig::kMostScale || scale < 1 / LandmarkConfig::kMostScale) return false;
        const double cosine = (a.translation() - point).normalized().dot((b.translation() - point).normalized());
        if (cosine < std::cos(LandmarkConfig::kMostTurn)) return false;
        return in_image(project(in_b, camera_), camera_);
    }

    /// A landmark of a keyframe in another frame.
    [[nodiscard]] std::optional<Observation> find_again(const Track& track, const KeyframeImages& there,
                                                        const IntensityPyramid& pyramid) const {
        const KeyframeImages& here = keyframes_[track.first];
        if (!can_be_seen(here.T_world_camera, there.T_world_camera, track.point)) return std::nullopt;
        const Isometry3d T = there.T_world_camera.inverse() * here.T_world_camera;
        const auto seen_there = [&](const Vector2d& pixel, double inverse_depth) {
            return rows_.pixel_of(T * rows_.point_at(pixel, 1 / inverse_depth, here.readout), there.readout);
        };
        const auto found = find_patch(pyramids_[track.first], track.patch, pyramid, seen_there);
        if (!found || found->sigma > LandmarkConfig::kMostSigma) return std::nullopt;
        const auto measured = measure(there, found->pixel);
        if (!measured) return std::nullopt;
        const double expected = (there.T_world_camera.inverse() * track.point).z();
        if (std::abs(measured->depth - expected) > LandmarkConfig::kMostDepthStep * expected) return std::nullopt;
        return observation(0, *measured, found->sigma);
    }

    void follow(std::size_t to, std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i) {
            auto found = find_again(tracks_[i], keyframes_[to], pyramids_[to]);
            if (!found) continue;
            found->keyframe = static_cast<std::uint32_t>(to);
            taken_[to].push_back(found->pixel);
            tracks_[i].seen.push_back(*found);
        }
    }

    const std::vector<KeyframeImages>& keyframes_;
    const Intrinsics& camera_;
    const DepthNoise& noise_;
    bool rolling_;
    RowCamera rows_;
    std::vector<IntensityPyramid> pyramids_;
    std::vector<std::vector<Vector2d>> taken_;  ///< positions of landmarks, by keyframe
    std::vector<Track> tracks_;
};

LandmarkSearch::LandmarkSearch(const std::vector<KeyframeImages>& keyframes, const Intrinsics& camera,
                               const DepthNoise& noise, const std::optional<RowTimes>& times)
    : tracks_(std::make_unique<Tracks>(keyframes, camera, noise, times)) {}
LandmarkSearch::~LandmarkSearch() = default;

Bundle LandmarkSearch::find(const std::function<void()>& keyframe_done) { return tracks_->run(keyframe_done); }

std::vector<Observation> LandmarkSearch::find_in(const KeyframeImages& frame, std::span<const std::size_t> near) const {
    return tracks_->find_in(frame, near);
}

Bundle find_landmarks(const std::vector<KeyframeImages>& keyframes, const Intrinsics& camera, const DepthNoise& noise,
                      const std::optional<RowTimes>& times) {
    return LandmarkSearch(keyframes, camera, noise, times).find();
}

}  // namespace posefusion
