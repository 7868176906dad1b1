#include "hosts/evaluate/time_offset.hpp"

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "tests/hosts/evaluate/trajectories.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using namespace std::chrono_literals;
using test::message_of;
using test::moved;
using test::pose;
using test::walk;

TEST(TimeOffset, IsFoundToAMillisecond) {
    const Trajectory truth = walk(1000, 100);
    for (const Stamp late : {0us, 137500us, -812300us}) {
        const Trajectory estimate = shifted(moved(pose({3, -2, 1}, 140), walk(200)), late);
        EXPECT_NEAR(to_seconds(find_time_offset(truth, estimate)), to_seconds(-late), 1e-3);
    }
}

TEST(TimeOffset, IsFoundWhereTheScaleIsNotKnown) {
    TimeOffsetConfig config;
    config.scale = true;
    const Trajectory estimate = shifted(scaled(walk(200), 0.2), 250ms);
    EXPECT_NEAR(to_seconds(find_time_offset(walk(1000, 100), estimate, config)), -0.25, 1e-3);
}

TEST(TimeOffset, IsRefusedWhereTheTrajectoriesDoNotTell) {
    const auto fault = [](const Trajectory& truth, const Trajectory& estimate) {
        return message_of<Error>([&] { (void)find_time_offset(truth, estimate); });
    };
    const Trajectory truth = walk(1000, 100);
    Trajectory still = walk(200);
    for (StampedPose& p : still) p.T_world_camera.setIdentity();
    EXPECT_NE(fault(still, still).find("fit equally well"), std::string::npos) << fault(still, still);
    const Trajectory elsewhere = moved(pose({3.3, -2.7, 1.1}, 140), still);  // but for rounding
    EXPECT_NE(fault(elsewhere, still).find("fit equally well"), std::string::npos) << fault(elsewhere, still);
    EXPECT_NE(fault(truth, shifted(walk(200), 1h)).find("no time in common"), std::string::npos);
    EXPECT_NE(fault(truth, shifted(walk(200), 3s)).find("at the end of the range"), std::string::npos)
        << fault(truth, shifted(walk(200), 3s));
}

}  // namespace
}  // namespace posefusion
