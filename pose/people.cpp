#include "pose/people.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

namespace posefusion {
namespace {

float diagonal(const PixelBox& box) { return std::hypot(box.u_max - box.u_min, box.v_max - box.v_min); }

bool is_duplicate(const Person& candidate, const Person& kept, const DuplicateRule& rule) {
    const float same = rule.distance * std::max(diagonal(candidate.box), diagonal(kept.box));
    int found = 0, shared = 0;
    for (int j = 0; j < kJointCount; ++j) {
        const JointObservation &a = candidate.joints[j], &b = kept.joints[j];
        if (a.p <= 0) continue;
        ++found;
        if (b.p > 0 && std::hypot(a.u - b.u, a.v - b.v) < same) ++shared;
    }
    return found > 0 && static_cast<float>(shared) >= rule.share * static_cast<float>(found);
}

}  // namespace

People best_people(People people, const DuplicateRule& rule) {
    std::stable_sort(people.begin(), people.end(), [](const Person& a, const Person& b) { return a.score > b.score; });
    People kept;
    for (const Person& person : people) {
        if (kept.size() == static_cast<std::size_t>(kMaxPeople)) break;
        const auto duplicates = [&](const Person& other) { return is_duplicate(person, other, rule); };
        if (std::none_of(kept.begin(), kept.end(), duplicates)) kept.push_back(person);
    }
    return kept;
}

float mean_certainty_of_best_joints(const Person& person, int count) {
    std::array<float, kJointCount> certainties{};
    std::transform(person.joints.begin(), person.joints.end(), certainties.begin(),
                   [](const JointObservation& joint) { return joint.p; });
    std::sort(certainties.begin(), certainties.end(), std::greater<>());
    return std::accumulate(certainties.begin(), certainties.begin() + count, 0.0f) / static_cast<float>(count);
}

int joints_found(const Person& person) {
    const auto found = [](const JointObservation& joint) { return joint.p > 0; };
    return static_cast<int>(std::count_if(person.joints.begin(), person.joints.end(), found));
}

void drop_joints_below(Person& person, float threshold) {
    for (JointObservation& joint : person.joints) {
        if (joint.p < threshold) joint = {};
    }
}

PixelBox box_of_joints(const Person& person) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    PixelBox box{kInfinity, kInfinity, -kInfinity, -kInfinity};
    for (const JointObservation& joint : person.joints) {
        if (joint.p <= 0) continue;
        box = {std::min(box.u_min, joint.u), std::min(box.v_min, joint.v), std::max(box.u_max, joint.u),
               std::max(box.v_max, joint.v)};
    }
    return box.empty() ? PixelBox{} : box;
}

}  // namespace posefusion
