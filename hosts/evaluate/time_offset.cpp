#include "hosts/evaluate/time_offset.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/error.hpp"
#include "hosts/evaluate/error_statistics.hpp"

namespace posefusion {
namespace {

constexpr Stamp kResolution = std::chrono::microseconds(100);
/// More poses do not make the offset more accurate.
constexpr std::size_t kMostPoses = 2000;

/// How well the positions fit at an offset.
class Fit {
public:
    Fit(const Trajectory& groundtruth, const Trajectory& estimate, bool scale)
        : groundtruth_(groundtruth), stamps_(stamps_of(groundtruth)), scale_(scale) {
        const std::size_t every = 1 + estimate.size() / kMostPoses;
        for (std::size_t i = 0; i < estimate.size(); i += every) estimate_.push_back(estimate[i]);
        std::vector<double> intervals{0};
        for (std::size_t i = 1; i < stamps_.size(); ++i)
            intervals.push_back(static_cast<double>((stamps_[i] - stamps_[i - 1]).count()));
        constexpr double kGap = 5;  // median intervals: longer gaps are not interpolated
        longest_gap_ = Stamp{std::llround(kGap * median_of(std::move(intervals)))};
    }

    struct Quality {
        std::size_t poses = 0;
        double rmse = std::numeric_limits<double>::infinity();
    };
    [[nodiscard]] Quality at(Stamp offset) const {
        Trajectory truth, model;
        PoseMatches matches;
        for (const StampedPose& pose : estimate_) {
            StampedPose at = pose;
            if (!interpolate(pose.stamp + offset, at.T_world_camera)) continue;
            matches.emplace_back(truth.size(), truth.size());
            truth.push_back(at);
            model.push_back(pose);
        }
        constexpr std::size_t kFewest = 3;
        if (matches.size() < kFewest) return {};
        const TrajectoryAlignment alignment = align_trajectories(truth, model, matches, {AlignmentRule::Rigid, scale_});
        double squares = 0;
        for (std::size_t i = 0; i < truth.size(); ++i)
            squares += (alignment.T_groundtruth_estimate * (alignment.scale * model[i].T_world_camera.translation()) -
                        truth[i].T_world_camera.translation())
                           .squaredNorm();
        return {truth.size(), std::sqrt(squares / static_cast<double>(truth.size()))};
    }

private:
    /// Interpolates the position. @return whether it is known
    bool interpolate(Stamp stamp, Eigen::Isometry3d& pose) const {
        const auto after = std::lower_bound(stamps_.begin(), stamps_.end(), stamp);
        if (after == stamps_.end()) return false;
        const auto j = static_cast<std::size_t>(after - stamps_.begin());
        if (*after == stamp) {
            pose = groundtruth_[j].T_world_camera;
            return true;
        }
        if (j == 0 || stamps_[j] - stamps_[j - 1] > longest_gap_) return false;
        const double share = static_cast<double>((stamp - stamps_[j - 1]).count()) /
                             static_cast<double>((stamps_[j] - stamps_[j - 1]).count());
        pose.translation() = (1 - share) * groundtruth_[j - 1].T_world_camera.translation() +
                             share * groundtruth_[j].T_world_camera.translation();
        return true;
    }

    const Trajectory& groundtruth_;
    std::vector<Stamp> stamps_;
    Trajectory estimate_;
    bool scale_;
    Stamp longest_gap_{};
};

}  // namespace

Stamp find_time_offset(const Trajectory& groundtruth, const Trajectory& estimate, const TimeOffsetConfig& config) {
    const Fit fit(groundtruth, estimate, config.scale);
    std::vector<Stamp> offsets;
    std::vector<Fit::Quality> qualities;
    std::size_t most = 0;
    for (Stamp offset = -config.range; offset <= config.range; offset += config.step) {
        offsets.push_back(offset);
        qualities.push_back(fit.at(offset));
        most = std::max(most, qualities.back().poses);
    }
    // A few poses always fit well: nearly as many as at the best offset are required.
    constexpr double kEnough = 0.8;
    std::size_t best = offsets.size();
    double worst = 0;
    for (std::size_t i = 0; i < offsets.size(); ++i) {
        if (qualities[i].poses == 0 || static_cast<double>(qualities[i].poses) < kEnough * static_cast<double>(most))
            continue;
        if (best == offsets.size() || qualities[i].rmse < qualities[best].rmse) best = i;
        worst = std::max(worst, qualities[i].rmse);
    }
    constexpr double kDifference = 1.02, kRounding = 1e-6;  // metres
    if (most == 0) throw Error("the time offset cannot be found: the trajectories have no time in common");
    if (worst < kDifference * qualities[best].rmse + kRounding)
        throw Error("the time offset cannot be found: the trajectories fit equally well at any; give it as a number");
    if (best == 0 || best + 1 == offsets.size())
        throw Error("the time offset cannot be found: the best fit is at the end of the range of " +
                    std::to_string(std::chrono::round<std::chrono::seconds>(config.range).count()) +
                    " s; give it as a number");
    // Ternary search between the neighbours.
    Stamp low = offsets[best - 1], high = offsets[best + 1];
    while (high - low > kResolution) {
        const Stamp third = (high - low) / 3;
        if (fit.at(low + third).rmse <= fit.at(high - third).rmse)
            high -= third;
        else
            low += third;
    }
    return (low + high) / 2 / kResolution * kResolution;
}

}  // namespace posefusion
