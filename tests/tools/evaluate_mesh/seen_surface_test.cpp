#include "tools/evaluate_mesh/seen_surface.hpp"

#include <gtest/gtest.h>

#include "hosts/synth/synth.hpp"
#include "tests/hosts/support/temp_folder.hpp"
#include "tools/evaluate_mesh/mesh_scores.hpp"
#include "tools/evaluate_objects/triangle_distance.hpp"

/// Which part of the true surface a recording shows.
namespace posefusion::test {
namespace {

class SeenSurface : public ::testing::Test {
protected:
    static SynthConfig config() {
        SynthConfig config;
        config.frames = 10;
        config.people = 0;
        config.width = 160;
        config.height = 120;
        config.noise = false;
        return config;
    }
};

TEST_F(SeenSurface, TheSurfaceFileIsTheRoomThatIsRendered) {
    const TempFolder folder;
    SynthConfig c = config();
    c.out = folder / "room";
    synthesize(c);
    const TrueMesh room = read_true_mesh(folder / "room" / "surface.ply");
    const TriangleDistance distance(room);
    const Recording recording(folder / "room");
    const auto truth = recording.groundtruth();
    const Intrinsics& k = recording.intrinsics();
    const DepthImage depth = recording.load(3).depth;
    int pixels = 0;
    for (int v = 5; v < depth.height(); v += 20)
        for (int u = 5; u < depth.width(); u += 20) {
            const float z = depth(u, v);
            if (!(z > 0)) continue;
            const Eigen::Vector3d p((static_cast<float>(u) - k.cx) / k.fx * z,
                                    (static_cast<float>(v) - k.cy) / k.fy * z, z);
            const Eigen::Vector3d in_world = (*truth)[3].T_world_camera * p;
            EXPECT_LT(distance(in_world.cast<float>()), 0.002f);
            ++pixels;
        }
    EXPECT_GT(pixels, 30);
}

TEST_F(SeenSurface, IsWhatTheDepthImagesShow) {
    const TempFolder folder;
    SynthConfig c = config();
    c.out = folder / "room";
    synthesize(c);
    const Recording recording(folder / "room");
    const TrueMesh truth = read_true_mesh(folder / "room" / "surface.ply");
    const auto points = spread_points(truth, 0.05f);
    const auto seen = seen_points(recording, truth, points);
    EXPECT_GT(seen.size(), points.size() / 50);
    EXPECT_LT(seen.size(), points.size() / 2) << "a camera sees one side of a room";
    const Eigen::Isometry3f T_camera_world = (*recording.groundtruth())[5].T_world_camera.inverse().cast<float>();
    for (const Eigen::Vector3f& p : seen) ASSERT_GT((T_camera_world * p).z(), 0);
    SeenSurfaceConfig more;
    more.least_frames = 11;  // there are five frames of ten
    EXPECT_TRUE(seen_points(recording, truth, points, more).empty());

    // a sheet a hair behind all that is seen is not
    std::vector<Eigen::Vector3f> behind;
    const Eigen::Vector3f eye = (*recording.groundtruth())[5].T_world_camera.translation().cast<float>();
    for (const Eigen::Vector3f& p : seen) behind.push_back(p + 0.01f * (p - eye).normalized());
    EXPECT_LT(seen_points(recording, truth, behind).size(), seen.size() / 20);
}

}  // namespace
}  // namespace posefusion::test
