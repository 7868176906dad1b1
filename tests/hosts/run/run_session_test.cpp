#include "hosts/run/run_session.hpp"

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

TEST(RunSession, ACameraIsAlwaysInRealTime) {
    const test::TempFolder folder;
    RunConfig config;
    config.no_people = true;
    config.max_frames = 3;
    config.camera = folder.write("c.yaml", "fx: 300\nfy: 300\ncx: 160\ncy: 120\nwidth: 320\nheight: 240\n");
    std::optional<RunSession> session;
    try {
        session.emplace("openni2:Dummy", config);  // of OpenNI2, for tests
    } catch (const Error& error) {
        GTEST_SKIP() << error.what();  // built without cameras
    }
    EXPECT_FALSE(config.real_time);
    EXPECT_TRUE(session->real_time());
    Console console;
    const RunRecord record = session->run(console, [](const ScheduledFrame&) {});
    EXPECT_EQ(record.status, RunStatus::Finished) << record.error;
    EXPECT_EQ(record.frames.size(), 3u);
    EXPECT_TRUE(record.dropped.has_value()) << "frames were not counted";
}

}  // namespace
}  // namespace posefusion
