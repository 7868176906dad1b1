#pragma once
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "engine/slam/slam.hpp"

/// Noise-free frames of a textured room, ray-cast, with exact poses: what tracking must recover is known to the last
/// bit.
namespace posefusion::test {

/// A ball that stands for a person: in front of the walls, textured, at any place.
struct Ball {
    Eigen::Vector3d centre;  ///< world
    double radius = 0.25;    ///< metres
};

struct Frame {
    ColorImage color;
    DepthImage depth;
    LabelImage labels;  ///< 1 on the ball
};

/// A corner of a room with a block in it, 1 to 3 m away. World = first camera.
[[nodiscard]] Frame render_room(const Intrinsics& camera, const Eigen::Isometry3d& T_world_camera,
                                const std::optional<Ball>& ball = {});
/// Distance of a point (world) from the nearest surface of the empty room, metres.
[[nodiscard]] double distance_to_room(const Eigen::Vector3d& point);

/// `frames` poses from the identity to `end`, evenly spaced on the screw-free path.
[[nodiscard]] std::vector<Eigen::Isometry3d> path_to(const Eigen::Isometry3d& end, int frames);

/// Configuration of the tests: defaults with validation on.
[[nodiscard]] SlamConfig test_config();

/// Angle of a rotation, degrees.
[[nodiscard]] double angle_deg(const Eigen::Isometry3d& T);

inline const Intrinsics kSmall{131.25f, 131.25f, 79.5f, 59.5f, 160, 120};

/// Tests of the whole engine; each ends with: validation had nothing to say.
class SlamTest : public testing::Test {
protected:
    void SetUp() override { testing::internal::CaptureStderr(); }
    void TearDown() override {
        const std::string text = testing::internal::GetCapturedStderr();
        EXPECT_EQ(text.find("Vulkan validation"), std::string::npos) << text.substr(0, 2000);
    }
};

/// Poses and surfels of a run, byte by byte.
struct Recording {
    std::vector<FrameResult> results;
    std::vector<Surfel> surfels;
    [[nodiscard]] std::vector<unsigned char> bytes() const;
};
[[nodiscard]] Recording run_slam(const Intrinsics& camera, const SlamConfig& config,
                                 const std::vector<Eigen::Isometry3d>& path);

}  // namespace posefusion::test
