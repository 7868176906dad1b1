#include "hosts/pipeline/motion_prediction.hpp"

#include <gtest/gtest.h>

namespace posefusion {
namespace {

Eigen::Isometry3d step() {
    return Eigen::Translation3d(0.01, -0.02, 0.03) * Eigen::AngleAxisd(0.02, Eigen::Vector3d(1, 2, 3).normalized());
}

TEST(MotionPrediction, FirstFramesHaveNone) {
    MotionPrediction motion;
    motion.publish(0, Eigen::Isometry3d::Identity());
    for (std::size_t frame = 0; frame < 3; ++frame) {
        EXPECT_TRUE(motion.predict(frame, 1, 0).isApprox(Eigen::Isometry3f::Identity()));
    }
}

TEST(MotionPrediction, ConstantVelocityIsContinuedExactly) {
    MotionPrediction motion;
    Eigen::Isometry3d pose = step() * step();
    for (int i = 0; i < 5; ++i, pose = pose * step()) motion.publish(i / 30.0, pose);
    EXPECT_TRUE(motion.predict(6, 6 / 30.0, 5 / 30.0).isApprox(step().cast<float>(), 1e-5f));
}

TEST(MotionPrediction, ADroppedFrameMeansTwiceTheMotion) {
    MotionPrediction motion;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (int i = 0; i < 2; ++i, pose = pose * step()) motion.publish(i / 30.0, pose);
    const Eigen::Isometry3f predicted = motion.predict(3, 4 / 30.0, 2 / 30.0);
    EXPECT_TRUE(predicted.isApprox((step() * step()).cast<float>(), 1e-3f));
}

TEST(MotionPrediction, StampsThatStandStillDoNotBreakIt) {
    MotionPrediction motion;
    motion.publish(1.0, Eigen::Isometry3d::Identity());
    motion.publish(1.0, step());
    EXPECT_TRUE(motion.predict(3, 1.0, 1.0).isApprox(step().cast<float>(), 1e-5f));
}

TEST(MotionPrediction, GoesOnWithoutPosesOnceClosed) {
    MotionPrediction motion;
    motion.close();
    EXPECT_TRUE(motion.predict(10, 1, 0).isApprox(Eigen::Isometry3f::Identity()));
}

}  // namespace
}  // namespace posefusion
