#include "hosts/adjust/bundle.hpp"

#include <gtest/gtest.h>

#include "tests/hosts/adjust/synthetic_bundle.hpp"

namespace posefusion {
namespace {

TEST(BundleAdjustment, JacobiansAgreeWithNumericDifferences) {
    Bundle bundle;
    bundle.width = 640, bundle.height = 480;
    bundle.camera = with_deformation(SyntheticBundle{}.camera, 0.01);
    times_part(bundle.camera) << 0.008, 0.03, 0.02;
    bundle.readouts = {shaking(0)};
    Observation o;
    o.pixel << 201.3, 402.7;
    o.inverse_depth = 0.61;
    o.slope << 0.0005, -0.001;
    o.pixel_sigma = 0.2, o.inverse_depth_sigma = 0.003;
    const Eigen::Vector3d point(-0.4, 0.5, 1.7);
    const auto error = [&](const Eigen::Vector3d& p, const CameraParameters& c) {
        Bundle other = bundle;
        other.camera = c;
        return error_of(o, p, other).error;
    };
    const CameraParameters& camera = bundle.camera;
    const ObservationError e = error_of(o, point, bundle);
    ASSERT_TRUE(e.valid);
    constexpr double h = 1e-6;
    for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3d d = h * Eigen::Vector3d::Unit(i);
        const Eigen::Vector3d slope = (error(point + d, camera) - error(point - d, camera)) / (2 * h);
        EXPECT_LT((e.by_point.col(i) - slope).norm(), 1e-5 * (1 + slope.norm())) << "point " << i;
    }
    Eigen::Matrix<double, 3, kCameraParameters> by_camera = Eigen::Matrix<double, 3, kCameraParameters>::Zero();
    by_camera.leftCols<kIntrinsicParameters>() = e.by_intrinsics;
    by_camera.rightCols<kTimeParameters>() = e.by_times;
    for (std::size_t i = 0; i < e.cell.nodes.size(); ++i)
        by_camera(2, kIntrinsicParameters + static_cast<int>(e.cell.nodes[i])) = e.by_deformation * e.cell.weights[i];
    for (int i = 0; i < kCameraParameters; ++i) {
        const CameraParameters d = h * CameraParameters::Unit(i);
        const Eigen::Vector3d slope = (error(point, camera + d) - error(point, camera - d)) / (2 * h);
        // the derivative by a time takes the rotation vector for the rotation: it is a hundredth of a radian
        const double tolerance = i < kCameraParameters - kTimeParameters ? 1e-5 : 2e-3;
        EXPECT_LT((by_camera.col(i) - slope).norm(), tolerance * (1 + slope.norm())) << "parameter " << i;
    }
    EXPECT_FALSE(error_of(o, {0, 0, -1}, bundle).valid) << "behind the camera";
}

TEST(BundleAdjustment, FindsPosesAndCamera) {
    SyntheticBundle truth;
    truth.camera = with_deformation(truth.camera, 0.008);
    CameraParameters given = SyntheticBundle{}.camera;
    given(0) *= 1.006, given(1) *= 1.006, given(2) += 2.5, given(3) -= 2;
    Bundle bundle = truth.make(given);
    const std::vector<Eigen::Isometry3d> poses = bundle.T_camera_world;
    for (std::size_t k = 1; k < poses.size(); ++k) bundle.T_camera_world[k].translation().x() += 0.01 * std::sin(k);
    const BundleResult result = adjust(bundle, given, {});

    EXPECT_NEAR(result.variance, 1, 0.3);
    for (int i = 0; i < 2; ++i) EXPECT_NEAR(bundle.camera(i), truth.camera(i), 0.001 * truth.camera(i));
    for (int i = 2; i < 4; ++i) EXPECT_NEAR(bundle.camera(i), truth.camera(i), 0.4) << "pixels";
    const double largest = deformation_part(truth.camera).cwiseAbs().maxCoeff();
    EXPECT_LT(deformation_part(bundle.camera - truth.camera).cwiseAbs().maxCoeff(), 0.3 * largest);
    for (int i = 0; i < kCameraParameters - kTimeParameters; ++i)
        EXPECT_LT(std::abs(bundle.camera(i) - truth.camera(i)), 4.5 * std::sqrt(result.covariance(i, i))) << i;
    for (std::size_t k = 0; k < poses.size(); ++k)
        EXPECT_LT((bundle.T_camera_world[k].translation() - poses[k].translation()).norm(), 0.002) << k;
}

TEST(BundleAdjustment, FindsWhenTheRowsWereReadAndTheFocalLength) {
    SyntheticBundle truth;
    truth.rolls = true;
    times_part(truth.camera) << 0.009, 0.03, 0.026;
    CameraParameters given = truth.camera;
    given(0) *= 1.006, given(1) *= 1.006;
    times_part(given) << 0.005, 0.026, 0.033;
    Bundle bundle = truth.make(given);
    const BundleResult result = adjust(bundle, given, {.times = true});
    EXPECT_NEAR(result.variance, 1, 0.3);
    for (int i = 0; i < 2; ++i) EXPECT_NEAR(bundle.camera(i), truth.camera(i), 0.001 * truth.camera(i));
    for (int i = kCameraParameters - kTimeParameters; i < kCameraParameters; ++i) {
        EXPECT_NEAR(bundle.camera(i), truth.camera(i), 0.001) << "seconds";
        EXPECT_LT(std::abs(bundle.camera(i) - truth.camera(i)), 4.5 * std::sqrt(result.covariance(i, i))) << i;
    }
}

Eigen::Isometry3d moved(const Eigen::Isometry3d& T, double metres, double radians) {
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.translation() = metres * Eigen::Vector3d(0.6, -0.3, 0.7);
    motion.linear() = Eigen::AngleAxisd(radians, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
    return motion * T;
}

double angle(const Eigen::Isometry3d& T) { return Eigen::AngleAxisd(T.linear()).angle(); }

TEST(BundleAdjustment, StepsPlaceKeyframesThatShareNoLandmark) {
    const SyntheticBundle truth{.keyframes = 12, .points = 60};
    Bundle bundle = truth.make(truth.camera);
    // the second half sees other landmarks than the first
    std::erase_if(bundle.observations, [](const Observation& o) { return (o.keyframe < 6) != (o.landmark < 30); });
    const std::vector<Eigen::Isometry3d> poses = bundle.T_camera_world;
    for (std::uint32_t k = 1; k < poses.size(); ++k)
        bundle.steps.push_back({k - 1, k, poses[k] * poses[k - 1].inverse(), 0.01, 0.005});
    for (std::size_t k = 1; k < poses.size(); ++k) bundle.T_camera_world[k] = moved(poses[k], 0.03, 0.02);
    adjust(bundle, truth.camera, {.intrinsics = false, .deformation = false});
    for (std::size_t k = 0; k < poses.size(); ++k) {
        const Eigen::Isometry3d off = bundle.T_camera_world[k] * poses[k].inverse();
        EXPECT_LT(off.translation().norm(), 0.004) << k;
        EXPECT_LT(angle(off), 0.002) << k;
    }
}

TEST(BundleAdjustment, OneMoreFrameIsPlacedByKnownLandmarks) {
    for (const bool rolls : {false, true}) {
        SyntheticBundle truth;
        truth.rolls = rolls;
        if (rolls) times_part(truth.camera) << 0.009, 0.03, 0.026;
        Bundle bundle = truth.make(truth.camera);
        std::vector<Observation> seen;
        for (const Observation& o : bundle.observations)
            if (o.keyframe == 3) seen.push_back(o);
        for (std::size_t i = 0; i < seen.size(); i += 10) seen[i].pixel.y() += 20;  // not all of them right
        const FrameReadout readout = rolls ? bundle.readouts[3] : FrameReadout{};
        const ExpectedPose expected{moved(bundle.T_camera_world[3], 0.03, 0.02), 0.03, 0.02};
        const auto placed = fit_pose(bundle, seen, readout, expected);
        ASSERT_TRUE(placed.has_value());
        const Eigen::Isometry3d off = *placed * bundle.T_camera_world[3].inverse();
        EXPECT_LT(off.translation().norm(), 0.001);
        EXPECT_LT(angle(off), 0.0005);
        seen.resize(5);
        EXPECT_FALSE(fit_pose(bundle, seen, readout, expected).has_value()) << "too few";
    }
}

/// The first frame of a recording: what came before it was not seen, but its rows were read while the camera moved.
TEST(BundleAdjustment, RowsTellTheMotionThatNoFrameTells) {
    SyntheticBundle truth;
    truth.rolls = true;
    times_part(truth.camera) << 0.009, 0.03, 0.026;
    const Bundle bundle = truth.make(truth.camera);
    std::vector<Observation> seen;
    for (const Observation& o : bundle.observations)
        if (o.keyframe == 3) seen.push_back(o);
    using Side = ReadoutMotion::Side;
    for (const Side side : {Side::Before, Side::After}) {
        ReadoutMotion::Vector6d wrong;
        wrong << 0.2, -0.1, 0.1, 0.3, 0.3, -0.2;
        FrameReadout readout = bundle.readouts[3];
        readout.motion = readout.motion.faster(side, wrong);
        const auto error = [&] {
            const auto placed = fit_pose(bundle, seen, readout, {bundle.T_camera_world[3], 0.1, 0.1});
            const Eigen::Isometry3d off = placed.value() * bundle.T_camera_world[3].inverse();
            return std::hypot(off.translation().norm(), angle(off));
        };
        const double believed = error();
        readout.unknown = side;
        EXPECT_LT(error(), 0.5 * believed);
    }
}

TEST(ReadoutMotion, GoesSmoothlyOrStraightFromFrameToFrame) {
    const auto at = [](double metres) { return Eigen::Isometry3d(Eigen::Translation3d(metres, 0, 0)); };
    // it stops at the stamp
    const std::array<ReadoutMotion::Neighbour, 3> neighbours{{{-0.06, at(-0.12)}, {-0.03, at(-0.06)}, {0.03, at(0)}}};
    const ReadoutMotion straight(neighbours, Way::Straight), smooth(neighbours);
    EXPECT_NEAR(straight.at(-0.015).translation().x(), -0.03, 1e-12);
    EXPECT_NEAR(straight.at(0.015).translation().x(), 0, 1e-12);
    EXPECT_NEAR(smooth.at(-0.03).translation().x(), -0.06, 1e-12);
    EXPECT_GT(smooth.at(0.015).translation().x(), 0.005) << "it goes on for a while";
    const Eigen::Vector3d point(0.1, 0.2, 2);
    constexpr double h = 1e-6;
    for (const double t : {-0.01, 0.01}) {
        const Eigen::Vector3d slope = (straight.seen(point, t + h).point - straight.seen(point, t - h).point) / (2 * h);
        EXPECT_LT((straight.seen(point, t).by_time - slope).norm(), 1e-6);
    }
    const std::array<ReadoutMotion::Neighbour, 1> last{{{-0.03, at(-0.06)}}};
    EXPECT_NEAR(ReadoutMotion(last, Way::Straight).at(0.015).translation().x(), 0.03, 1e-12) << "it goes on";
}

TEST(BundleAdjustment, OutliersDoNotMatter) {
    const SyntheticBundle truth;
    Bundle bundle = truth.make(truth.camera);
    for (std::size_t i = 0; i < bundle.observations.size(); i += 20) bundle.observations[i].pixel.x() += 15;
    for (std::size_t i = 7; i < bundle.observations.size(); i += 20) bundle.observations[i].inverse_depth += 0.3;
    adjust(bundle, truth.camera, {});
    EXPECT_NEAR(bundle.camera(0), truth.camera(0), 0.001 * truth.camera(0));
    EXPECT_NEAR(bundle.camera(2), truth.camera(2), 0.5);
}

TEST(BundleAdjustment, ACameraThatStandsStillSaysNothingOfItself) {
    SyntheticBundle truth;
    truth.step = 0;
    CameraParameters given = truth.camera;
    given(0) *= 1.006, given(1) *= 1.006;
    Bundle bundle = truth.make(given);
    const BundleResult result = adjust(bundle, given, {});
    const CameraParameters sigmas = prior_sigmas(given, bundle.width);
    for (int i = 0; i < kIntrinsicParameters; ++i) {
        EXPECT_NEAR(bundle.camera(i), given(i), 0.1 * sigmas(i)) << i;
        EXPECT_GT(std::sqrt(result.covariance(i, i)), 0.95 * sigmas(i)) << i;
    }
}

}  // namespace
}  // namespace posefusion
