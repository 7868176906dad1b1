#include "hosts/viewer/frame_feed.hpp"

#include <gtest/gtest.h>

namespace posefusion {
namespace {

const Intrinsics kCamera{130, 130, 79.5f, 59.5f, 160, 120};

ScheduledFrame frame(std::size_t number) {
    ScheduledFrame frame;
    frame.number = number;
    frame.input.stamp = std::chrono::milliseconds(10000 + 100 * number);
    frame.result.T_world_camera.translation().x() = static_cast<double>(number);
    return frame;
}

TEST(FrameFeed, EveryFrameIsCollectedOnceInOrder) {
    FrameFeed feed(kCamera);
    EXPECT_TRUE(feed.collect().frames.empty());
    for (std::size_t i = 0; i < 3; ++i) feed.publish(frame(i));
    const FrameFeed::News news = feed.collect();
    ASSERT_EQ(news.frames.size(), 3u);
    EXPECT_EQ(news.frames[2].number, 2u);
    EXPECT_FALSE(news.corrected);
    EXPECT_TRUE(feed.collect().frames.empty());
    EXPECT_EQ(feed.frames_done(), 3u);
    EXPECT_EQ(feed.trajectory()[1].T_world_camera.translation().x(), 1);
}

TEST(FrameFeed, ALoopCorrectsThePastOnce) {
    FrameFeed feed(kCamera);
    for (std::size_t i = 0; i < 2; ++i) feed.publish(frame(i));
    (void)feed.collect();
    ScheduledFrame closing = frame(2);
    closing.result.loops.resize(3);
    closing.result.loops[1].accepted = true;
    closing.result.loops[2].accepted = true;
    closing.result.loops[2].kind = LoopKind::Relocalisation;
    feed.publish(closing);
    std::vector<Eigen::Isometry3d> poses(3, Eigen::Isometry3d::Identity());
    poses[1].translation().y() = 5;
    feed.correct({0, 1, 2}, poses);
    feed.publish(frame(3));

    const FrameFeed::News news = feed.collect();
    ASSERT_EQ(news.frames.size(), 2u);
    EXPECT_EQ(news.frames.back().loops, 1u) << "finding the camera again closes no loop";
    ASSERT_TRUE(news.corrected);
    ASSERT_EQ(news.corrected->size(), 4u) << "all there are";
    EXPECT_EQ((*news.corrected)[1].T_world_camera.translation().y(), 5);
    EXPECT_EQ((*news.corrected)[1].stamp, std::chrono::milliseconds(10100));
    EXPECT_EQ((*news.corrected)[3].T_world_camera.translation().x(), 3) << "newer than the correction";
    EXPECT_FALSE(feed.collect().corrected);
    EXPECT_EQ(feed.trajectory()[1].T_world_camera.translation().y(), 5);
}

TEST(FrameFeed, FramesInAnotherWorldAreNotShown) {
    FrameFeed feed(kCamera);
    for (std::size_t i = 0; i < 4; ++i) feed.publish(frame(i));
    feed.correct({2, 3}, {Eigen::Isometry3d::Identity(), Eigen::Isometry3d::Identity()});  // a new piece of map
    ASSERT_EQ(feed.trajectory().size(), 2u);
    EXPECT_EQ(feed.trajectory()[0].stamp, std::chrono::milliseconds(10200));
    EXPECT_EQ(feed.frames_done(), 4u);
    feed.correct({0, 1, 2, 3}, std::vector<Eigen::Isometry3d>(4, Eigen::Isometry3d::Identity()));
    EXPECT_EQ(feed.collect().corrected->size(), 4u) << "joined again";
}

TEST(FrameFeed, ModelsAreMadeWhenTheWindowHasTakenTheLastOnes) {
    FrameFeed feed(kCamera);
    EXPECT_FALSE(feed.models_wanted()) << "nobody looks";
    EXPECT_FALSE(feed.take_models());
    EXPECT_TRUE(feed.models_wanted());
    feed.publish_models({{101, {}}, {102, {}}});
    EXPECT_FALSE(feed.models_wanted()) << "the window is slower than the run";
    ASSERT_EQ(feed.take_models()->size(), 2u);
    EXPECT_FALSE(feed.take_models());
    EXPECT_TRUE(feed.models_wanted());
}

TEST(FrameFeed, ANewRunKnowsNothingOfTheOldOne) {
    FrameFeed feed(kCamera);
    feed.publish(frame(0));
    feed.correct({0}, {Eigen::Isometry3d::Identity()});
    feed.publish_models({{101, {}}});
    feed.clear();
    EXPECT_FALSE(feed.take_models());
    EXPECT_EQ(feed.frames_done(), 0u);
    const FrameFeed::News news = feed.collect();
    EXPECT_TRUE(news.frames.empty());
    EXPECT_FALSE(news.corrected);
}

}  // namespace
}  // namespace posefusion
