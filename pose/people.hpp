#pragma once
#include "pose/joints.hpp"

namespace posefusion {

/// When two detections are the same person.
struct DuplicateRule {
    float share = 0.5f;      ///< the detection with the lower score is removed if at least this share of its joints
                             ///< coincides with the other's
    float distance = 0.05f;  ///< two joints are the same if closer than this share of the larger box's diagonal
};

/// Sorted by score, without duplicates, at most kMaxPeople. Equal scores keep their order.
[[nodiscard]] People best_people(People people, const DuplicateRule& rule);

/// Mean p of a person's `count` most certain joints; missing joints count as 0.
[[nodiscard]] float mean_certainty_of_best_joints(const Person& person, int count);

/// The number of joints with p > 0.
[[nodiscard]] int joints_found(const Person& person);

/// Joints less certain than `threshold` become "not found".
void drop_joints_below(Person& person, float threshold);

/// The smallest box around all joints found; empty if there is none.
[[nodiscard]] PixelBox box_of_joints(const Person& person);

}  // namespace posefusion
