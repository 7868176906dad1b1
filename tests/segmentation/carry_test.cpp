#include <gtest/gtest.h>

#include <algorithm>
#include <span>

#include "engine/core/error.hpp"
#include "segmentation/segmenter.hpp"
#include "tests/segmentation/scene.hpp"

namespace posefusion {
namespace {

using test::Frame;
using test::Scene;

/// A person walks in front of a camera that may move too.
class Carry : public testing::Test {
protected:
    const Intrinsics camera = test::camera_of(160, 120);
    const People nobody;
    float step = 0;                                    ///< metres per frame
    Eigen::Vector3f motion = Eigen::Vector3f::Zero();  ///< of the camera per frame
    int time = 0;
    Frame frame;
    std::unique_ptr<Segmenter> segmenter = make_segmenter({}, camera, {});

    Scene scene() const {
        const auto t = static_cast<float>(time);
        return {.people = {{-0.5f + t * step, 3.2f}}, .camera = t * motion};
    }
    /// Renders the next frame and segments it with the joints that `detect` lets through.
    template <class Detect>
    Segmentation next(Detect detect) {
        frame = test::render(scene(), camera);
        ++time;
        Eigen::Isometry3f T_previous_current = Eigen::Isometry3f::Identity();
        T_previous_current.translation() = motion;
        return segmenter->segment(frame.color, frame.depth, detect(frame.people), T_previous_current);
    }
    Segmentation found() {
        return next([](const People& p) { return std::optional(p); });
    }
    Segmentation missed() {
        return next([](const People&) { return std::optional(People{}); });
    }
    Segmentation not_asked() {
        return next([](const People&) { return std::optional<People>(); });
    }
    test::Score score(const Segmentation& result) const { return test::score(result.labels, frame.truth); }
};

TEST_F(Carry, MaskFollowsAWalkingPersonWhomTheNetworkMisses) {
    step = 0.03f;
    for (int i = 0; i < 6; ++i) (void)found();
    for (int i = 0; i < 5; ++i) {
        const Segmentation result = missed();
        EXPECT_EQ(result.people, 1);
        EXPECT_EQ(result.carried, 1);
        EXPECT_GT(score(result).recall, 0.9) << "miss " << i;
        EXPECT_LT(score(result).static_lost, 0.01) << "miss " << i;
    }
    EXPECT_EQ(found().carried, 0);
}

TEST_F(Carry, MaskFollowsWhenTheCameraMoves) {
    motion = {0.03f, 0.01f, 0.02f};
    for (int i = 0; i < 6; ++i) (void)found();
    for (int i = 0; i < 5; ++i) {
        const Segmentation result = missed();
        EXPECT_GT(score(result).recall, 0.9) << "miss " << i;
        EXPECT_LT(score(result).static_lost, 0.01) << "miss " << i;
    }
}

TEST_F(Carry, MaskVanishesAtOnceWhenThePersonIsGone) {
    for (int i = 0; i < 6; ++i) (void)found();
    const Frame empty = test::render({}, camera);
    const Segmentation result = segmenter->segment(empty.color, empty.depth, nobody, Eigen::Isometry3f::Identity());
    EXPECT_EQ(result.people, 0);
    EXPECT_LT(test::score(result.labels, empty.truth).static_lost, 0.001);
}

TEST_F(Carry, EndsAfterCarryFrames) {
    segmenter = make_segmenter({.carry_frames = 3}, camera, {});
    for (int i = 0; i < 6; ++i) (void)found();
    for (int i = 0; i < 3; ++i) EXPECT_EQ(missed().people, 1);
    const Segmentation result = missed();
    EXPECT_EQ(result.people, 0);
    EXPECT_EQ(score(result).recall, 0);
}

TEST_F(Carry, FramesWithoutTheNetworkDoNotCountAsMisses) {
    step = 0.025f;
    segmenter = make_segmenter({.carry_frames = 1}, camera, {});
    for (int i = 0; i < 3; ++i) (void)found();
    for (int i = 0; i < 12; ++i) {
        const Segmentation result = i % 4 == 3 ? found() : not_asked();
        EXPECT_EQ(result.people, 1);
        EXPECT_EQ(result.carried, i % 4 == 3 ? 0 : 1);
        EXPECT_GT(score(result).recall, 0.9) << "frame " << i;
    }
}

TEST_F(Carry, JointsMissedForAWhileAreRemembered) {
    step = 0.02f;
    for (int i = 0; i < 6; ++i) (void)found();
    for (int i = 0; i < 5; ++i) {
        const Segmentation result = next([](People people) {
            for (const int j :
                 {LeftShoulder, LeftElbow, LeftWrist, LeftHip, LeftKnee, LeftAnkle, RightKnee, RightAnkle})
                people[0].joints[j].p = 0;
            return std::optional(people);
        });
        EXPECT_EQ(result.carried, 0);
        EXPECT_GT(score(result).recall, 0.95) << "frame " << i;
    }
}

TEST_F(Carry, NobodyIsCarriedLongerThanSeen) {
    (void)found();
    EXPECT_EQ(missed().people, 1);
    EXPECT_EQ(missed().people, 0);
}

TEST_F(Carry, GoesOnFromItsStateWithTheSameMasks) {
    step = 0.03f;
    motion = {0.01f, 0, 0};
    for (int i = 0; i < 4; ++i) (void)found();
    (void)missed();
    const ByteArray state = segmenter->state();
    const int then = time;
    std::vector<Segmentation> expected;
    const auto rest = [&](auto&& take) {
        for (int i = 0; i < 3; ++i) take(missed());
        take(not_asked());
        take(found());
    };
    rest([&](Segmentation result) { expected.push_back(std::move(result)); });
    ASSERT_EQ(expected[0].carried, 1) << "the test needs something carried on";

    time = then;
    segmenter = make_segmenter({}, camera, {});
    segmenter->restore(state);
    std::size_t k = 0;
    rest([&](const Segmentation& result) {
        EXPECT_EQ(result.people, expected[k].people) << k;
        EXPECT_TRUE(std::equal(result.labels.begin(), result.labels.end(), expected[k].labels.begin())) << k;
        ++k;
    });

    time = then;
    segmenter = make_segmenter({}, camera, {});
    EXPECT_EQ(missed().people, 0) << "without the state there is nobody to carry";
    for (const std::size_t length : {std::size_t{0}, std::size_t{3}, state.size() / 2, state.size() - 1}) {
        EXPECT_THROW(segmenter->restore(std::span(state).first(length)), Error) << length;
    }
}

}  // namespace
}  // namespace posefusion
