#include "segmentation/skeleton.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/core/median.hpp"
#include "engine/core/pinhole.hpp"

namespace posefusion {
namespace {

/// Joints lie this far behind the visible surface, metres (half the thickness of the body there).
constexpr std::array<float, kJointCount> kInset = {
    0.06f, 0.07f,                // nose, neck
    0.07f, 0.05f, 0.03f,         // right arm
    0.07f, 0.05f, 0.03f,         // left arm
    0.10f, 0.06f, 0.05f,         // right leg
    0.10f, 0.06f, 0.05f,         // left leg
    0.06f, 0.06f, 0.04f, 0.04f,  // eyes, ears
};

/// Longest bone of a large adult for each entry of kLimbs, metres.
constexpr std::array<float, 17> kLongestBone = {0.24f, 0.24f, 0.38f, 0.33f, 0.38f, 0.33f, 0.70f, 0.54f, 0.54f,
                                                0.70f, 0.54f, 0.54f, 0.34f, 0.10f, 0.16f, 0.10f, 0.16f};

bool is_limb_end(int j) {
    return j == RightElbow || j == RightWrist || j == LeftElbow || j == LeftWrist || j == RightKnee ||
           j == RightAnkle || j == LeftKnee || j == LeftAnkle;
}

struct Candidate {
    float depth = 0;      ///< of the joint (surface plus inset), metres
    float cost = 0;       ///< of choosing it, without the bones
    bool hidden = false;  ///< the surface seen is not the person's: depth is the person's distance
};

float depth_at(const DepthImage& depth, float u, float v) {
    const int x = static_cast<int>(std::lround(u)), y = static_cast<int>(std::lround(v));
    if (!depth.contains(x, y)) return 0;
    const float z = depth(x, y);
    return std::isfinite(z) ? z : 0;
}

bool usable(const JointObservation& joint) { return joint.p > 0 && std::isfinite(joint.u) && std::isfinite(joint.v); }

/// The distance at which most of the person stands: the mode of depths sampled along the bones.
float person_distance(const Person& person, const DepthImage& depth, const LiftingConfig& config) {
    constexpr int kSamplesPerBone = 12;
    constexpr float kUpperWeight = 3;  // furniture hides the lower body more often, and thin limbs are missed
    struct Sample {
        float z, weight;
    };
    std::vector<Sample> samples;
    const auto sample_line = [&](int a, int b, float weight) {
        const JointObservation &from = person.joints[a], &to = person.joints[b];
        if (!usable(from) || !usable(to)) return;
        for (int i = 0; i < kSamplesPerBone; ++i) {
            const float t = (static_cast<float>(i) + 0.5f) / kSamplesPerBone;
            const float z = depth_at(depth, from.u + t * (to.u - from.u), from.v + t * (to.v - from.v));
            if (z > 0) samples.push_back({z, weight});
        }
    };
    for (const auto& [a, b] : kLimbs)
        sample_line(a, b, is_limb_end(b) || b == RightHip || b == LeftHip ? 1 : kUpperWeight);
    sample_line(RightShoulder, LeftHip, 1);
    sample_line(LeftShoulder, RightHip, 1);
    for (const JointObservation& joint : person.joints)
        if (usable(joint))
            if (const float z = depth_at(depth, joint.u, joint.v); z > 0) samples.push_back({z, 1});

    float best = 0, best_score = 0;
    for (const Sample& centre : samples) {
        float score = 0;
        for (const Sample& s : samples) {
            const float d = (s.z - centre.z) / config.torso_spread;
            score += s.weight * std::exp(-d * d);
        }
        if (score > best_score) best = centre.z, best_score = score;
    }
    return best;
}

/// Clusters of the depths around a joint, each with its cost, and "hidden" as the last resort.
std::vector<Candidate> candidates_of(int j, const JointObservation& joint, float distance, const DepthImage& depth,
                                     const Intrinsics& camera, const LiftingConfig& config) {
    constexpr int kGrid = 4;            // (2 kGrid + 1)^2 samples
    constexpr float kShareCost = 0.5f;  // a cluster that fills little of the window is less likely
    constexpr float kMaxDeviation = 3;
    const float half = config.window * camera.fx / distance;
    std::vector<float> depths;
    for (int y = -kGrid; y <= kGrid; ++y)
        for (int x = -kGrid; x <= kGrid; ++x) {
            const float z = depth_at(depth, joint.u + half * static_cast<float>(x) / kGrid,
                                     joint.v + half * static_cast<float>(y) / kGrid);
            if (z > 0) depths.push_back(z);
        }
    std::sort(depths.begin(), depths.end());

    std::vector<Candidate> candidates;
    const float spread = is_limb_end(j) ? config.limb_spread : config.torso_spread;
    for (std::size_t begin = 0; begin < depths.size();) {
        std::size_t end = begin + 1;
        while (end < depths.size() && depths[end] - depths[end - 1] < config.cluster_gap) ++end;
        const float z = depths[begin + (end - begin) / 2];
        const float share = static_cast<float>(end - begin) / static_cast<float>(depths.size());
        const float deviation = std::min(std::abs(z - distance) / spread, kMaxDeviation);
        candidates.push_back({z + kInset[j], kShareCost * (1 - share) + 0.5f * deviation * deviation, false});
        begin = end;
    }
    candidates.push_back({distance + kInset[j], config.hidden_cost, true});
    return candidates;
}

Eigen::Vector3f lift(const JointObservation& joint, float z, const Intrinsics& camera) {
    return back_project(joint.u, joint.v, z, camera);
}

/// Cost of a bone longer than anatomy allows.
float bone_cost(float length, float longest, float slack) {
    constexpr float kMaxCost = 4;
    const float excess = std::max(0.0f, length - longest) / slack;
    return std::min(0.5f * excess * excess, kMaxCost);
}

/// The depths seen along a bone, and how far along it the surfaces of its two joints extend. Each surface is followed
/// from its joint, across things that cross in front of it.
struct BoneSurface {
    static constexpr int kSamples = 24;
    std::array<float, kSamples + 1> z{};  ///< from parent to child
    int parent_end, child_end;            ///< last sample on the surface of each; -1, kSamples + 1: not even the joint
    float parent_z, child_z;              ///< depth at these samples
    float allowed;  ///< depth step between the two that the covered part in between explains, metres

    BoneSurface(const JointObservation& from, float z_from, const JointObservation& to, float z_to, bool limb,
                const DepthImage& depth, float gap) {
        const float slope = (limb ? 0.08f : 0.05f) / kSamples;  // metres of depth gained per sample while covered
        for (int i = 0; i <= kSamples; ++i) {
            const float t = static_cast<float>(i) / kSamples;
            z[i] = depth_at(depth, from.u + t * (to.u - from.u), from.v + t * (to.v - from.v));
        }
        const auto follow = [&](int before, int step, float& followed) {
            int last = before;
            for (int i = before + step; i >= 0 && i <= kSamples; i += step) {
                const float covered = slope * static_cast<float>(std::abs(i - last) - 1);
                if (z[i] <= 0 || std::abs(z[i] - followed) > gap + covered) continue;
                followed = z[i];
                last = i;
            }
            return last;
        };
        parent_z = z_from;
        child_z = z_to;
        parent_end = follow(-1, 1, parent_z);
        child_end = follow(kSamples + 1, -1, child_z);
        allowed = gap + slope * static_cast<float>(std::max(child_end - parent_end - 1, 0));
    }
};

/// Cost of a bone that leaves the surface. Where the surfaces of its joints meet there must be no step: a joint hidden
/// by furniture reads the furniture, whose surface ends with a step to that of the joint before.
float surface_cost(const BoneSurface& bone, const LiftingConfig& config) {
    if (bone.parent_end >= bone.child_end) return 0;
    if (bone.parent_z - bone.child_z > bone.allowed) return config.occluder_cost;
    if (bone.child_z - bone.parent_z > bone.allowed) return config.behind_cost;
    return 0;
}

/// Exact minimum over the tree kLimbs spans (parents come before children in that list).
std::array<int, kJointCount> choose(const std::array<std::vector<Candidate>, kJointCount>& candidates,
                                    const Person& person, const DepthImage& depth, const Intrinsics& camera,
                                    const LiftingConfig& config) {
    std::array<std::vector<float>, kJointCount> cost;
    std::array<std::vector<int>, kJointCount> choice;  // choice[child][parent candidate]
    for (int j = 0; j < kJointCount; ++j)
        for (const Candidate& c : candidates[j]) cost[j].push_back(c.cost);

    for (std::size_t e = kLimbs.size(); e-- > 0;) {
        const auto [parent, child] = kLimbs[e];
        if (candidates[child].empty()) continue;
        if (candidates[parent].empty()) {  // the link is missing: the child decides alone
            const auto least = std::min_element(cost[child].begin(), cost[child].end());
            choice[child].assign(1, static_cast<int>(least - cost[child].begin()));
            continue;
        }
        choice[child].resize(candidates[parent].size());
        for (std::size_t p = 0; p < candidates[parent].size(); ++p) {
            float least = 0;
            int least_index = -1;
            for (std::size_t c = 0; c < candidates[child].size(); ++c) {
                float total = cost[child][c];
                const float zp = candidates[parent][p].depth, zc = candidates[child][c].depth;
                const float length =
                    (lift(person.joints[parent], zp, camera) - lift(person.joints[child], zc, camera)).norm();
                total += bone_cost(length, kLongestBone[e], config.bone_slack);
                if (!candidates[child][c].hidden) {
                    total += surface_cost({person.joints[parent], zp - kInset[parent], person.joints[child],
                                           zc - kInset[child], is_limb_end(child), depth, config.surface_gap},
                                          config);
                }
                if (least_index < 0 || total < least) least = total, least_index = static_cast<int>(c);
            }
            cost[parent][p] += least;
            choice[child][p] = least_index;
        }
    }

    std::array<int, kJointCount> chosen;
    chosen.fill(-1);
    if (!candidates[Neck].empty())
        chosen[Neck] = static_cast<int>(std::min_element(cost[Neck].begin(), cost[Neck].end()) - cost[Neck].begin());
    for (const auto& [parent, child] : kLimbs)
        if (!candidates[child].empty()) chosen[child] = choice[child][chosen[parent] < 0 ? 0 : chosen[parent]];
    return chosen;
}

/// Joints without readable depth take it from their nearest neighbours along the bones, else from the person.
void infer_unknown(Skeleton& skeleton, const Person& person, const std::array<bool, kJointCount>& unknown,
                   float distance, const Intrinsics& camera) {
    for (int j = 0; j < kJointCount; ++j) {
        if (!unknown[j]) continue;
        float sum = 0;
        int count = 0;
        for (const auto& [a, b] : kLimbs) {
            const int other = a == j ? b : b == j ? a : -1;
            if (other < 0 || skeleton.source[other] != JointSource::Measured) continue;
            sum += skeleton.joint[other].z();
            ++count;
        }
        const float z = count > 0 ? sum / static_cast<float>(count) : distance + kInset[j];
        skeleton.joint[j] = lift(person.joints[j], z, camera);
    }
    for (int j = 0; j < kJointCount; ++j)
        if (unknown[j]) skeleton.source[j] = JointSource::Inferred;
}

/// Surfaces seen in front of hidden joints: from the end of the surface of the joint before to the hidden one.
void find_occluders(Skeleton& skeleton, const Person& person, const DepthImage& depth, const Intrinsics& camera,
                    const LiftingConfig& config) {
    for (const auto& [parent, child] : kLimbs) {
        if (skeleton.source[parent] != JointSource::Measured || skeleton.source[child] != JointSource::Inferred)
            continue;
        const JointObservation &from = person.joints[parent], &to = person.joints[child];
        const BoneSurface bone(from, skeleton.joint[parent].z() - kInset[parent], to,
                               skeleton.joint[child].z() - kInset[child], is_limb_end(child), depth,
                               config.surface_gap);
        for (int i = bone.parent_end + 1; i <= BoneSurface::kSamples; ++i) {
            if (bone.z[i] <= 0 || bone.z[i] > bone.parent_z - config.surface_gap) continue;
            const float t = static_cast<float>(i) / BoneSurface::kSamples;
            skeleton.occluders.push_back(
                lift({from.u + t * (to.u - from.u), from.v + t * (to.v - from.v), 1}, bone.z[i], camera));
        }
    }
}

bool plausible(const Skeleton& skeleton, const LiftingConfig& config) {
    Eigen::Vector3f low = Eigen::Vector3f::Constant(1e9f), high = -low;
    int measured = 0;
    for (int j = 0; j < kJointCount; ++j) {
        if (skeleton.source[j] != JointSource::Measured) continue;
        low = low.cwiseMin(skeleton.joint[j]);
        high = high.cwiseMax(skeleton.joint[j]);
        ++measured;
    }
    if (measured < config.min_joints) return false;
    const float extent = (high - low).head<2>().norm();
    return extent >= config.min_extent && extent <= config.max_extent;
}

Eigen::Vector3f center_of(const Skeleton& s) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    int count = 0;
    for (int j = 0; j < kJointCount; ++j)
        if (s.has(j)) sum += s.joint[j], ++count;
    return count > 0 ? Eigen::Vector3f(sum / static_cast<float>(count)) : sum;
}

}  // namespace

float joint_inset(int joint) { return kInset[joint]; }

float distance_between(const Skeleton& a, const Skeleton& b) {
    std::vector<float> distances;
    for (int j = 0; j < kJointCount; ++j)
        if (a.has(j) && b.has(j)) distances.push_back((a.joint[j] - b.joint[j]).norm());
    if (distances.empty()) return (center_of(a) - center_of(b)).norm();
    return upper_median(distances);
}

std::optional<Skeleton> lift_skeleton(const Person& person, const DepthImage& depth, const Intrinsics& camera,
                                      const LiftingConfig& config) {
    const float distance = person_distance(person, depth, config);
    if (distance <= 0) return std::nullopt;

    std::array<std::vector<Candidate>, kJointCount> candidates;
    for (int j = 0; j < kJointCount; ++j)
        if (usable(person.joints[j]))
            candidates[j] = candidates_of(j, person.joints[j], distance, depth, camera, config);
    const auto chosen = choose(candidates, person, depth, camera, config);

    Skeleton skeleton;
    skeleton.box = person.box;
    std::array<bool, kJointCount> unknown{};
    for (int j = 0; j < kJointCount; ++j) {
        if (chosen[j] < 0) continue;
        const float z = candidates[j][static_cast<std::size_t>(chosen[j])].depth;
        unknown[j] = candidates[j][static_cast<std::size_t>(chosen[j])].hidden;
        if (unknown[j]) continue;
        skeleton.joint[j] = lift(person.joints[j], z, camera);
        skeleton.source[j] = JointSource::Measured;
    }
    infer_unknown(skeleton, person, unknown, distance, camera);
    for (int j = 0; j < kJointCount; ++j)
        if (skeleton.has(j)) skeleton.confidence[j] = person.joints[j].p;
    find_occluders(skeleton, person, depth, camera, config);
    if (!plausible(skeleton, config)) return std::nullopt;
    return skeleton;
}

}  // namespace posefusion
