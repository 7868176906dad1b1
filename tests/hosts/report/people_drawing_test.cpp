#include "hosts/report/people_drawing.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr Rgb8 kGrey{100, 100, 100};

TEST(PeopleDrawing, TintsPeopleAndLeavesTheRestAlone) {
    const ColorImage color(40, 30, kGrey);
    LabelImage labels(40, 30);
    for (int v = 10; v < 20; ++v)
        for (int u = 10; u < 20; ++u) labels(u, v) = u < 15 ? 1 : 2;
    const ColorImage drawn = draw_people(color, labels, {});
    EXPECT_EQ(drawn(5, 5), kGrey);
    EXPECT_EQ(drawn(9, 15), Rgb8(kGrey)) << "pixels next to a person stay";
    EXPECT_FALSE(drawn(12, 15) == kGrey);
    EXPECT_FALSE(drawn(12, 15) == drawn(17, 15)) << "people have colours of their own";
    EXPECT_FALSE(drawn(12, 15) == drawn(10, 15)) << "the outline is stronger";
}

TEST(PeopleDrawing, DrawsFoundJointsOnly) {
    const ColorImage color(40, 30, kGrey);
    Person person;
    person.joints[Nose] = {10, 10, 0.9f};
    person.joints[LeftHip] = {30, 20, 0.0f};
    const ColorImage drawn = draw_people(color, {}, {person});
    EXPECT_FALSE(drawn(10, 10) == kGrey);
    EXPECT_EQ(drawn(30, 20), kGrey);
}

TEST(PeopleDrawing, DrawsLimbsBetweenFoundJoints) {
    Person person;
    person.joints[Neck] = {5, 15, 1};
    person.joints[RightShoulder] = {35, 15, 1};
    EXPECT_FALSE(draw_people(ColorImage(40, 30, kGrey), {}, {person})(20, 15) == kGrey);
}

TEST(PeopleDrawing, OddInputDoesNoHarm) {
    const ColorImage color(40, 30, kGrey);
    Person person;
    person.joints[Nose] = {-1e9f, 1e9f, 1};
    person.joints[Neck] = {std::numeric_limits<float>::quiet_NaN(), 0, 1};
    person.joints[RightEye] = {-300, 500, 1};
    person.joints[RightEar] = {500, -300, 1};
    EXPECT_NO_THROW((void)draw_people(color, LabelImage(40, 30, 255), {person}));
    EXPECT_THROW((void)draw_people(color, LabelImage(4, 3), {}), Error);
}

}  // namespace
}  // namespace posefusion
