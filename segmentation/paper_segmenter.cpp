#include "segmentation/paper_segmenter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "engine/core/pinhole.hpp"
#include "segmentation/paper_min_cut.hpp"
#include "segmentation/skeleton.hpp"

namespace posefusion {
namespace {

using Eigen::Vector3f;

struct Seed {
    Vector3f point;
    std::uint8_t person;  ///< 1..n
};

class PaperSegmenter final : public Segmenter {
public:
    PaperSegmenter(const SegmentationConfig& config, const Intrinsics& camera) : config_(config), camera_(camera) {}

    Segmentation segment(const ColorImage&, const DepthImage& depth, const std::optional<People>& people,
                         const Eigen::Isometry3f&) override {
        LabelImage labels(depth.width(), depth.height());
        const std::vector<Seed> seeds = collect_seeds(people.value_or(People{}), depth);
        if (!seeds.empty()) label(depth, seeds, labels);
        Segmentation result = segmentation_of(std::move(labels));
        for (const Person& person : people.value_or(People{}))
            result.skeletons.push_back(lift_skeleton(person, depth, camera_, {}).value_or(Skeleton{}));
        return result;
    }

    // every frame on its own
    ByteArray state() const override { return {}; }
    void restore(std::span<const std::byte> state) override {
        StateReader(state, "the state of the segmentation").end();
    }

private:
    [[nodiscard]] std::optional<Vector3f> lift(const DepthImage& depth, float u, float v) const {
        if (!std::isfinite(u) || !std::isfinite(v)) return std::nullopt;
        if (!(u > -0.5f && v > -0.5f && u < static_cast<float>(depth.width()) - 0.5f &&
              v < static_cast<float>(depth.height()) - 0.5f))
            return std::nullopt;
        const float z = depth(static_cast<int>(std::lround(u)), static_cast<int>(std::lround(v)));
        if (!(z > 0) || !std::isfinite(z)) return std::nullopt;
        return back_project(u, v, z, camera_);
    }

    [[nodiscard]] std::vector<Seed> collect_seeds(const People& people, const DepthImage& depth) const {
        std::vector<Seed> seeds;
        for (std::size_t p = 0; p < people.size() && p < std::numeric_limits<std::uint8_t>::max(); ++p) {
            const auto person = static_cast<std::uint8_t>(p + 1);
            const auto& joints = people[p].joints;
            for (const JointObservation& joint : joints)
                if (joint.p > 0)
                    if (const auto point = lift(depth, joint.u, joint.v)) seeds.push_back({*point, person});
            for (const auto& [a, b] : kLimbs)
                if (joints[a].p > 0 && joints[b].p > 0) add_limb(joints[a], joints[b], depth, person, seeds);
        }
        return seeds;
    }

    /// Points between two joints that lie, in depth, between them too: the line may leave the limb.
    void add_limb(const JointObservation& from, const JointObservation& to, const DepthImage& depth,
                  std::uint8_t person, std::vector<Seed>& seeds) const {
        constexpr int kSteps = 8;
        const auto a = lift(depth, from.u, from.v), b = lift(depth, to.u, to.v);
        if (!a || !b) return;
        for (int i = 1; i < kSteps; ++i) {
            const float t = static_cast<float>(i) / kSteps;
            const auto point = lift(depth, from.u + t * (to.u - from.u), from.v + t * (to.v - from.v));
            if (!point) continue;
            const float expected = a->z() + t * (b->z() - a->z());
            if (std::abs(point->z() - expected) < config_.radius) seeds.push_back({*point, person});
        }
    }

    void label(const DepthImage& depth, const std::vector<Seed>& seeds, LabelImage& labels) const {
        const int step = std::max(1, config_.paper_step);
        std::vector<Vector3f> points, seed_points;
        std::vector<std::pair<int, int>> pixels;  // upper left corners of the blocks
        for (int v = 0; v < depth.height(); v += step)
            for (int u = 0; u < depth.width(); u += step) {
                const int cu = std::min(u + step / 2, depth.width() - 1),
                          cv = std::min(v + step / 2, depth.height() - 1);
                if (const auto point = lift(depth, static_cast<float>(cu), static_cast<float>(cv)))
                    points.push_back(*point), pixels.push_back({u, v});
            }
        for (const Seed& seed : seeds) seed_points.push_back(seed.point);
        PaperMinCutConfig cut;
        cut.sigma = config_.sigma;
        cut.radius = config_.radius;
        const PaperMinCut result = paper_min_cut(points, seed_points, cut);
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!result.foreground[i]) continue;
            const std::uint8_t person = nearest(seeds, points[i]);
            const auto [u0, v0] = pixels[i];
            for (int v = v0; v < std::min(v0 + step, depth.height()); ++v)
                for (int u = u0; u < std::min(u0 + step, depth.width()); ++u) labels(u, v) = person;
        }
    }

    static std::uint8_t nearest(const std::vector<Seed>& seeds, const Vector3f& point) {
        return std::min_element(seeds.begin(), seeds.end(),
                                [&](const Seed& a, const Seed& b) {
                                    return (a.point - point).squaredNorm() < (b.point - point).squaredNorm();
                                })
            ->person;
    }

    SegmentationConfig config_;
    Intrinsics camera_;
};

}  // namespace

std::unique_ptr<Segmenter> make_paper_segmenter(const SegmentationConfig& config, const Intrinsics& camera) {
    return std::make_unique<PaperSegmenter>(config, camera);
}

}  // namespace posefusion
