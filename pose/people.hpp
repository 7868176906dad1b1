#pragma once
#include "pose/joints.hpp"

namespace posefusion {

/// When two detections are one person.
struct DuplicateRule {
    float share =
        0.5f;  ///< the one with the lower score is removed if at least this share of its joints lies on the other's
    float distance = 0.05f;  ///< two joints are the same if closer than this share of the larger box's diagonal
};

/// Sorted by score, without duplicates, at most kMaxPeople. Equal scores keep their order.
[[nodiscard]] People best_people(People people, const DuplicateRule& rule);

/// Mean p of a person's `count` most certain joints, not found ones counting as 0.
[[nodiscard]] float mean_certainty_of_best_joints(const Person& person, int count);

/// How many joints have p > 0.
[[nodiscard]] int joints_found(const Person& person);

/// Joints less certain than `threshold` become "not found".
void drop_joints_below(Person& person, float threshold);

/// The smallest box that holds all joints found; empty if there is none.
[[nodiscard]] PixelBox box_of_joints(const Person& person);

}  // namespace posefusion
