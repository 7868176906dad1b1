#include "pose/movenet.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr int kRows = 48, kColumns = 64;    // of the maps
constexpr int kWidth = 640, kHeight = 480;  // of the image: one cell is 10 x 10 pixels
constexpr float kSure = 4, kNo = -8;        // logits
constexpr std::array<int, 17> kJointOfCoco{Nose,          LeftEye,   RightEye,   LeftEar,   RightEar,   LeftShoulder,
                                           RightShoulder, LeftElbow, RightElbow, LeftWrist, RightWrist, LeftHip,
                                           RightHip,      LeftKnee,  RightKnee,  LeftAnkle, RightAnkle};

MoveNetMaps empty_maps() {
    const auto map = [](int channels, float fill) {
        Tensor tensor(channels, kRows, kColumns);
        std::fill(tensor.values.begin(), tensor.values.end(), fill);
        return tensor;
    };
    return {map(1, kNo), map(2, 0), map(2, 0), map(17, kNo), map(34, 0), map(34, 0)};
}

struct Cell {
    int x, y;
};

/// Where the 17 COCO joints of a person stand whose centre is in `center`: two columns, 1 cell left and right of it.
Cell joint_cell(Cell center, int coco) { return {center.x + (coco % 2 ? 1 : -1), center.y - 8 + coco}; }

/// Draws a person of 6 x 20 cells whose joints lie in the middle of their cells.
void draw_person(MoveNetMaps& maps, Cell center, float certainty = kSure, float joints = kSure) {
    maps.center.at(0, center.y, center.x) = certainty;
    maps.box_scale.at(0, center.y, center.x) = 20;
    maps.box_scale.at(1, center.y, center.x) = 6;
    for (int j = 0; j < 17; ++j) {
        const Cell cell = joint_cell(center, j);
        maps.kpt_regress.at(2 * j, center.y, center.x) = static_cast<float>(cell.y - center.y);
        maps.kpt_regress.at(2 * j + 1, center.y, center.x) = static_cast<float>(cell.x - center.x);
        if (cell.x < 0 || cell.y < 0 || cell.x >= kColumns || cell.y >= kRows) continue;
        maps.kpt_heatmap.at(j, cell.y, cell.x) = joints;
        maps.kpt_offset.at(2 * j, cell.y, cell.x) = 0.5f;
        maps.kpt_offset.at(2 * j + 1, cell.y, cell.x) = 0.5f;
    }
}

void expect_joint(const Person& person, int coco, Cell center) {
    const JointObservation& joint = person.joints[kJointOfCoco[coco]];
    const Cell cell = joint_cell(center, coco);
    EXPECT_GT(joint.p, 0.9f) << coco;
    // The middle of a cell of 10 pixels; the centre of the first pixel is 0.
    EXPECT_FLOAT_EQ(joint.u, 10 * static_cast<float>(cell.x) + 4.5f) << coco;
    EXPECT_FLOAT_EQ(joint.v, 10 * static_cast<float>(cell.y) + 4.5f) << coco;
}

TEST(MoveNet, NobodyInEmptyMaps) { EXPECT_TRUE(decode_movenet(empty_maps(), kWidth, kHeight, {}).empty()); }

TEST(MoveNet, FindsEveryJointOfSeveralPeople) {
    MoveNetMaps maps = empty_maps();
    const std::array<Cell, 3> centers{{{10, 12}, {30, 24}, {36, 30}}};
    for (std::size_t i = 0; i < centers.size(); ++i)
        draw_person(maps, centers[i], kSure - 0.5f * static_cast<float>(i));
    const People people = decode_movenet(maps, kWidth, kHeight, {});
    ASSERT_EQ(people.size(), centers.size());
    for (std::size_t i = 0; i < people.size(); ++i) {
        for (int j = 0; j < 17; ++j) expect_joint(people[i], j, centers[i]);
    }
}

TEST(MoveNet, NeckIsBetweenTheShoulders) {
    MoveNetMaps maps = empty_maps();
    draw_person(maps, {20, 20});
    const People people = decode_movenet(maps, kWidth, kHeight, {});
    ASSERT_EQ(people.size(), 1u);
    const auto& joints = people[0].joints;
    EXPECT_FLOAT_EQ(joints[Neck].u, (joints[LeftShoulder].u + joints[RightShoulder].u) / 2);
    EXPECT_FLOAT_EQ(joints[Neck].v, (joints[LeftShoulder].v + joints[RightShoulder].v) / 2);
    EXPECT_FLOAT_EQ(joints[Neck].p, std::min(joints[LeftShoulder].p, joints[RightShoulder].p));
}

TEST(MoveNet, ReportsTheBoxOfTheBody) {
    MoveNetMaps maps = empty_maps();
    draw_person(maps, {20, 20});
    const People people = decode_movenet(maps, kWidth, kHeight, {});
    ASSERT_EQ(people.size(), 1u);
    EXPECT_FLOAT_EQ(people[0].box.u_min, 169.5f);
    EXPECT_FLOAT_EQ(people[0].box.u_max, 229.5f);
    EXPECT_FLOAT_EQ(people[0].box.v_min, 99.5f);
    EXPECT_FLOAT_EQ(people[0].box.v_max, 299.5f);
}

TEST(MoveNet, APersonCutOffByTheBorderKeepsTheJointsInside) {
    MoveNetMaps maps = empty_maps();
    const Cell center{20, 3};
    draw_person(maps, center);
    const People people = decode_movenet(maps, kWidth, kHeight, {});
    ASSERT_EQ(people.size(), 1u);
    EXPECT_FLOAT_EQ(people[0].box.v_min, -0.5f);
    EXPECT_EQ(people[0].joints[Nose].p, 0) << "above the image";
    for (int j = 5; j < 17; ++j) expect_joint(people[0], j, center);
}

TEST(MoveNet, ACentreWithoutJointsIsFurniture) {
    MoveNetMaps maps = empty_maps();
    draw_person(maps, {20, 20}, kSure, -3);
    EXPECT_TRUE(decode_movenet(maps, kWidth, kHeight, {}).empty());
}

TEST(MoveNet, SureJointsCarryADoubtfulCentre) {
    MoveNetMaps maps = empty_maps();
    draw_person(maps, {20, 20}, -1.5f);  // 0.18
    EXPECT_EQ(decode_movenet(maps, kWidth, kHeight, {}).size(), 1u);
}

TEST(MoveNet, JointsOfANeighbourAreNotTaken) {
    MoveNetMaps maps = empty_maps();
    draw_person(maps, {10, 20});
    draw_person(maps, {22, 20});
    const int wrist = 9;
    const Cell own = joint_cell({10, 20}, wrist);
    maps.kpt_heatmap.at(wrist, own.y, own.x) = kNo;
    const People people = decode_movenet(maps, kWidth, kHeight, {});
    ASSERT_EQ(people.size(), 2u);
    EXPECT_EQ(people[0].joints[kJointOfCoco[wrist]].p, 0);
    EXPECT_GT(people[1].joints[kJointOfCoco[wrist]].p, 0.9f);
}

TEST(MoveNet, TwoCentresOfOneBodyAreOnePerson) {
    MoveNetMaps maps = empty_maps();
    draw_person(maps, {20, 20});
    // A second, weaker centre six cells below points at the same joints.
    const Cell second{20, 26};
    maps.center.at(0, second.y, second.x) = 2;
    maps.box_scale.at(0, second.y, second.x) = 30;
    maps.box_scale.at(1, second.y, second.x) = 8;
    for (int j = 0; j < 17; ++j) {
        const Cell cell = joint_cell({20, 20}, j);
        maps.kpt_regress.at(2 * j, second.y, second.x) = static_cast<float>(cell.y - second.y);
        maps.kpt_regress.at(2 * j + 1, second.y, second.x) = static_cast<float>(cell.x - second.x);
    }
    EXPECT_EQ(decode_movenet(maps, kWidth, kHeight, {}).size(), 1u);
}

TEST(MoveNet, APlateauIsOnePeak) {
    MoveNetMaps maps = empty_maps();
    draw_person(maps, {20, 20});
    for (int y = 19; y < 22; ++y) {
        for (int x = 19; x < 22; ++x) maps.center.at(0, y, x) = kSure;
    }
    for (const int pair : {0, 1}) {
        for (int x = 19; x < 22; ++x) maps.box_scale.at(pair, 19, x) = maps.box_scale.at(pair, 20, 20);
    }
    EXPECT_LE(decode_movenet(maps, kWidth, kHeight, {}).size(), 1u);
}

TEST(MoveNet, RefusesOutputsOfAnotherNetwork) {
    EXPECT_THROW((void)movenet_maps({}), Error);
    std::vector<Tensor> outputs(6, Tensor(1, 4, 4));
    EXPECT_THROW((void)movenet_maps(outputs), Error);
}

}  // namespace
}  // namespace posefusion
