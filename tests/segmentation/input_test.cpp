#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/error.hpp"
#include "segmentation/segmenter.hpp"
#include "tests/segmentation/scene.hpp"

namespace posefusion {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

class AnyMode : public testing::TestWithParam<SegmentationMode> {
protected:
    SegmentationConfig config{.mode = GetParam(), .paper_step = 1};
    const Intrinsics camera = test::camera_of(160, 120);
    test::Frame frame = test::render({.people = {{0.0f, 3.2f}}}, camera);

    Segmentation segment(const std::optional<People>& people) const {
        return make_segmenter(config, camera, {})
            ->segment(frame.color, frame.depth, people, Eigen::Isometry3f::Identity());
    }
    static bool blank(const LabelImage& labels) {
        return std::all_of(labels.begin(), labels.end(), [](std::uint8_t l) { return l == 0; });
    }
};

TEST_P(AnyMode, NoPeopleGiveAnEmptyMaskAndTheDepthAsItIs) {
    for (const auto& people : {std::optional<People>(), std::optional<People>(People{})}) {
        const Segmentation result = segment(people);
        EXPECT_EQ(result.people, 0);
        EXPECT_TRUE(blank(result.labels));
    }
}

// Eq. (3): the legs stand in a low box without a step in depth, so that the distance from them decides how much goes.
TEST_P(AnyMode, ASmallerRadiusCutsLess) {
    frame = test::render({.people = {{0.0f, 3.2f}}, .boxes = {{{-0.8f, 0.55f, 2.9f}, {0.8f, test::kFloor, 3.05f}}}},
                         camera);
    std::size_t less = 0;
    for (const float radius : {0.1f, 0.2f, 0.4f, 0.8f}) {
        config.radius = radius;
        const Segmentation result = segment(frame.people);
        const std::size_t cut =
            result.labels.size() - static_cast<std::size_t>(std::count(result.labels.begin(), result.labels.end(), 0));
        EXPECT_GT(cut, less) << radius;
        less = cut;
    }
}

TEST_P(AnyMode, NoDepthAtAllGivesAnEmptyMask) {
    std::fill(frame.depth.begin(), frame.depth.end(), 0.0f);
    EXPECT_TRUE(blank(segment(frame.people).labels));
}

TEST_P(AnyMode, BadDepthValuesCountAsNone) {
    for (std::size_t i = 0; i < frame.depth.size(); i += 7)
        frame.depth[i] = i % 3 == 0 ? kNaN : i % 3 == 1 ? -1.0f : std::numeric_limits<float>::infinity();
    const Segmentation result = segment(frame.people);
    EXPECT_GT(test::score(result.labels, frame.truth).recall, GetParam() == SegmentationMode::Image ? 0.9 : 0.5);
}

TEST_P(AnyMode, JointsOutsideTheImageOrNotFiniteAreIgnored) {
    Person ghost;
    for (int j = 0; j < kJointCount; ++j)
        ghost.joints[j] = {j % 2 ? kNaN : -1e9f, j % 3 ? 1e9f : std::numeric_limits<float>::infinity(), 1};
    EXPECT_TRUE(blank(segment(People{ghost}).labels));
    People with_ghost = frame.people;
    with_ghost.push_back(ghost);
    EXPECT_GT(test::score(segment(with_ghost).labels, frame.truth).recall, 0.6);
}

TEST_P(AnyMode, FifteenPeopleAreTaken) {
    People crowd(kMaxPeople, frame.people[0]);
    for (int p = 0; p < kMaxPeople; ++p)
        for (JointObservation& joint : crowd[static_cast<std::size_t>(p)].joints) joint.u += static_cast<float>(p % 3);
    const Segmentation result = segment(crowd);
    EXPECT_LE(result.people, kMaxPeople);
    EXPECT_GT(test::score(result.labels, frame.truth).recall, 0.6);
}

TEST_P(AnyMode, AnyImageSizeWorks) {
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {4, 4}, {17, 13}, {100, 76}, {322, 181}}) {
        const Intrinsics small = test::camera_of(width, height);
        const test::Frame room = test::render({.people = {{0.0f, 2.5f}}}, small);
        const auto segmenter = make_segmenter(config, small, {});
        for (int i = 0; i < 2; ++i) {
            const Segmentation result =
                segmenter->segment(room.color, room.depth, room.people, Eigen::Isometry3f::Identity());
            EXPECT_EQ(result.labels.width(), width);
            EXPECT_EQ(result.labels.height(), height);
            if (width < 100) continue;
            EXPECT_GT(test::score(result.labels, room.truth).recall, 0.6) << width;
        }
    }
}

TEST_P(AnyMode, ImagesOfAnotherSizeThanTheCameraAreRefused) {
    const auto segmenter = make_segmenter(config, camera, {});
    EXPECT_THROW(
        (void)segmenter->segment(ColorImage(160, 119), frame.depth, frame.people, Eigen::Isometry3f::Identity()),
        Error);
    EXPECT_THROW((void)segmenter->segment(frame.color, DepthImage(), frame.people, Eigen::Isometry3f::Identity()),
                 Error);
}

TEST_P(AnyMode, SenselessNumbersAreRefused) {
    EXPECT_THROW((void)make_segmenter(config, Intrinsics{}, {}), Error);
    for (float SegmentationConfig::*number :
         {&SegmentationConfig::sigma, &SegmentationConfig::radius, &SegmentationConfig::reach}) {
        for (const float bad : {-0.1f, kNaN}) {
            SegmentationConfig senseless = config;
            senseless.*number = bad;
            EXPECT_THROW((void)make_segmenter(senseless, camera, {}), Error);
        }
    }
    config.carry_frames = -1;
    EXPECT_THROW((void)make_segmenter(config, camera, {}), Error);
}

TEST_P(AnyMode, AnUnusableMotionDoesNotCrash) {
    const auto segmenter = make_segmenter(config, camera, {});
    Eigen::Isometry3f wild = Eigen::Isometry3f::Identity();
    wild.translation() = Eigen::Vector3f::Constant(kNaN);
    for (int i = 0; i < 3; ++i) (void)segmenter->segment(frame.color, frame.depth, frame.people, wild);
    SUCCEED();
}

INSTANTIATE_TEST_SUITE_P(Modes, AnyMode, testing::Values(SegmentationMode::Image, SegmentationMode::Paper),
                         [](const testing::TestParamInfo<SegmentationMode>& mode) {
                             return mode.param == SegmentationMode::Image ? std::string("Image") : std::string("Paper");
                         });

}  // namespace
}  // namespace posefusion
