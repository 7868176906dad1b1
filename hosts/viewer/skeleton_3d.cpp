#include "hosts/viewer/skeleton_3d.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/median.hpp"
#include "engine/core/pinhole.hpp"

namespace posefusion {
namespace {

constexpr int kWindowShare = 100;     // depth is searched within this fraction of the image's width ...
constexpr int kMinWindow = 2;         // ... but at least this many pixels
constexpr float kMaxFromBody = 1.0f;  // metres: a joint this far in front of or behind the body does not belong to it
constexpr int kMinJoints = 2;

/// Depth of the body around a joint; 0 = none.
float depth_at(const JointObservation& joint, const DepthImage& depth, const LabelImage& labels) {
    if (joint.p <= 0 || !(std::abs(joint.u) < 1e6f && std::abs(joint.v) < 1e6f)) return 0;
    const int u = static_cast<int>(std::lround(joint.u)), v = static_cast<int>(std::lround(joint.v));
    const int reach = std::max(kMinWindow, depth.width() / kWindowShare);
    std::vector<float> found;
    for (int y = v - reach; y <= v + reach; ++y) {
        for (int x = u - reach; x <= u + reach; ++x) {
            if (!depth.contains(x, y) || !(depth(x, y) > 0)) continue;
            if (labels.empty() || labels(x, y) != 0) found.push_back(depth(x, y));
        }
    }
    return found.empty() ? 0 : upper_median(found);
}

}  // namespace

std::vector<Skeleton3d> lift_joints(const People& people, const DepthImage& depth, const LabelImage& labels,
                                    const Intrinsics& camera, const Eigen::Isometry3f& T_world_camera) {
    std::vector<Skeleton3d> skeletons;
    for (const Person& person : people) {
        std::array<float, kJointCount> z{};
        std::vector<float> found;
        for (std::size_t j = 0; j < z.size(); ++j) {
            z[j] = depth_at(person.joints[j], depth, labels);
            if (z[j] > 0) found.push_back(z[j]);
        }
        if (found.size() < kMinJoints) continue;
        const float body = upper_median(found);
        Skeleton3d skeleton;
        int lifted = 0;
        for (std::size_t j = 0; j < z.size(); ++j) {
            if (z[j] <= 0 || std::abs(z[j] - body) > kMaxFromBody) continue;
            const JointObservation& joint = person.joints[j];
            skeleton[j] = T_world_camera * back_project(joint.u, joint.v, z[j], camera);
            ++lifted;
        }
        if (lifted >= kMinJoints) skeletons.push_back(skeleton);
    }
    return skeletons;
}

}  // namespace posefusion
