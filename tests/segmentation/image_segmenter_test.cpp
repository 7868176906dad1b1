#include <gtest/gtest.h>

#include <cmath>

#include "segmentation/segmenter.hpp"
#include "tests/segmentation/scene.hpp"

namespace posefusion {
namespace {

using test::Frame;
using test::Scene;

class ImageMode : public testing::Test {
protected:
    const Intrinsics camera = test::camera_of(320, 240);

    Segmentation segment(const Frame& frame) const {
        return make_segmenter({}, camera, {})
            ->segment(frame.color, frame.depth, frame.people, Eigen::Isometry3f::Identity());
    }
};

TEST_F(ImageMode, TakesAWholePersonAndLeavesWallAndFloor) {
    const Frame frame = test::render({.people = {{0.2f, 3.2f}}}, camera);
    const Segmentation result = segment(frame);
    const test::Score score = test::score(result.labels, frame.truth);
    EXPECT_EQ(result.people, 1);
    EXPECT_EQ(result.carried, 0);
    EXPECT_GT(score.recall, 0.97);
    EXPECT_LT(score.static_lost, 0.005);
}

TEST_F(ImageMode, StaticDepthIsTheDepthOutsideTheMask) {
    const Frame frame = test::render({.people = {{0.2f, 3.2f}}}, camera);
    const Segmentation result = segment(frame);
    const DepthImage rest = remove_people(frame.depth, result.labels);
    for (std::size_t i = 0; i < frame.depth.size(); ++i) ASSERT_EQ(rest[i], result.labels[i] ? 0.0f : frame.depth[i]);
}

TEST_F(ImageMode, FloorUnderTheFeetStays) {
    const Frame frame = test::render({.people = {{0.0f, 3.4f}}}, camera);
    const Segmentation result = segment(frame);
    EXPECT_LT(test::labelled_share(result.labels, frame.parts, test::kFloorPart), 0.01);
}

TEST_F(ImageMode, LeavesABoxBesideThePerson) {
    const Frame frame =
        test::render({.people = {{0.0f, 3.2f}}, .boxes = {{{0.45f, 0.2f, 3.0f}, {0.95f, test::kFloor, 3.4f}}}}, camera);
    const Segmentation result = segment(frame);
    EXPECT_LT(test::labelled_share(result.labels, frame.parts, test::kBoxPart), 0.05);
    EXPECT_GT(test::score(result.labels, frame.truth).recall, 0.95);
}

TEST_F(ImageMode, FurnitureInFrontOfTheLegsStaysThoughJointsLieOnIt) {
    const Frame frame =
        test::render({.people = {{0.0f, 3.0f}}, .boxes = {{{-0.8f, 0.55f, 2.2f}, {0.8f, test::kFloor, 2.6f}}}}, camera);
    ASSERT_GT(frame.people[0].joints[RightKnee].p, 0);
    const Segmentation result = segment(frame);
    EXPECT_LT(test::labelled_share(result.labels, frame.parts, test::kBoxPart), 0.02);
    EXPECT_GT(test::score(result.labels, frame.truth).recall, 0.95);
}

TEST_F(ImageMode, TakesAPersonCutByTheBorder) {
    const Frame frame = test::render({.people = {{1.45f, 2.6f}}}, camera);
    const Segmentation result = segment(frame);
    const test::Score score = test::score(result.labels, frame.truth);
    EXPECT_GT(score.recall, 0.93);
    EXPECT_LT(score.static_lost, 0.005);
}

TEST_F(ImageMode, FillsHolesInThePersonButNotShadowsBesideIt) {
    Frame frame = test::render({.people = {{0.0f, 3.2f}}}, camera);
    LabelImage holes(camera.width, camera.height), shadow(camera.width, camera.height);
    constexpr int kShadow = 8;
    for (int v = 0; v < camera.height; ++v)
        for (int u = 0; u < camera.width; ++u) {
            if (frame.truth(u, v) && (u / 9 + v / 9) % 3 == 0) holes(u, v) = 1;
            for (int du = 1; du <= kShadow && u + du < camera.width; ++du)
                if (!frame.truth(u, v) && frame.truth(u + du, v)) shadow(u, v) = 1;
        }
    double filled = 0, of_holes = 0, taken = 0, of_shadow = 0;
    for (std::size_t i = 0; i < holes.size(); ++i)
        if (holes[i] || shadow[i]) frame.depth[i] = 0;
    const Segmentation result = segment(frame);
    for (std::size_t i = 0; i < holes.size(); ++i) {
        of_holes += holes[i];
        of_shadow += shadow[i];
        filled += holes[i] && result.labels[i];
        taken += shadow[i] && result.labels[i];
    }
    EXPECT_GT(filled / of_holes, 0.9);
    EXPECT_LT(taken / of_shadow, 0.1);
}

TEST_F(ImageMode, AJointOffTheLimbDoesNotPullInTheWall) {
    Frame frame = test::render({.people = {{0.0f, 3.2f}}}, camera);
    frame.people[0].joints[RightWrist].u -= 15;
    frame.people[0].joints[LeftElbow].u += 12;
    const Segmentation result = segment(frame);
    EXPECT_LT(test::labelled_share(result.labels, frame.parts, test::kWallPart), 0.005);
    EXPECT_GT(test::score(result.labels, frame.truth).recall, 0.93);
}

TEST_F(ImageMode, LimbsWithoutJointsFollowTheBody) {
    Frame frame = test::render({.people = {{0.0f, 3.2f}}}, camera);
    for (const int j : {RightElbow, RightWrist, LeftKnee, LeftAnkle, Nose, LeftEye}) frame.people[0].joints[j].p = 0;
    const Segmentation result = segment(frame);
    const test::Score score = test::score(result.labels, frame.truth);
    EXPECT_GT(score.recall, 0.9);
    EXPECT_LT(score.static_lost, 0.01);
}

TEST_F(ImageMode, TellsTwoPeopleApart) {
    const Frame frame = test::render({.people = {{-0.5f, 3.0f}, {0.4f, 3.3f}}}, camera);
    const Segmentation result = segment(frame);
    EXPECT_EQ(result.people, 2);
    double same = 0, all = 0;
    for (std::size_t i = 0; i < frame.truth.size(); ++i)
        if (frame.truth[i] && result.labels[i]) ++all, same += frame.truth[i] == result.labels[i];
    EXPECT_GT(same / all, 0.98);
}

TEST_F(ImageMode, FlatJointsOnAPosterOfADollAreNoPerson) {
    Frame frame = test::render({}, camera);
    Person doll;
    for (int j = 0; j < kJointCount; ++j)
        doll.joints[j] = {150.0f + static_cast<float>(j % 4), 100.0f + static_cast<float>(j / 4), 1};
    frame.people = {doll};
    const Segmentation result = segment(frame);
    EXPECT_EQ(result.people, 0);
    EXPECT_EQ(test::labelled_share(result.labels, frame.parts, test::kWallPart), 0);
}

TEST_F(ImageMode, StepsInDepthCountBeyondTheConfiguredNoise) {
    const Frame frame =
        test::render({.people = {{0.0f, 3.2f}}, .boxes = {{{-0.8f, 0.55f, 2.2f}, {0.8f, test::kFloor, 2.6f}}}}, camera);
    const auto recall = [&](const DepthNoise& noise) {
        const Segmentation result =
            make_segmenter({}, camera, noise)
                ->segment(frame.color, frame.depth, frame.people, Eigen::Isometry3f::Identity());
        return test::score(result.labels, frame.truth).recall;
    };
    EXPECT_GT(recall({}), 0.97);
    EXPECT_LT(recall({.a = 0.3f}), 0.93) << "the person behind the box is no step behind it";
}

// A board close behind the person: what has no step in depth to the body is shared out by eq. (2).
TEST_F(ImageMode, SigmaIsTheLengthOverWhichNeighboursAreHeldTogether) {
    const Frame frame =
        test::render({.people = {{0.0f, 3.2f}}, .boxes = {{{-1.2f, -0.6f, 3.3f}, {1.2f, test::kFloor, 3.5f}}}}, camera);
    const auto board_cut = [&](float sigma) {
        const Segmentation result =
            make_segmenter({.sigma = sigma}, camera, {})
                ->segment(frame.color, frame.depth, frame.people, Eigen::Isometry3f::Identity());
        EXPECT_GT(test::score(result.labels, frame.truth).recall, 0.97) << sigma;
        return test::labelled_share(result.labels, frame.parts, test::kBoxPart);
    };
    const double with_default = board_cut(SegmentationConfig{}.sigma);
    EXPECT_LT(board_cut(0.05f), 0.6 * with_default);
    EXPECT_GT(board_cut(0.5f), with_default);
}

TEST_F(ImageMode, AThingCarriedIsCutWithThePersonUpToTheReach) {
    const Frame alone = test::render({.people = {{0.0f, 3.2f}}}, camera);
    const Frame with_box =
        test::render({.people = {{0.0f, 3.2f}}, .boxes = {{{0.3f, -0.2f, 3.0f}, {0.7f, 0.2f, 3.3f}}}}, camera);
    const auto share_of_box = [&](float reach) {
        const auto segmenter = make_segmenter({.reach = reach}, camera, {});
        const auto segment = [&](const Frame& frame) {
            return segmenter->segment(frame.color, frame.depth, frame.people, Eigen::Isometry3f::Identity());
        };
        for (int i = 0; i < 3; ++i) (void)segment(alone);
        return test::labelled_share(segment(with_box).labels, with_box.parts, test::kBoxPart);
    };
    EXPECT_GT(share_of_box(1), 0.8);
    EXPECT_LT(share_of_box(0), 0.1);
}

TEST_F(ImageMode, SameInputGivesSameBytes) {
    const Frame frame = test::render({.people = {{-0.5f, 3.0f}, {0.4f, 3.3f}}}, camera);
    const auto first = make_segmenter({}, camera, {}), second = make_segmenter({}, camera, {});
    for (int i = 0; i < 3; ++i) {
        const auto people = i == 1 ? std::nullopt : std::optional(frame.people);
        const Segmentation a = first->segment(frame.color, frame.depth, people, Eigen::Isometry3f::Identity());
        const Segmentation b = second->segment(frame.color, frame.depth, people, Eigen::Isometry3f::Identity());
        ASSERT_TRUE(std::equal(a.labels.begin(), a.labels.end(), b.labels.begin()));
    }
}

}  // namespace
}  // namespace posefusion
