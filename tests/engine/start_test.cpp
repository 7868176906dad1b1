#include <algorithm>

#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"
#include "tests/engine/support/synthetic_room.hpp"

// A bad beginning is given up: what filled the view of the first frames has gone, and the map begins anew.
namespace posefusion::test {
namespace {

constexpr int kWith = 4, kFrames = 30;  // frames with something before the camera, and all
constexpr double kMaxError = 0.01;      // metres
constexpr float kNear = 0.6f;           // metres: something that fills most of the view

class StartTest : public SlamTest {
protected:
    const std::vector<Isometry3d> path = path_to(motion({0.15, 0, 0}, {0, 1, 0}, 4), kFrames);

    /// Nine tenths of the view are of something near, which moves with the camera.
    static Frame covered(Frame frame, int k) {
        for (int v = 0; v < kSmall.height; ++v)
            for (int u = 0; u < kSmall.width * 9 / 10; ++u) {
                const auto grey =
                    static_cast<std::uint8_t>(128 + 100 * std::sin(0.3 * (u + 2 * k)) * std::cos(0.2 * v));
                frame.color(u, v) = {grey, grey, grey};
                frame.depth(u, v) = kNear + 0.02f * std::sin(0.1f * static_cast<float>(u));
            }
        return frame;
    }
    [[nodiscard]] std::vector<FrameResult> run(Slam& slam, int with) const {
        std::vector<FrameResult> results;
        for (int k = 0; k < kFrames; ++k) {
            Frame frame = render_room(kSmall, path[static_cast<std::size_t>(k)]);
            if (k < with) frame = covered(std::move(frame), k);
            results.push_back(slam.process(frame.color, frame.depth));
        }
        return results;
    }
};

TEST_F(StartTest, TheMapBeginsAnewWhenWhatFilledTheViewHasGone) {
    Slam slam(kSmall, test_config(), test_device());
    const std::vector<FrameResult> results = run(slam, kWith);
    const auto start = std::find_if(results.begin(), results.end(),
                                    [](const FrameResult& r) { return r.map_change == MapChange::StartedAgain; });
    ASSERT_NE(start, results.end()) << "the bad beginning is kept";
    EXPECT_EQ(std::count_if(results.begin(), results.end(),
                            [](const FrameResult& r) { return r.map_change == MapChange::StartedAgain; }),
              1);
    const auto first = static_cast<std::size_t>(start - results.begin());
    EXPECT_LE(first, static_cast<std::size_t>(kWith + StartConfig::kPatience));
    EXPECT_EQ(start->tracking, TrackingState::FirstFrame);
    for (std::size_t k = first + 1; k < results.size(); ++k) {
        EXPECT_EQ(results[k].tracking, TrackingState::Ok) << k;
        const Isometry3d truth = path[first].inverse() * path[k];
        EXPECT_LT((truth.inverse() * results[k].T_world_camera).translation().norm(), kMaxError) << k;
    }
    EXPECT_EQ(slam.trajectory().size(), results.size() - first) << "frames are counted from the new start on";
    for (const Surfel& surfel : slam.surfels()) {
        const Eigen::Vector3d point = path[first] * surfel.position.cast<double>();
        ASSERT_LT(distance_to_room(point), 0.03) << "something of the first start is still in the map";
    }
}

/// Tracking follows what slides away as if the camera moved, and does not fail: the map is seen through.
TEST_F(StartTest, TheMapBeginsAnewWhenWhatFilledTheViewSlidesAway) {
    Slam slam(kSmall, test_config(), test_device());
    std::size_t first = 0;
    constexpr int kLeaving = 4;
    for (int k = 0; k < kFrames; ++k) {
        Frame frame = render_room(kSmall, path[static_cast<std::size_t>(k)]);
        const int gone = std::clamp(k - kWith + 1, 0, kLeaving + 1);
        const Frame near = covered(frame, 0);
        const int width = kSmall.width * 9 / 10, way = width * gone / (kLeaving + 1);
        for (int v = 0; v < kSmall.height; ++v)
            for (int u = 0; u + way < width; ++u) {
                frame.color(u, v) = near.color(u + way, v);
                frame.depth(u, v) = near.depth(u + way, v);
            }
        const FrameResult result = slam.process(frame.color, frame.depth);
        if (result.map_change == MapChange::StartedAgain) first = static_cast<std::size_t>(k);
        if (k <= kWith + kLeaving || first == 0) continue;
        const Isometry3d truth = path[first].inverse() * path[static_cast<std::size_t>(k)];
        EXPECT_LT((truth.inverse() * result.T_world_camera).translation().norm(), kMaxError) << k;
    }
    EXPECT_GE(first, static_cast<std::size_t>(kWith)) << "what filled the view is kept as the map";
    EXPECT_LE(first, static_cast<std::size_t>(kWith + kLeaving + 2)) << "the beginning is given up again and again";
}

TEST_F(StartTest, AGoodStartIsKept) {
    Slam slam(kSmall, test_config(), test_device());
    for (const FrameResult& result : run(slam, 0)) EXPECT_NE(result.map_change, MapChange::StartedAgain);
    const Frame nothing = covered(render_room(kSmall, path.back()), 0);
    for (int k = 0; k < 2 * StartConfig::kPatience; ++k)
        EXPECT_NE(slam.process(nothing.color, nothing.depth).map_change, MapChange::StartedAgain)
            << "a lens that is covered for a moment";
    EXPECT_EQ(slam.trajectory().size(), static_cast<std::size_t>(kFrames + 2 * StartConfig::kPatience));
}

TEST_F(StartTest, AViewOfNothingIsNoBetterBeginning) {
    Slam slam(kSmall, test_config(), test_device());
    Frame nothing = render_room(kSmall, path.front());
    std::fill(nothing.depth.begin(), nothing.depth.end(), 0.0f);
    for (int k = 0; k < 3 * StartConfig::kPatience; ++k)
        EXPECT_EQ(slam.process(nothing.color, nothing.depth).map_change, MapChange::None) << k;
}

TEST_F(StartTest, ANewStartIsAsGoodAsAFirst) {
    Slam anew(kSmall, test_config(), test_device()), first(kSmall, test_config(), test_device());
    const std::vector<FrameResult> results = run(anew, kWith);
    const auto start = std::find_if(results.begin(), results.end(),
                                    [](const FrameResult& r) { return r.map_change == MapChange::StartedAgain; });
    ASSERT_NE(start, results.end());
    for (auto k = static_cast<std::size_t>(start - results.begin()); k < results.size(); ++k) {
        const Frame frame = render_room(kSmall, path[k]);
        const FrameResult result = first.process(frame.color, frame.depth);
        EXPECT_EQ(result.T_world_camera.matrix(), results[k].T_world_camera.matrix()) << k;
        EXPECT_EQ(result.surfels, results[k].surfels) << k;
    }
}

}  // namespace
}  // namespace posefusion::test
