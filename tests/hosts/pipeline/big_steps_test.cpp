// The whole method on a camera that moves far from frame to frame: features find what the dense start misses.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/slam/map_piece.hpp"
#include "hosts/pipeline/posefusion.hpp"
#include "tests/engine/support/reference.hpp"
#include "tests/engine/support/synthetic_room.hpp"

namespace posefusion {
namespace {

const Camera kCamera{{262.5f, 262.5f, 159.5f, 119.5f, 320, 240}, 1000, {}};
constexpr double kPeriod = 0.2;  // seconds between frames

RunConfig config_with(bool sparse_start) {
    RunConfig config;
    config.no_people = true;
    config.features.sparse_start = sparse_start;
    return config;
}

/// To and fro, 15 cm and 8 degrees from frame to frame.
std::vector<Eigen::Isometry3d> big_steps() {
    std::vector<Eigen::Isometry3d> path;
    for (const double x : {0.0, 1.0, 2.0, 1.0, 0.0, -1.0, 0.0, 1.0})
        path.push_back(test::motion({0.14 * x, 0.03 * x, -0.04 * x}, {0.2, 1, 0.1}, -8 * x));
    return path;
}

struct Track {
    std::vector<FrameResult> results;
    double largest_error = 0;  ///< of the poses, metres
};

Track run(PoseFusion& method, const std::vector<Eigen::Isometry3d>& path, std::size_t first = 0) {
    Track run;
    for (std::size_t k = first; k < path.size(); ++k) {
        test::Frame frame = test::render_room(kCamera.intrinsics, path[k]);
        const Stamp stamp = stamp_of(1 + kPeriod * static_cast<double>(k));
        run.results.push_back(method.process(std::move(frame.color), std::move(frame.depth), stamp).result);
        const Eigen::Isometry3d error = path[k].inverse() * run.results.back().T_world_camera;
        run.largest_error = std::max(run.largest_error, error.translation().norm());
    }
    return run;
}

TEST(BigSteps, AreTrackedFromTheSparseStart) {
    PoseFusion with(kCamera, config_with(true)), without(kCamera, config_with(false));
    const Track sparse = run(with, big_steps()), dense = run(without, big_steps());
    EXPECT_LT(sparse.largest_error, 0.01);
    EXPECT_GT(dense.largest_error, 0.05) << "the steps are small: this test shows nothing";
    for (std::size_t k = 1; k < sparse.results.size(); ++k) {
        EXPECT_EQ(sparse.results[k].tracking, TrackingState::Ok) << k;
        EXPECT_TRUE(sparse.results[k].start_used) << k;
        EXPECT_GT(sparse.results[k].start_inliers, 0u) << k;
        EXPECT_FALSE(dense.results[k].start_used);
    }
}

TEST(BigSteps, SmallOnesNeedNoSparseStart) {
    const auto path = test::path_to(test::motion({0.03, 0, 0.02}, {0, 1, 0}, 2), 6);
    PoseFusion with(kCamera, config_with(true)), without(kCamera, config_with(false));
    const Track sparse = run(with, path), dense = run(without, path);
    for (std::size_t k = 0; k < path.size(); ++k) {
        EXPECT_FALSE(sparse.results[k].start_used) << k;
        EXPECT_EQ(sparse.results[k].T_world_camera.matrix(), dense.results[k].T_world_camera.matrix()) << k;
    }
}

TEST(BigSteps, AreTrackedOnAfterARestore) {
    const auto path = big_steps();
    const std::vector<Eigen::Isometry3d> beginning(path.begin(), path.begin() + 4);
    PoseFusion whole(kCamera, config_with(true)), first(kCamera, config_with(true)), second(kCamera, config_with(true));
    const Track all = run(whole, path);
    std::vector<MotionPrediction::Pose> poses;
    for (const FrameResult& result : run(first, beginning).results) {
        const Stamp stamp = stamp_of(1 + kPeriod * static_cast<double>(poses.size()));
        poses.push_back({stamp, result.T_world_tracked, result.T_world_camera, true});
    }
    second.restore(first.engine().atlas_state(), first.people_state(), poses);
    const Track rest = run(second, path, beginning.size());
    for (std::size_t k = 0; k < rest.results.size(); ++k) {
        EXPECT_EQ(rest.results[k].T_world_camera.matrix(), all.results[k + beginning.size()].T_world_camera.matrix());
        EXPECT_TRUE(rest.results[k].start_used);
    }
}

TEST(BigSteps, AFrameWithoutAViewDoesNotBreakTheTrack) {
    const auto path = big_steps();
    PoseFusion method(kCamera, config_with(true));
    (void)run(method, {path.begin(), path.begin() + 3});
    test::Frame dark = test::render_room(kCamera.intrinsics, path[3]);
    for (Rgb8& c : dark.color) c = {60, 60, 60};
    for (std::size_t i = 100; i < dark.depth.size(); ++i) dark.depth[i] = 0;
    (void)method.process(std::move(dark.color), std::move(dark.depth), stamp_of(1 + 3 * kPeriod));
    const Track rest = run(method, path, 4);
    EXPECT_LT(rest.largest_error, 0.01) << "the reference frame was seen before";
    for (const FrameResult& result : rest.results) EXPECT_EQ(result.tracking, TrackingState::Ok);
}

}  // namespace
}  // namespace posefusion
