#include "pose/people.hpp"

#include <gtest/gtest.h>

namespace posefusion {
namespace {

/// A person whose joints stand in a column, 10 px apart.
Person person_at(float u, float score) {
    Person person;
    person.score = score;
    for (int j = 0; j < kJointCount; ++j) person.joints[j] = {u, 10.0f * static_cast<float>(j), 0.9f};
    person.box = {u - 30, 0, u + 30, 170};
    return person;
}

TEST(People, AreSortedByScore) {
    const People people = best_people({person_at(50, 0.3f), person_at(200, 0.9f), person_at(400, 0.6f)}, {});
    ASSERT_EQ(people.size(), 3u);
    EXPECT_FLOAT_EQ(people[0].score, 0.9f);
    EXPECT_FLOAT_EQ(people[1].score, 0.6f);
    EXPECT_FLOAT_EQ(people[2].score, 0.3f);
}

TEST(People, ASecondDetectionOfTheSameBodyGoes) {
    const People people = best_people({person_at(101, 0.4f), person_at(100, 0.8f)}, {});
    ASSERT_EQ(people.size(), 1u);
    EXPECT_FLOAT_EQ(people[0].score, 0.8f);
}

TEST(People, AFragmentOfABodyGoes) {
    Person fragment = person_at(100, 0.3f);
    for (int j = 4; j < kJointCount; ++j) fragment.joints[j] = {};
    EXPECT_EQ(best_people({person_at(100, 0.8f), fragment}, {}).size(), 1u);
}

TEST(People, TwoWhoStandCloseStay) {
    EXPECT_EQ(best_people({person_at(100, 0.8f), person_at(125, 0.7f)}, {}).size(), 2u);
}

TEST(People, AreAtMostFifteenTheBest) {
    People crowd;
    for (int i = 0; i < 20; ++i)
        crowd.push_back(person_at(100.0f * static_cast<float>(i), 0.3f + 0.01f * static_cast<float>(i)));
    const People people = best_people(crowd, {});
    ASSERT_EQ(people.size(), 15u);
    EXPECT_FLOAT_EQ(people.back().score, 0.35f);
}

TEST(People, MeanOfBestJointsCountsTheMissingOnes) {
    Person person;
    person.joints[Nose].p = 0.8f;
    person.joints[Neck].p = 0.4f;
    EXPECT_FLOAT_EQ(mean_certainty_of_best_joints(person, 1), 0.8f);
    EXPECT_FLOAT_EQ(mean_certainty_of_best_joints(person, 4), 0.3f);
}

TEST(People, BoxHoldsTheJointsFoundAndIsEmptyWithoutAny) {
    Person person;
    EXPECT_TRUE(box_of_joints(person).empty());
    person.joints[Nose] = {10, 20, 0.5f};
    person.joints[LeftAnkle] = {40, 90, 0.5f};
    person.joints[RightAnkle] = {900, 900, 0};
    const PixelBox box = box_of_joints(person);
    EXPECT_FLOAT_EQ(box.u_min, 10);
    EXPECT_FLOAT_EQ(box.v_min, 20);
    EXPECT_FLOAT_EQ(box.u_max, 40);
    EXPECT_FLOAT_EQ(box.v_max, 90);
}

}  // namespace
}  // namespace posefusion
