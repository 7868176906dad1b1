#include <memory>
#include <set>

#include "engine/objects/object_tracker.hpp"
#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/synthetic_room.hpp"

// What moves as a rigid body becomes an object with a pose and a model; what does not, does not.
namespace posefusion::test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Says what the test has told it to move.
class ToldMovers final : public MotionJudge {
public:
    LabelImage movers;
    LabelImage begin(const ColorImage&, const DepthImage&, const LabelImage&) override { return {}; }
    LabelImage find(const Eigen::Isometry3f&) override { return movers; }
    void end(const Eigen::Isometry3f&) override {}
    void restart() override {}
    [[nodiscard]] ByteArray state() const override { return {}; }
    void restore(std::span<const std::byte>) override {}
};

class Objects : public SlamTest {
protected:
    static constexpr Intrinsics kCamera{262.5f, 262.5f, 159.5f, 119.5f, 320, 240};

    const std::shared_ptr<ToldMovers> judge = std::make_shared<ToldMovers>();
    const std::shared_ptr<vulkan::Context> context =
        std::make_shared<vulkan::Context>(vulkan::ContextOptions{test_device(), true, true, {}});
    ObjectTracker objects{judge, context, kCamera, test_config()};

    /// A ball in front of a camera that stands. @param said  whether the judge says that it moves
    void process(const Ball& ball, bool said = true) { process(objects, ball, said); }
    void process(ObjectTracker& tracker, const Ball& ball, bool said = true) {
        const Frame frame = render_room(kCamera, Isometry3d::Identity(), ball);
        judge->movers = said ? frame.labels : LabelImage();
        for (auto& label : judge->movers) label = label != 0 ? kFirstMoverLabel : std::uint8_t{0};
        const LabelImage nobody;
        tracker.begin(frame.color, frame.depth, nobody);
        tracker.find(Eigen::Isometry3f::Identity());
        tracker.end(Eigen::Isometry3f::Identity());
    }
    static Ball ball_at(double x, double radius = 0.25) { return {Vector3d(x, 0.1, 1.1), radius}; }
};

TEST_F(Objects, ABallThatGlidesByHasAPoseAndAModel) {
    constexpr double kStep = 0.015;
    std::set<int> labels;
    Vector3d first;
    int first_frame = -1;
    for (int k = 0; k < 26; ++k) {
        process(ball_at(-0.25 + kStep * k));
        for (const MovingObject& object : objects.objects()) {
            labels.insert(object.label);
            const Vector3d place = object.T_camera_object.translation();
            if (first_frame < 0) first = place, first_frame = k;
            // a ball may turn about its middle, which is not the origin of the object
            EXPECT_LT((place - first - Vector3d(kStep * (k - first_frame), 0, 0)).norm(), 0.02) << k;
            EXPECT_GT(object.pixels, 3000u);
        }
    }
    EXPECT_EQ(labels, std::set<int>{kFirstMoverLabel});
    ASSERT_GE(first_frame, 0);
    EXPECT_LE(first_frame, 15) << "known after half a second";
    const std::vector<ObjectMap> maps = objects.maps(true);
    ASSERT_EQ(maps.size(), 1u);
    EXPECT_GT(maps[0].surfels.size(), 1000u);
    // all on one sphere: its middle is where the ball is now, in the frame of the object
    const Isometry3d T_object_camera = objects.objects().at(0).T_camera_object.inverse();
    const Vector3d middle = T_object_camera * ball_at(-0.25 + kStep * 25).centre;
    double sum = 0;
    for (const Surfel& surfel : maps[0].surfels)
        sum += std::abs((surfel.position.cast<double>() - middle).norm() - 0.25);
    EXPECT_LT(sum / static_cast<double>(maps[0].surfels.size()), 0.008);
}

TEST_F(Objects, WhatStandsStillIsNoneWhateverTheJudgeSays) {
    for (int k = 0; k < 20; ++k) {
        process(ball_at(0));
        EXPECT_TRUE(objects.objects().empty()) << k;
    }
    EXPECT_TRUE(objects.maps(false).empty());
}

TEST_F(Objects, WhatChangesItsShapeIsNone) {
    for (int k = 0; k < 24; ++k) {
        process(ball_at(-0.2 + 0.01 * k, 0.36 - 0.011 * k));
        EXPECT_TRUE(objects.objects().empty()) << k;
    }
    EXPECT_TRUE(objects.maps(false).empty());
}

TEST_F(Objects, AThingThatHasStoppedIsTheSameOneWhenItMovesAgain) {
    const auto x = [](int k) { return -0.3 + 0.015 * (k < 20 ? k : k < 60 ? 20 : k - 40); };
    std::set<int> labels;
    bool rested = false, moved_again = false;
    for (int k = 0; k < 76; ++k) {
        process(ball_at(x(k)), k < 24 || k >= 63);
        if (k == 59) rested = objects.objects().empty();
        for (const MovingObject& object : objects.objects()) {
            labels.insert(object.label);
            moved_again = moved_again || k > 65;
        }
    }
    EXPECT_TRUE(rested) << "it belongs to the static scene";
    EXPECT_TRUE(moved_again);
    EXPECT_EQ(labels, std::set<int>{kFirstMoverLabel});
}

TEST_F(Objects, ContinueFromTheirStateByteByByte) {
    for (int k = 0; k < 18; ++k) process(ball_at(-0.25 + 0.015 * k));
    ObjectTracker resumed(judge, context, kCamera, test_config());
    resumed.restore(objects.state());
    for (int k = 18; k < 22; ++k) {
        process(ball_at(-0.25 + 0.015 * k));
        process(resumed, ball_at(-0.25 + 0.015 * k));
    }
    ASSERT_FALSE(objects.objects().empty());
    EXPECT_EQ(objects.state(), resumed.state());
    ByteArray damaged = objects.state();
    damaged.resize(damaged.size() / 2);
    EXPECT_THROW(resumed.restore(damaged), Error);
}

}  // namespace
}  // namespace posefusion::test
