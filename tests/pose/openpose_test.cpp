#include "pose/openpose.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr int kRows = 60, kColumns = 80;    // of the maps
constexpr int kWidth = 640, kHeight = 480;  // of the image: one cell is 8 x 8 pixels

/// OpenPose's COCO limbs and the channel of each field's x, as published; the test has its own copy.
struct Limb {
    int from, to, channel;
};
constexpr std::array<Limb, 19> kLimbsOfCoco{{{1, 2, 12},
                                             {1, 5, 20},
                                             {2, 3, 14},
                                             {3, 4, 16},
                                             {5, 6, 22},
                                             {6, 7, 24},
                                             {1, 8, 0},
                                             {8, 9, 2},
                                             {9, 10, 4},
                                             {1, 11, 6},
                                             {11, 12, 8},
                                             {12, 13, 10},
                                             {1, 0, 28},
                                             {0, 14, 30},
                                             {14, 16, 34},
                                             {0, 15, 32},
                                             {15, 17, 36},
                                             {2, 16, 18},
                                             {5, 17, 26}}};

struct Point {
    float x, y;
};

/// Joints of someone who stands, in cells, the neck at the origin.
constexpr std::array<Point, kJointCount> kStanding{{{0, -5},
                                                    {0, 0},
                                                    {-4, 0},
                                                    {-5, 6},
                                                    {-5, 12},
                                                    {4, 0},
                                                    {5, 6},
                                                    {5, 12},
                                                    {-2, 12},
                                                    {-2, 20},
                                                    {-2, 28},
                                                    {2, 12},
                                                    {2, 20},
                                                    {2, 28},
                                                    {-1, -6},
                                                    {1, -6},
                                                    {-2, -5},
                                                    {2, -5}}};

Point joint_of(Point neck, int joint) { return {neck.x + kStanding[joint].x, neck.y + kStanding[joint].y}; }

OpenPoseMaps empty_maps() {
    OpenPoseMaps maps{Tensor(19, kRows, kColumns), Tensor(38, kRows, kColumns)};
    std::fill(maps.heat.plane(18), maps.heat.plane(18) + kRows * kColumns, 1.0f);
    return maps;
}

/// A Gaussian of sigma 1 cell, as networks are trained on.
void draw_joint(OpenPoseMaps& maps, int joint, Point at, float height = 0.9f) {
    for (int y = 0; y < kRows; ++y) {
        for (int x = 0; x < kColumns; ++x) {
            const float dx = static_cast<float>(x) - at.x, dy = static_cast<float>(y) - at.y;
            const float value = height * std::exp(-(dx * dx + dy * dy) / 2);
            maps.heat.at(joint, y, x) = std::max(maps.heat.at(joint, y, x), value);
            maps.heat.at(18, y, x) = std::min(maps.heat.at(18, y, x), 1 - value);
        }
    }
}

/// Unit vectors within 1 cell of the limb.
void draw_limb(OpenPoseMaps& maps, const Limb& limb, Point a, Point b) {
    const float length = std::hypot(b.x - a.x, b.y - a.y), ux = (b.x - a.x) / length, uy = (b.y - a.y) / length;
    for (int y = 0; y < kRows; ++y) {
        for (int x = 0; x < kColumns; ++x) {
            const float dx = static_cast<float>(x) - a.x, dy = static_cast<float>(y) - a.y;
            const float along = dx * ux + dy * uy, across = std::abs(dx * uy - dy * ux);
            if (along < -1 || along > length + 1 || across > 1) continue;
            maps.paf.at(limb.channel, y, x) = ux;
            maps.paf.at(limb.channel + 1, y, x) = uy;
        }
    }
}

using JointSet = std::array<bool, kJointCount>;
JointSet everything() {
    JointSet all;
    all.fill(true);
    return all;
}

void draw_person(OpenPoseMaps& maps, Point neck, const JointSet& shown = everything()) {
    for (int j = 0; j < kJointCount; ++j) {
        if (shown[j]) draw_joint(maps, j, joint_of(neck, j));
    }
    for (const Limb& limb : kLimbsOfCoco) {
        if (shown[limb.from] && shown[limb.to])
            draw_limb(maps, limb, joint_of(neck, limb.from), joint_of(neck, limb.to));
    }
}

void erase_limb(OpenPoseMaps& maps, int from, int to) {
    for (const Limb& limb : kLimbsOfCoco) {
        if (limb.from != from || limb.to != to) continue;
        std::fill(maps.paf.plane(limb.channel), maps.paf.plane(limb.channel) + 2 * kRows * kColumns, 0.0f);
    }
}

void expect_joint(const Person& person, int joint, Point neck) {
    const Point at = joint_of(neck, joint);
    const JointObservation& found = person.joints[joint];
    EXPECT_GT(found.p, 0.5f) << joint;
    EXPECT_NEAR(found.u, (at.x + 0.5f) * 8 - 0.5f, 1.5f) << joint;
    EXPECT_NEAR(found.v, (at.y + 0.5f) * 8 - 0.5f, 1.5f) << joint;
}

People decode(const OpenPoseMaps& maps) { return decode_openpose(maps, kWidth, kHeight, {}); }

TEST(OpenPose, NobodyInEmptyMaps) { EXPECT_TRUE(decode(empty_maps()).empty()); }

TEST(OpenPose, FindsEveryJointOfSeveralPeople) {
    OpenPoseMaps maps = empty_maps();
    const std::array<Point, 3> necks{{{12.3f, 10}, {40, 15.4f}, {65, 12}}};
    for (const Point neck : necks) draw_person(maps, neck);
    People people = decode(maps);
    ASSERT_EQ(people.size(), necks.size());
    std::sort(people.begin(), people.end(),
              [](const Person& a, const Person& b) { return a.joints[Neck].u < b.joints[Neck].u; });
    for (std::size_t i = 0; i < people.size(); ++i) {
        for (int j = 0; j < kJointCount; ++j) expect_joint(people[i], j, necks[i]);
        EXPECT_GT(people[i].score, 0.8f);
        EXPECT_FALSE(people[i].box.empty());
    }
}

TEST(OpenPose, KeepsPeopleApartWhoseArmsCross) {
    OpenPoseMaps maps = empty_maps();
    const std::array<Point, 2> necks{{{30, 12}, {38, 13}}};
    for (const Point neck : necks) draw_person(maps, neck);
    People people = decode(maps);
    ASSERT_EQ(people.size(), 2u);
    std::sort(people.begin(), people.end(),
              [](const Person& a, const Person& b) { return a.joints[Neck].u < b.joints[Neck].u; });
    for (std::size_t i = 0; i < people.size(); ++i) {
        for (const int j : {Nose, Neck, RightHip, RightKnee, LeftAnkle}) expect_joint(people[i], j, necks[i]);
    }
}

TEST(OpenPose, AMissingLinkDoesNotTearThePersonApart) {
    // The right arm loses its link to the neck, but the shoulder still holds on to the ear.
    OpenPoseMaps maps = empty_maps();
    draw_person(maps, {40, 15});
    erase_limb(maps, Neck, RightShoulder);
    const People people = decode(maps);
    ASSERT_EQ(people.size(), 1u);
    for (int j = 0; j < kJointCount; ++j) expect_joint(people[0], j, {40, 15});
}

TEST(OpenPose, WithoutANeckTheRestIsStillFound) {
    JointSet shown = everything();
    shown[Neck] = false;
    OpenPoseMaps maps = empty_maps();
    draw_person(maps, {40, 15}, shown);
    const People people = decode(maps);
    ASSERT_GE(people.size(), 1u);
    for (const int j : {Nose, RightShoulder, LeftShoulder, RightWrist, LeftWrist}) expect_joint(people[0], j, {40, 15});
    EXPECT_EQ(people[0].joints[Neck].p, 0);
}

TEST(OpenPose, APersonCutOffByTheBorderIsFound) {
    OpenPoseMaps maps = empty_maps();
    draw_person(maps, {2, 45});  // the legs and the right arm are outside
    const People people = decode(maps);
    ASSERT_EQ(people.size(), 1u);
    for (const int j : {Nose, Neck, LeftShoulder, LeftElbow, LeftWrist}) expect_joint(people[0], j, {2, 45});
    EXPECT_EQ(people[0].joints[LeftAnkle].p, 0);
    EXPECT_EQ(people[0].joints[RightWrist].p, 0);
}

TEST(OpenPose, HeatWithoutLinksIsNobody) {
    OpenPoseMaps maps = empty_maps();
    for (int j = 0; j < kJointCount; ++j) draw_joint(maps, j, joint_of({40, 15}, j));
    EXPECT_TRUE(decode(maps).empty());
}

TEST(OpenPose, AFieldAgainstTheLimbIsNoLink) {
    OpenPoseMaps maps = empty_maps();
    draw_person(maps, {40, 15});
    for (float& value : maps.paf.values) value = -value;
    EXPECT_TRUE(decode(maps).empty());
}

Tensor concatenated(const Tensor& first, const Tensor& second) {
    Tensor both(first.channels() + second.channels(), first.height(), first.width());
    std::copy(first.values.begin(), first.values.end(), both.values.begin());
    std::copy(second.values.begin(), second.values.end(), both.plane(first.channels()));
    return both;
}

TEST(OpenPose, UnderstandsEveryOrderOfMaps) {
    OpenPoseMaps drawn = empty_maps();
    draw_person(drawn, {40, 15});
    const std::vector<std::vector<Tensor>> layouts{
        {drawn.heat, drawn.paf},
        {drawn.paf, drawn.heat},
        {concatenated(drawn.heat, drawn.paf)},
        {concatenated(drawn.paf, drawn.heat)},
        {Tensor(38, kRows, kColumns), Tensor(19, kRows, kColumns), drawn.paf, drawn.heat},  // two stages
    };
    for (std::size_t i = 0; i < layouts.size(); ++i) {
        const OpenPoseMaps maps = openpose_maps(layouts[i]);
        EXPECT_EQ(maps.heat.values, drawn.heat.values) << i;
        EXPECT_EQ(maps.paf.values, drawn.paf.values) << i;
    }
}

TEST(OpenPose, RefusesOtherOutputs) {
    EXPECT_THROW((void)openpose_maps({}), Error);
    EXPECT_THROW((void)openpose_maps({Tensor(78, 8, 8)}), Error) << "BODY_25";
    EXPECT_THROW((void)openpose_maps({Tensor(57, 8, 8)}), Error) << "57 maps without a background";
    EXPECT_THROW((void)openpose_maps({Tensor(19, 8, 8), Tensor(38, 16, 16)}), Error);
}

}  // namespace
}  // namespace posefusion
