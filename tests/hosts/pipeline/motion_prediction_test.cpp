#include "hosts/pipeline/motion_prediction.hpp"

#include <gtest/gtest.h>

namespace posefusion {
namespace {

Eigen::Isometry3d step() {
    return Eigen::Translation3d(0.01, -0.02, 0.03) * Eigen::AngleAxisd(0.02, Eigen::Vector3d(1, 2, 3).normalized());
}

/// A frame that nothing was corrected in.
void publish(MotionPrediction& motion, double stamp, const Eigen::Isometry3d& pose) {
    motion.publish({stamp_of(stamp), pose, pose});
}

TEST(MotionPrediction, FirstFramesHaveNone) {
    MotionPrediction motion;
    publish(motion, 0, Eigen::Isometry3d::Identity());
    for (std::size_t frame = 0; frame < 3; ++frame) {
        EXPECT_TRUE(motion.predict(frame, stamp_of(1), stamp_of(0)).isApprox(Eigen::Isometry3f::Identity()));
    }
}

TEST(MotionPrediction, ConstantVelocityIsContinuedExactly) {
    MotionPrediction motion;
    Eigen::Isometry3d pose = step() * step();
    for (int i = 0; i < 5; ++i, pose = pose * step()) publish(motion, i / 30.0, pose);
    EXPECT_TRUE(motion.predict(6, stamp_of(6 / 30.0), stamp_of(5 / 30.0)).isApprox(step().cast<float>(), 1e-5f));
}

TEST(MotionPrediction, ADroppedFrameMeansTwiceTheMotion) {
    MotionPrediction motion;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (int i = 0; i < 2; ++i, pose = pose * step()) publish(motion, i / 30.0, pose);
    const Eigen::Isometry3f predicted = motion.predict(3, stamp_of(4 / 30.0), stamp_of(2 / 30.0));
    EXPECT_TRUE(predicted.isApprox((step() * step()).cast<float>(), 1e-3f));
}

TEST(MotionPrediction, ACorrectionOfThePoseIsNoMotion) {
    const Eigen::Isometry3d correction =
        Eigen::Translation3d(0.5, 0, -0.2) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY());
    constexpr int kFrames = 8, kCorrected = 4;
    MotionPrediction motion;
    Eigen::Isometry3d pose = step();
    for (int i = 0; i < kFrames; ++i, pose = pose * step()) {
        const Eigen::Isometry3d tracked = pose;
        if (i == kCorrected) pose = correction * pose;
        motion.publish({stamp_of(i / 30.0), tracked, pose});
    }
    for (std::size_t frame = 3; frame < kFrames + 2; ++frame) {
        const double stamp = static_cast<double>(frame) / 30.0;
        EXPECT_TRUE(
            motion.predict(frame, stamp_of(stamp), stamp_of(stamp - 1 / 30.0)).isApprox(step().cast<float>(), 1e-4f))
            << frame;
    }
}

TEST(MotionPrediction, StampsThatStandStillDoNotBreakIt) {
    MotionPrediction motion;
    publish(motion, 1.0, Eigen::Isometry3d::Identity());
    publish(motion, 1.0, step());
    EXPECT_TRUE(motion.predict(3, stamp_of(1.0), stamp_of(1.0)).isApprox(step().cast<float>(), 1e-5f));
}

TEST(MotionPrediction, GoesOnWithoutPosesOnceClosed) {
    MotionPrediction motion;
    motion.close();
    EXPECT_TRUE(motion.predict(10, stamp_of(1), stamp_of(0)).isApprox(Eigen::Isometry3f::Identity()));
}

}  // namespace
}  // namespace posefusion
