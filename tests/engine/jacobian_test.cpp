#include <cmath>

#include "tests/engine/support/tracking_reference.hpp"

// The Jacobians of the tracking kernels, against numeric differences of the residuals in double.
namespace posefusion::test {
namespace {

const char* const kComponent[] = {"translation x", "translation y", "translation z",
                                  "rotation x",    "rotation y",    "rotation z"};

const Isometry3d kMotion = motion({0.011, -0.007, 0.016}, {1, 2, -0.5}, 0.9);

// Points are kept in float: 2e-7 m of rounding on residuals of a few mm is 1e-4 of them; a pixel that is associated
// otherwise (a tie of rounding) changes the sums of 1e4 pixels by as much.
constexpr double kGradientTolerance = 4e-4, kHessianTolerance = 4e-4;

void expect_equal_sums(const TrackSums& actual, const TrackSums& expected) {
    for (int i = 0; i < 6; ++i) {
        EXPECT_NEAR(actual.g(i), expected.g(i), kGradientTolerance * expected.g_scale(i) + 1e-9) << kComponent[i];
        for (int j = 0; j < 6; ++j) {
            EXPECT_NEAR(actual.H(i, j), expected.H(i, j),
                        kHessianTolerance * std::sqrt(expected.H(i, i) * expected.H(j, j)) + 1e-9)
                << kComponent[i] << " with " << kComponent[j];
        }
    }
    const double ties = 2 + 2e-4 * expected.live_count;
    EXPECT_NEAR(actual.icp_count, expected.icp_count, ties);
    EXPECT_NEAR(actual.photometric_count, expected.photometric_count, ties);
    EXPECT_EQ(actual.live_count, expected.live_count);
    EXPECT_NEAR(actual.icp_abs, expected.icp_abs, 1e-3 * expected.icp_abs);
    EXPECT_NEAR(actual.icp_squares, expected.icp_squares, 1e-3 * expected.icp_squares);
    EXPECT_NEAR(actual.photometric_abs, expected.photometric_abs, 1e-3 * expected.photometric_abs);
    EXPECT_NEAR(actual.photometric_squares, expected.photometric_squares, 1e-3 * expected.photometric_squares);
    EXPECT_NEAR(actual.live_intensity, expected.live_intensity, 1e-3 * expected.live_intensity);
    EXPECT_NEAR(actual.model_intensity, expected.model_intensity, 1e-3 * expected.model_intensity);
}

class Jacobian : public DeviceTest, public testing::WithParamInterface<std::size_t> {
protected:
    gpu::Params params = make_params(test_cameras()[GetParam()]);
    gpu::TrackingRecord record = tracking_record(kMotion);
};

INSTANTIATE_TEST_SUITE_P(Sizes, Jacobian, testing::Range(std::size_t{0}, test_cameras().size()), [](const auto& test) {
    const auto camera = test_cameras()[test.param];
    return std::to_string(camera.width) + "x" + std::to_string(camera.height);
});

TEST_P(Jacobian, OfTheGeometricTermIsTheDerivativeOfThePointToPlaneDistance) {
    params.photometric_weight = 0;
    for (const int level : {0, 1, 2}) {
        const auto images = wavy_pair(params, level, 31);
        const auto expected = reference_track_sums(params, level, record, images, Shade::Linearised);
        EXPECT_GT(expected.icp_count, 0.5 * expected.live_count);
        expect_equal_sums(kernel_track_sums(params, level, record, images), expected);
    }
}

TEST_P(Jacobian, OfThePhotometricTermIsTheDerivativeOfTheIntensity) {
    // where intensity is linear in the pixel every estimate of its gradient is exact, so the image itself is
    // differentiated
    params.icp_enabled = 0;
    params.min_gradient = 1e-4f;
    for (const int level : {0, 1, 2}) {
        const auto images = ramp_pair(params, level, 32);
        const auto expected = reference_track_sums(params, level, record, images, Shade::Image);
        EXPECT_GT(expected.photometric_count, 0.3 * expected.live_count);
        expect_equal_sums(kernel_track_sums(params, level, record, images), expected);
    }
}

TEST_P(Jacobian, OfBothTermsTogetherIsTheirSum) {
    for (const int level : {0, 1, 2}) {
        const auto images = wavy_pair(params, level, 33);
        expect_equal_sums(kernel_track_sums(params, level, record, images),
                          reference_track_sums(params, level, record, images, Shade::Linearised));
    }
}

TEST_P(Jacobian, WithARollingShutterEveryPixelIsSeenFromThePoseOfItsRow) {
    params.interval = 1.0f / 30;
    params.color_first_row = -0.015f;
    params.color_per_row = 0.03f / static_cast<float>(params.height);
    params.depth_first_row = -0.005f;
    params.depth_per_row = 0.02f / static_cast<float>(params.height);
    record.motion_error.translation = {0.3f, -0.2f, 0.25f, 0};
    record.motion_error.rotation = {0.4f, 0.9f, -0.6f, 0};
    record.turn_acceleration = {-15, 25, 10, 0};
    for (const int level : {0, 1, 2}) {
        const auto images = wavy_pair(params, level, 38);
        const auto expected = reference_track_sums(params, level, record, images, Shade::Linearised, 1, true);
        expect_equal_sums(kernel_track_sums(params, level, record, images, 1, true), expected);
        const auto global = kernel_track_sums(params, level, record, images);
        EXPECT_GT((global.g - expected.g).norm(), 0.02 * expected.g_scale.norm()) << "the motion makes a difference";
    }
}

TEST_P(Jacobian, OfTheTimesOfRowsIsTheDerivativeAlongTheMotionOfBothFrames) {
    params.stamp_row = 0.4f;
    params.interval = 1.0f / 30;
    params.color_first_row = -0.01f;
    params.color_per_row = 0.02f / static_cast<float>(params.height);
    record.motion_error.rotation = {0.1f, 0.2f, -0.1f, 0};
    record.last_motion = {{0.3f, -0.2f, 0.25f, 1}, {0.4f, 0.9f, -0.6f, 0}};
    record.expected_motion = {{-0.1f, 0.3f, 0.15f, 1}, {-0.7f, 0.3f, 0.5f, 0}};
    for (const int level : {0, 1, 2}) {
        const auto images = wavy_pair(params, level, 39);
        TimingSums expected, actual;
        const auto sums = reference_track_sums(params, level, record, images, Shade::Linearised, 1, true, &expected);
        expect_equal_sums(kernel_track_sums(params, level, record, images, 1, true, &actual), sums);
        for (int t = 0; t < 3; ++t) {
            EXPECT_NEAR(actual.gradient(t), expected.gradient(t), kGradientTolerance * expected.gradient_scale(t)) << t;
            for (int other = 0; other < 3; ++other)
                EXPECT_NEAR(actual.times(t, other), expected.times(t, other),
                            kHessianTolerance * std::sqrt(expected.times(t, t) * expected.times(other, other)))
                    << t << " with " << other;
            for (int i = 0; i < 6; ++i)
                EXPECT_NEAR(actual.both(i, t), expected.both(i, t),
                            kHessianTolerance * std::sqrt(sums.H(i, i) * expected.times(t, t)))
                    << kComponent[i] << " with " << t;
        }
    }
}

TEST_P(Jacobian, OfTheTurnAndItsAccelerationIsThatOfTheRotationByTheTimeOfTheRow) {
    params.interval = 1.0f / 30;
    params.color_first_row = -0.015f;
    params.color_per_row = 0.03f / static_cast<float>(params.height);
    params.depth_first_row = -0.005f;
    params.depth_per_row = 0.02f / static_cast<float>(params.height);
    record.motion_error.rotation = {0.1f, 0.2f, -0.1f, 0};
    record.turn_acceleration = {12, -20, 8, 0};
    for (const int level : {0, 1, 2}) {
        const auto images = wavy_pair(params, level, 40);
        TurnSums expected, actual;
        const auto sums =
            reference_track_sums(params, level, record, images, Shade::Linearised, 1, true, nullptr, &expected);
        expect_equal_sums(kernel_track_sums(params, level, record, images, 1, true, nullptr, &actual), sums);
        for (int t = 0; t < 6; ++t) {
            EXPECT_NEAR(actual.gradient(t), expected.gradient(t), kGradientTolerance * expected.gradient_scale(t)) << t;
            for (int other = 0; other < 6; ++other)
                EXPECT_NEAR(actual.turn(t, other), expected.turn(t, other),
                            kHessianTolerance * std::sqrt(expected.turn(t, t) * expected.turn(other, other)))
                    << t << " with " << other;
            for (int i = 0; i < 6; ++i)
                EXPECT_NEAR(actual.both(i, t), expected.both(i, t),
                            kHessianTolerance * std::sqrt(sums.H(i, i) * expected.turn(t, t)))
                    << kComponent[i] << " with " << t;
        }
    }
}

TEST_P(Jacobian, AtEverySecondPixelTheSumsAreThoseOfAChequerboard) {
    const auto images = wavy_pair(params, 0, 35);
    expect_equal_sums(kernel_track_sums(params, 0, record, images, 2),
                      reference_track_sums(params, 0, record, images, Shade::Linearised, 2));
}

TEST_P(Jacobian, OfASinglePixelHasTheRightSignInEveryComponent) {
    // with one live pixel the sums ARE w J J^T and w J r; the kernel's J follows from them
    const Camera c = camera_at(params, 1);
    const auto images = wavy_pair(params, 1, 34);
    int checked = 0;
    for (int i = c.width + 1; i < c.pixels() && checked < 12; i += c.pixels() / 29) {
        for (const bool geometric : {true, false}) {
            gpu::Params p = params;
            (geometric ? p.photometric_weight : p.icp_enabled) = 0;
            auto one = images;
            for (int k = 0; k < c.pixels(); ++k) {
                if (k != i) one.live_geometry[static_cast<std::size_t>(k)] = {};
            }
            const auto expected = reference_track_sums(p, 1, record, one, Shade::Linearised);
            if (expected.icp_count + expected.photometric_count < 1) continue;
            const auto actual = kernel_track_sums(p, 1, record, one);
            const double scale = expected.g.cwiseAbs().maxCoeff();
            for (int k = 0; k < 6; ++k)
                EXPECT_NEAR(actual.g(k), expected.g(k), 2e-3 * scale) << kComponent[k] << ", pixel " << i;
            ++checked;
        }
    }
    EXPECT_GE(checked, 4);
}

TEST_P(Jacobian, OfThePreAlignmentIsTheDerivativeUnderRotation) {
    for (const int level : {1, 2}) {
        record.so3 = to_device(motion(Vector3d::Zero(), {0.3, -1, 0.4}, 1.7));
        const auto ramp = ramp_pair(params, level, 35), wavy = wavy_pair(params, level, 36);
        for (const auto* images : {&ramp, &wavy}) {
            const auto expected =
                reference_so3_sums(params, level, record, images->live_photometric, images->model_photometric);
            const auto actual =
                kernel_so3_sums(params, level, record, images->live_photometric, images->model_photometric);
            EXPECT_GT(expected.count, 30);
            EXPECT_NEAR(actual.count, expected.count, 2);
            EXPECT_NEAR(actual.squares, expected.squares, 1e-3 * expected.squares);
            for (int i = 0; i < 3; ++i) {
                // a nearest pixel that rounds to its neighbour counts fully among few
                EXPECT_NEAR(actual.g(i), expected.g(i), 2e-3 * expected.g_scale(i)) << kComponent[3 + i];
                for (int j = 0; j < 3; ++j) {
                    EXPECT_NEAR(actual.H(i, j), expected.H(i, j),
                                1e-3 * std::sqrt(expected.H(i, i) * expected.H(j, j)));
                }
            }
        }
    }
}

TEST_P(Jacobian, SumsOfNothingAreZero) {
    const Camera c = camera_at(params, 0);
    ImagePair nothing;
    nothing.live_geometry = nothing.model_geometry = std::vector<gpu::vec4>(static_cast<std::size_t>(c.pixels()));
    nothing.live_photometric = nothing.model_photometric =
        std::vector<gpu::vec4>(static_cast<std::size_t>(c.pixels()), {-1, 0, 0, 0});
    const auto sums = kernel_track_sums(params, 0, record, nothing);
    EXPECT_EQ(sums.H.norm() + sums.g.norm(), 0.0);
    EXPECT_EQ(sums.icp_count + sums.photometric_count + sums.live_count, 0.0);
    EXPECT_EQ(kernel_so3_sums(params, 2, record, nothing.live_photometric, nothing.model_photometric).count, 0.0);
}

TEST_P(Jacobian, SumsStayFiniteForAPoseThatIsFarOff) {
    for (const auto& T :
         {motion({0, 0, -5}, {0, 1, 0}, 10), motion({3, 0, 0}, {0, 1, 0}, 180), motion({0, 0, -1.6}, {1, 0, 0}, 80)}) {
        record.model_live = record.so3 = to_device(T);
        const auto images = wavy_pair(params, 0, 37);
        const auto sums = kernel_track_sums(params, 0, record, images);
        EXPECT_TRUE(sums.H.allFinite() && sums.g.allFinite());
        const auto so3 = kernel_so3_sums(params, 0, record, images.live_photometric, images.model_photometric);
        EXPECT_TRUE(so3.H.allFinite() && so3.g.allFinite());
    }
}

}  // namespace
}  // namespace posefusion::test
