#include <algorithm>
#include <limits>

#include "engine/core/error.hpp"
#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/synthetic_room.hpp"

// What cannot be used is refused with one line that says what and where.
namespace posefusion::test {
namespace {

class EngineBadInput : public SlamTest {
protected:
    template <class Action>
    static void expect_error(Action action, const std::vector<std::string>& mentions) {
        try {
            action();
            ADD_FAILURE() << "no Error was thrown, expected one about " << mentions.front();
        } catch (const Error& error) {
            const std::string message = error.what();
            EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 0) << message;
            for (const auto& word : mentions) EXPECT_NE(message.find(word), std::string::npos) << message;
        }
    }
    static void expect_camera_error(const Intrinsics& camera, const std::vector<std::string>& mentions) {
        expect_error([&] { Slam slam(camera, test_config(), test_device()); }, mentions);
    }
};

TEST_F(EngineBadInput, IntrinsicsThatAreNotPositive) {
    for (const float bad : {0.0f, -525.0f, std::numeric_limits<float>::quiet_NaN()}) {
        Intrinsics camera = kSmall;
        camera.fx = bad;
        expect_camera_error(camera, {"fx", "positive"});
        camera = kSmall;
        camera.fy = bad;
        expect_camera_error(camera, {"fy", "positive"});
    }
    for (const int bad : {0, -160}) {
        Intrinsics camera = kSmall;
        camera.width = bad;
        expect_camera_error(camera, {"width"});
        camera = kSmall;
        camera.height = bad;
        expect_camera_error(camera, {"height"});
    }
}

TEST_F(EngineBadInput, IntrinsicsThatAreNotFinite) {
    for (float Intrinsics::*member : {&Intrinsics::fx, &Intrinsics::fy, &Intrinsics::cx, &Intrinsics::cy}) {
        for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
            Intrinsics camera = kSmall;
            camera.*member = bad;
            expect_camera_error(camera, {"camera"});
        }
    }
}

TEST_F(EngineBadInput, SizesThatTheKernelsCannotUse) {
    for (const auto& [width, height] : {std::pair{162, 120}, {160, 118}, {161, 121}}) {
        Intrinsics camera = kSmall;
        camera.width = width, camera.height = height;
        expect_camera_error(camera, {std::to_string(width) + "x" + std::to_string(height), "multiples of 4"});
    }
    for (const auto& [width, height] : {std::pair{4, 120}, {160, 4}}) {
        Intrinsics camera = kSmall;
        camera.width = width, camera.height = height;
        expect_camera_error(camera, {std::to_string(width) + "x" + std::to_string(height), "small"});
    }
}

TEST_F(EngineBadInput, ImagesTooLarge) {
    Intrinsics camera = kSmall;
    camera.width = 4096, camera.height = 2160;
    expect_camera_error(camera, {"4096x2160", "too large"});
}

TEST_F(EngineBadInput, ImagesOfAnotherSizeThanTheCamera) {
    Slam slam(kSmall, test_config(), test_device());
    const Frame frame = render_room(kSmall, Eigen::Isometry3d::Identity());
    expect_error([&] { slam.process(ColorImage(80, 60), frame.depth); }, {"colour", "80x60", "160x120"});
    expect_error([&] { slam.process(frame.color, DepthImage(120, 160)); }, {"depth", "120x160", "160x120"});
    expect_error([&] { slam.process(frame.color, frame.depth, LabelImage(160, 119)); },
                 {"label", "160x119", "160x120"});
    expect_error([&] { slam.process({}, {}); }, {"0x0"});
    // and the engine is as it was
    EXPECT_EQ(slam.process(frame.color, frame.depth).tracking, TrackingState::FirstFrame);
    EXPECT_EQ(slam.process(frame.color, frame.depth).tracking, TrackingState::Ok);
}

TEST_F(EngineBadInput, DeviceThatIsNotThere) {
    expect_error([] { Slam slam(kSmall, test_config(), "no such gpu"); }, {"no such gpu", "devices"});
    expect_error([] { Slam slam(kSmall, test_config(), "42"); }, {"42", "devices"});
}

}  // namespace
}  // namespace posefusion::test
