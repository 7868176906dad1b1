#include "hosts/evaluate/pose_matching.hpp"

namespace posefusion {
namespace {

/// Pairs (index into few, index into many). Of two that are equally near, the earlier.
PoseMatches nearest_of(const std::vector<Stamp>& few, const std::vector<Stamp>& many, Stamp max_difference) {
    PoseMatches matches;
    for (std::size_t i = 0; i < few.size(); ++i)
        if (const auto nearest = nearest_stamp(many, few[i], max_difference + Stamp{1}))
            matches.emplace_back(i, *nearest);
    return matches;
}

}  // namespace

const char* name_of(MatchingRule rule) { return rule == MatchingRule::ClosestFirst ? "tum" : "evo"; }

std::vector<Stamp> stamps_of(const Trajectory& trajectory) {
    std::vector<Stamp> stamps;
    stamps.reserve(trajectory.size());
    for (const StampedPose& pose : trajectory) stamps.push_back(pose.stamp);
    return stamps;
}

PoseMatches match_poses(const Trajectory& groundtruth, const Trajectory& estimate, const MatchingConfig& config) {
    const std::vector<Stamp> truth = stamps_of(groundtruth), model = stamps_of(estimate);
    if (config.rule == MatchingRule::ClosestFirst) return associate(truth, model, config.max_difference);
    if (truth.size() < model.size()) return nearest_of(truth, model, config.max_difference);
    PoseMatches matches = nearest_of(model, truth, config.max_difference);
    for (auto& [g, e] : matches) std::swap(g, e);
    return matches;
}

Trajectory shifted(Trajectory trajectory, Stamp offset) {
    for (StampedPose& pose : trajectory) pose.stamp += offset;
    return trajectory;
}

}  // namespace posefusion
