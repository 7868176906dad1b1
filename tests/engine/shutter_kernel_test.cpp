#include <algorithm>
#include <cmath>

#include "engine/preprocess/global_shutter.hpp"
#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/rolling_room.hpp"

// The kernel that turns a rolling frame into one taken at its stamp, against frames that were.
namespace posefusion::test {
namespace {

const Velocity kFast{{0.3, -0.1, 0.2}, {0.5, 1.2, -0.7}};

class GlobalShutterKernel : public DeviceTest {
protected:
    struct Images {
        std::vector<float> depth;
        std::vector<std::uint32_t> color;
    };
    static Images images_of(const Frame& frame) {
        Images images;
        for (std::size_t i = 0; i < frame.depth.size(); ++i) {
            images.depth.push_back(frame.depth[i]);
            images.color.push_back(pack_rgb(frame.color[i]));
        }
        return images;
    }
    static Images correct(const Images& rolling, const Intrinsics& camera, const ShutterConfig& shutter,
                          const Velocity& velocity, GlobalShutter::Motion by = GlobalShutter::Motion::Expected) {
        SlamConfig config;
        config.shutter = shutter;
        gpu::TrackingRecord record{};
        const gpu::Twist motion{vec4_of(velocity.translation, 0), vec4_of(velocity.rotation, 0)};
        if (by == GlobalShutter::Motion::Found) {
            record.frame_motion = motion;
            record.turn_acceleration = vec4_of(velocity.acceleration, 0);
        } else {
            record.expected_motion = motion;
        }
        const std::size_t n = rolling.depth.size();
        Launch launch("preprocess/global_shutter");
        launch.input("params", posefusion::make_params(camera, config)).input("record", record);
        launch.input("rolling_depth", rolling.depth).input("rolling_color", rolling.color);
        launch.output<float>("depth", n).output<std::uint32_t>("color", n);
        launch.run_over(n, {{"found", static_cast<std::uint32_t>(by)}});
        return {launch.read<float>("depth"), launch.read<std::uint32_t>("color")};
    }
    /// Medians over the pixels without the border, into which nothing was seen to move: metres and steps of 255.
    struct Errors {
        double depth, color;
    };
    static Errors errors(const Images& found, const Images& expected, const Intrinsics& camera) {
        constexpr int kBorder = 6;
        std::vector<double> depth, color;
        for (int v = kBorder; v < camera.height - kBorder; ++v) {
            for (int u = kBorder; u < camera.width - kBorder; ++u) {
                const auto i = static_cast<std::size_t>(v * camera.width + u);
                depth.push_back(std::abs(static_cast<double>(found.depth[i]) - expected.depth[i]));
                color.push_back(std::abs(unpack_rgb(found.color[i]).g - unpack_rgb(expected.color[i]).g));
            }
        }
        const auto middle = [](std::vector<double>& values) {
            std::sort(values.begin(), values.end());
            return values[values.size() / 2];
        };
        return {middle(depth), middle(color)};
    }
};

TEST_F(GlobalShutterKernel, GivesTheFrameThatWasSeenAtTheStamp) {
    for (const Intrinsics& camera : test_cameras()) {
        if (camera.width < 100) continue;  // the border is most of it
        const Images rolling = images_of(render_rolling(camera, rolling_shutter(), Isometry3d::Identity(), kFast));
        const Images global = images_of(render_room(camera, Isometry3d::Identity()));
        const Errors before = errors(rolling, global, camera);
        const Errors after = errors(correct(rolling, camera, rolling_shutter(), kFast), global, camera);
        // colours are rounded twice to whole steps; depth is interpolated linearly on planes
        EXPECT_GT(before.depth, 0.004);
        EXPECT_LT(after.depth, 0.0002);
        EXPECT_GE(before.color, 3);
        EXPECT_LE(after.color, 1);
    }
}

TEST_F(GlobalShutterKernel, KnowsATurnThatGetsFasterOnceTrackingHasFoundIt) {
    for (const Intrinsics& camera : test_cameras()) {
        if (camera.width < 100) continue;
        Velocity faster = kFast;
        faster.acceleration = {60, -80, 40};
        const Images rolling = images_of(render_rolling(camera, rolling_shutter(), Isometry3d::Identity(), faster));
        const Images global = images_of(render_room(camera, Isometry3d::Identity()));
        const Errors before = errors(correct(rolling, camera, rolling_shutter(), kFast), global, camera);
        const Errors after =
            errors(correct(rolling, camera, rolling_shutter(), faster, GlobalShutter::Motion::Found), global, camera);
        EXPECT_GT(before.depth, 0.001);
        EXPECT_LT(after.depth, 0.0002);
        EXPECT_LE(after.color, 1);
    }
}

TEST_F(GlobalShutterKernel, OfACameraAtRestChangesNothing) {
    const Intrinsics camera = test_cameras()[1];
    Random random(5);
    Images rolling;
    for (int i = 0; i < camera.width * camera.height; ++i) {
        rolling.depth.push_back(random.chance(0.2) ? 0.0f : static_cast<float>(random.uniform(0.5, 4)));
        rolling.color.push_back(static_cast<std::uint32_t>(random.uniform(0, 4294967295.0)));
    }
    const Images result = correct(rolling, camera, rolling_shutter(), {Vector3d::Zero(), Vector3d::Zero()});
    EXPECT_EQ(result.color, rolling.color);
    for (std::size_t i = 0; i < rolling.depth.size(); ++i) EXPECT_NEAR(result.depth[i], rolling.depth[i], 1e-6f);
}

TEST_F(GlobalShutterKernel, TakesNoDepthFromOutsideAndMixesNoSurfaces) {
    const Intrinsics camera = test_cameras()[0];
    Images rolling{std::vector<float>(static_cast<std::size_t>(camera.width * camera.height), 2.0f), {}};
    for (std::size_t i = 0; i < rolling.depth.size(); ++i) {
        if (i % static_cast<std::size_t>(camera.width) > 80) rolling.depth[i] = 1.0f;  // a step
    }
    rolling.color.assign(rolling.depth.size(), 0x80ffffffu);
    const Velocity turning{Vector3d::Zero(), {0, 3, 0}};
    const Images result = correct(rolling, camera, rolling_shutter(), turning);
    int outside = 0;
    for (const float z : result.depth) {
        outside += z == 0;
        const bool one_of_both =
            std::abs(z - 2.0f) < 0.15f || std::abs(z - 1.0f) < 0.15f;  // seen obliquely after turning
        EXPECT_TRUE(z == 0 || one_of_both) << z;
    }
    EXPECT_GT(outside, camera.height);  // the turn has uncovered a margin
    EXPECT_LT(outside, camera.height * 12);
    EXPECT_EQ(result.color, rolling.color) << "one colour and one label stay what they are";
}

}  // namespace
}  // namespace posefusion::test
