#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "tests/engine/support/tracking_reference.hpp"

// Begin, solve and end of tracking: small kernels that decide about the pose. (The reductions: jacobian_test.cpp.)
namespace posefusion::test {
namespace {

using gpu::DispatchArguments;
using gpu::TrackingRecord;

constexpr std::uint32_t kGroups = 5, kSlot = gpu::FIRST_LEVEL_SLOT + gpu::SLOTS_PER_LEVEL;  // of level 1

/// Rows whose sums are `sums`, spread over kGroups groups of different numbers of rows; the unused rows are NaN.
struct Rows {
    std::vector<float> rows;
    std::vector<std::uint32_t> counts = {1, 8, 16, 4, 64};

    explicit Rows(const std::vector<double>& sums, std::size_t columns = gpu::REDUCTION_COLUMNS)
        : rows(kGroups * gpu::REDUCTION_MAX_ROWS * columns, std::numeric_limits<float>::quiet_NaN()) {
        const double share = 1.0 / (1 + 8 + 16 + 4 + 64);
        for (std::size_t g = 0; g < kGroups; ++g) {
            for (std::size_t r = 0; r < counts[g]; ++r) {
                for (std::size_t k = 0; k < columns; ++k) {
                    const bool count = k == gpu::COLUMN_ICP_COUNT || k == gpu::COLUMN_PHOTOMETRIC_COUNT ||
                                       k == gpu::COLUMN_LIVE;  // whole numbers, all in one row
                    const double part = count ? (g == 3 && r == 2 ? 1.0 : 0.0) : share;
                    rows[(g * gpu::REDUCTION_MAX_ROWS + r) * columns + k] =
                        k < sums.size() ? static_cast<float>(sums[k] * part) : 0.0f;
                }
            }
        }
    }
};

std::vector<DispatchArguments> running_arguments() {
    return std::vector<DispatchArguments>(gpu::TRACKING_SLOTS, {7, 1, 1});
}

/// Slots that were stopped, as a bit each.
std::uint32_t stopped(const std::vector<DispatchArguments>& arguments) {
    std::uint32_t bits = 0;
    for (std::uint32_t i = 0; i < gpu::TRACKING_SLOTS; ++i) bits |= (arguments[i].x == 0 ? 1u : 0u) << i;
    return bits;
}

class TrackingKernel : public DeviceTest {
protected:
    gpu::Params params = make_params(test_cameras()[0]);
    Random random{41};

    /// A system like those of tracking: positive definite, translation and rotation on different scales.
    [[nodiscard]] Matrix6d system() {
        Matrix6d A = Matrix6d::Zero();
        for (int k = 0; k < 40; ++k) {
            Vector6d J;
            J << random.direction(), 2.0 * random.direction();
            A += 1e5 * J * J.transpose();
        }
        return A;
    }
    [[nodiscard]] static std::vector<double> sums_of(const Matrix6d& A, const Vector6d& g, double inliers = 1000) {
        std::vector<double> sums;
        for (int i = 0; i < 6; ++i) {
            for (int j = i; j < 6; ++j) sums.push_back(A(i, j));
        }
        for (int i = 0; i < 6; ++i) sums.push_back(g(i));
        // |r| / sigma, count, r^2; |r|, count, r^2; live pixels; live and model intensity
        for (const double s : {900.0, inliers, 0.016, 6.0, 400.0, 0.25, 1500.0, 160.0, 176.0}) sums.push_back(s);
        return sums;
    }
    struct Solved {
        TrackingRecord record;
        std::uint32_t stopped;
    };
    [[nodiscard]] Solved solve(const std::vector<double>& sums, const TrackingRecord& record) const {
        const Rows rows(sums);
        Launch launch("tracking/track_solve");
        launch.input("params", params).input("rows", rows.rows).input("row_counts", rows.counts);
        launch.inout("record", record).inout("arguments", running_arguments());
        launch.run(1, {{"groups", kGroups}, {"slot", kSlot}, {"step", 1}});
        return {launch.read<TrackingRecord>("record")[0], stopped(launch.read<DispatchArguments>("arguments"))};
    }
    [[nodiscard]] Solved so3_solve(const std::vector<double>& sums, const TrackingRecord& record) const {
        const Rows rows(sums);
        Launch launch("tracking/so3_solve");
        launch.input("rows", rows.rows).input("row_counts", rows.counts);
        launch.inout("record", record).inout("arguments", running_arguments());
        launch.run(1, {{"groups", kGroups}, {"slot", kSlot}});
        return {launch.read<TrackingRecord>("record")[0], stopped(launch.read<DispatchArguments>("arguments"))};
    }
    [[nodiscard]] TrackingRecord end(const TrackingRecord& record) const {
        Launch launch("tracking/track_end");
        launch.input("params", params).inout("record", record).run(1);
        return launch.read<TrackingRecord>("record")[0];
    }
};

void expect_pose(const gpu::Pose& actual, const Isometry3d& expected, double tolerance) {
    EXPECT_LT((from_device(actual).matrix() - expected.matrix()).cwiseAbs().maxCoeff(), tolerance)
        << from_device(actual).matrix() << "\nexpected\n"
        << expected.matrix();
}

constexpr std::uint32_t kThisLevelStopped = 3u << kSlot;

/// Residuals of pixels of a rolling shutter, and what track_reduce with TURN makes of them.
struct TurnSystem {
    std::vector<double> sums;

    /// @param turn, acceleration  what the camera turns more than it is thought to, about the axes of the model's
    /// camera
    TurnSystem(Random& random, const Vector6d& step, const Vector3d& turn, const Vector3d& acceleration) {
        Eigen::Matrix<double, 12, 12> H = Eigen::Matrix<double, 12, 12>::Zero();
        Eigen::Matrix<double, 12, 1> g = Eigen::Matrix<double, 12, 1>::Zero(), wanted;
        wanted << step, turn, acceleration;
        for (int k = 0; k < 400; ++k) {
            const double time = random.uniform(-0.02, 0.015);
            Eigen::Matrix<double, 12, 1> J;
            J << random.direction(), 2.0 * random.direction(), Vector6d::Zero();
            J.segment<3>(6) = time * J.segment<3>(3);
            J.tail<3>() = 0.5 * time * J.segment<3>(6);
            H += 1e9 * J * J.transpose();
            g -= 1e9 * J * J.dot(wanted);
        }
        const auto block = [&](int row, int column, int rows, double factor) {
            for (int i = 0; i < rows; ++i)
                for (int j = 0; j < 3; ++j) sums.push_back(factor * H(row + i, column + j));
        };
        const auto triangle = [&](int row, int column, int n, double factor) {
            for (int i = 0; i < n; ++i)
                for (int j = i; j < n; ++j) sums.push_back(factor * H(row + i, column + j));
        };
        triangle(0, 0, 6, 1);
        for (int i = 0; i < 6; ++i) sums.push_back(g(i));
        sums.resize(gpu::COLUMN_POSE_TURN);
        block(0, 6, 6, 1);
        triangle(6, 6, 3, 1);
        for (int i = 0; i < 3; ++i) sums.push_back(g(6 + i));
        block(0, 9, 3, 2);
        triangle(6, 9, 3, 2);
        triangle(9, 9, 3, 4);
        for (int i = 0; i < 3; ++i) sums.push_back(2 * g(9 + i));
    }
};

TEST_F(TrackingKernel, TurnSolveFindsThePoseTheTurnAndItsAcceleration) {
    Vector6d step;
    step << 0.01, -0.004, 0.006, 0.005, -0.007, 0.003;
    const Vector3d turn(0.3, -0.5, 0.2), acceleration(20, -30, 10);
    const TurnSystem system(random, step, turn, acceleration);
    ASSERT_EQ(system.sums.size(), gpu::TURN_COLUMNS);
    params.interval = 1.0f / 30;
    const auto start = motion({0.01, 0.02, -0.01}, {1, -1, 2}, 3);
    auto record = tracking_record(start);
    record.expected_motion.rotation = {0.1f, 0.2f, 0.3f, 0};
    record.turn_bias = {0.02f, 0.01f, -0.03f, 0};
    record.acceleration_bias = {1, -2, 3, 0};
    const auto solve = [&](std::uint32_t last) {
        const Rows rows(system.sums, gpu::TURN_COLUMNS);
        Launch launch("tracking/turn_solve");
        launch.input("params", params).input("rows", rows.rows).input("row_counts", rows.counts);
        launch.inout("record", record).run(1, {{"groups", kGroups}, {"last", last}});
        return launch.read<TrackingRecord>("record")[0];
    };
    // so many and so exact pixels that what is believed before hardly counts
    const auto before_last = solve(0);
    const Eigen::Matrix3d to_live = start.linear().transpose();
    const Vector3d offset = to_live * (turn - 30 * step.tail<3>()), faster = to_live * acceleration;
    expect_pose(before_last.model_live, exp_pose(step.head<3>(), step.tail<3>()) * start, 1e-5);
    EXPECT_LT((xyz(before_last.turn_offset) - offset).norm(), 0.002 * offset.norm());
    EXPECT_LT((xyz(before_last.turn_acceleration) - faster).norm(), 0.01 * faster.norm());
    EXPECT_EQ(before_last.turn_bias, record.turn_bias) << "only the last step changes what is believed of the map";

    const auto last = solve(1);
    const Vector3d believed = xyz(before_last.turn_offset) - xyz(record.turn_bias);
    EXPECT_LT((xyz(last.turn_offset) - believed).norm(), 1e-5);
    EXPECT_LT((xyz(last.turn_bias) - xyz(record.turn_bias) - gpu::TURN_BIAS_SHARE * believed).norm(), 1e-5);
    const Vector3d faster_believed = xyz(before_last.turn_acceleration) - xyz(record.acceleration_bias);
    EXPECT_LT((xyz(last.turn_acceleration) - faster_believed).norm(), 1e-4);
    const Eigen::AngleAxisd between(from_device(last.model_live).linear());
    const Vector3d turning = 30 * between.angle() * between.axis() + xyz(last.turn_offset);
    EXPECT_LT((xyz(last.motion_error.rotation) - turning + xyz(record.expected_motion.rotation)).norm(), 1e-4);
}

TEST_F(TrackingKernel, BeginTakesTheLastPoseAsModelPoseAndStartsEveryIteration) {
    auto record = tracking_record(motion({1, 2, 3}, {1, 0, 0}, 5));
    const auto last = motion({0.4, -0.1, 2}, {1, 1, 0}, 33);
    record.world_live = to_device(last);
    record.failed = 1, record.iterations = 9, record.icp_inliers = 8, record.photometric_inliers = 7,
    record.valid_pixels = 6;
    Launch launch("tracking/track_begin");
    launch.inout("record", record).output<DispatchArguments>("arguments", gpu::TRACKING_SLOTS);
    launch.run(1, {{"so3_groups", 3}, {"level_groups[0]", 19}, {"level_groups[1]", 5}, {"level_groups[2]", 2}});
    const auto result = launch.read<TrackingRecord>("record")[0];
    expect_pose(result.world_model, last, 1e-6);
    for (const auto* pose : {&result.model_live, &result.so3, &result.so3_best})
        expect_pose(*pose, Isometry3d::Identity(), 1e-9);
    EXPECT_EQ(result.failed + result.iterations + result.icp_inliers + result.photometric_inliers + result.valid_pixels,
              0u);
    const auto arguments = launch.read<DispatchArguments>("arguments");
    const std::uint32_t groups[gpu::START_SLOT] = {3, 1, 19, 1, 5,
                                                   1, 2, 1};  // pairs of reduce and solve: SO(3), then levels 0, 1, 2
    for (std::uint32_t i = 0; i < gpu::START_SLOT; ++i) {
        EXPECT_EQ(arguments[i].x, groups[i]);
        EXPECT_EQ(arguments[i].y, 1u);
        EXPECT_EQ(arguments[i].z, 1u);
    }
}

TEST_F(TrackingKernel, SolveMakesTheGaussNewtonStep) {
    for (int round = 0; round < 5; ++round) {
        const Matrix6d A = system();
        Vector6d step;
        step << 0.01 * random.direction(), 0.008 * random.direction();
        const auto start = motion(0.02 * random.direction(), random.direction(), 1.0);
        const auto result = solve(sums_of(A, -A * step), tracking_record(start));
        // the right-hand side is a float of relative rounding 6e-8; the condition of the scaled system is below 100
        expect_pose(result.record.model_live, exp_pose(step.head<3>(), step.tail<3>()) * start, 2e-6);
        EXPECT_EQ(result.stopped, 0u);
        EXPECT_EQ(result.record.iterations, 1u);
        EXPECT_EQ(result.record.icp_inliers, 1000u);
        EXPECT_EQ(result.record.photometric_inliers, 400u);
        EXPECT_EQ(result.record.valid_pixels, 1500u);
        EXPECT_NEAR(result.record.icp_rmse, 0.004, 1e-6);
        EXPECT_NEAR(result.record.photometric_rmse, 0.025, 1e-6);
        EXPECT_NEAR(result.record.icp_scale, gpu::SIGMA_PER_MEAN_ABS * 0.9, 1e-4);
        EXPECT_NEAR(result.record.photometric_scale, gpu::SIGMA_PER_MEAN_ABS * 0.015, 1e-5);
        EXPECT_NEAR(result.record.photometric_gain, 1.1, 1e-6);
        int k = 0;
        for (int i = 0; i < 6; ++i) {
            for (int j = i; j < 6; ++j)
                EXPECT_NEAR(result.record.hessian[k++], A(i, j), 1e-5 * std::sqrt(A(i, i) * A(j, j)));
        }
    }
}

TEST_F(TrackingKernel, SolveWeighsTheStepAgainstWhatIsExpected) {
    const Matrix6d A = system();
    Vector6d step;
    step << 0.01 * random.direction(), 0.008 * random.direction();
    const Vector3d middle(0.3, -0.2, 2);
    params.prior_share = 0.05f, params.prior_floor = 2e3f, params.prior_radius = 0.4f;
    params.prior_x = 0.3f, params.prior_y = -0.2f, params.prior_z = 2;
    const auto start = motion(0.02 * random.direction(), random.direction(), 1.0);
    const auto result = solve(sums_of(A, -A * step), tracking_record(start));
    const double weight = 0.05 * A.diagonal().head<3>().mean() + 2e3;
    Eigen::Matrix<double, 3, 6> J;
    J << Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Zero();
    for (int axis = 0; axis < 3; ++axis) J.row(axis).tail<3>() = middle.cross(Vector3d::Unit(axis)).transpose();
    Matrix6d H = A + weight * J.transpose() * J;
    H.bottomRightCorner<3, 3>() += weight * 0.16 * Eigen::Matrix3d::Identity();
    const Eigen::AngleAxisd turn(start.linear());
    Vector6d g = A * step - weight * J.transpose() * (start * middle - middle);
    g.tail<3>() -= weight * 0.16 * turn.angle() * turn.axis();
    const Vector6d x = H.ldlt().solve(g);
    EXPECT_GT((x - step).norm(), 1e-3) << "it counts";
    expect_pose(result.record.model_live, exp_pose(x.head<3>(), x.tail<3>()) * start, 5e-6);
    for (int i = 0, k = 0; i < 6; ++i)
        for (int j = i; j < 6; ++j)
            EXPECT_NEAR(result.record.hessian[k++], A(i, j), 1e-5 * std::sqrt(A(i, i) * A(j, j)))
                << "what the image says, alone";
}

TEST_F(TrackingKernel, SolveGoesOnWhereTheImageDoesNotFixTheShift) {
    const Vector3d wall = random.direction();  // its normal: along it the image says a thousandth
    Matrix6d seen = Matrix6d::Identity();
    seen.topLeftCorner<3, 3>() = 0.03 * Eigen::Matrix3d::Identity() + 0.97 * wall * wall.transpose();
    const Matrix6d A = seen * system() * seen;
    Vector6d step;
    step << 0.01 * random.direction(), 0.008 * random.direction();
    const auto start = motion(0.02 * random.direction(), random.direction(), 1.0);
    auto record = tracking_record(start);
    const Vector3d speed = 0.4 * random.direction(), turn_speed = 0.5 * random.direction();
    record.expected_motion = {
        {static_cast<float>(speed.x()), static_cast<float>(speed.y()), static_cast<float>(speed.z()), 1},
        {static_cast<float>(turn_speed.x()), static_cast<float>(turn_speed.y()), static_cast<float>(turn_speed.z()),
         0}};
    params.interval = 0.04f, params.steady_floor = 2e3f, params.steady_share = 0.05f, params.steady_enough = 0.1f;
    constexpr double kRecognised = 1400;  // of 1500 pixels
    const auto result = solve(sums_of(A, -A * step, kRecognised), record);

    const Vector3d expected = 0.04 * speed + 0.5 * (0.04 * turn_speed).cross(0.04 * speed);
    const double mean = A.diagonal().head<3>().mean();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> directions(A.topLeftCorner<3, 3>());
    Vector3d weights;
    for (int k = 0; k < 3; ++k)
        weights[k] = (2e3 + 0.05 * mean) / std::pow(1 + directions.eigenvalues()[k] / (0.1 * mean), 2);
    EXPECT_GT(weights[0], 20 * weights[2]) << "it counts along the wall, and hardly towards it";
    const Eigen::Matrix3d weight =
        directions.eigenvectors() * weights.asDiagonal() * directions.eigenvectors().transpose();
    Matrix6d H = A;
    H.topLeftCorner<3, 3>() += weight;
    Vector6d g = A * step;
    g.head<3>() -= weight * (start.translation() - expected);
    const Vector6d x = H.ldlt().solve(g);
    EXPECT_GT((x - step).norm(), 1e-3) << "it counts";
    expect_pose(result.record.model_live, exp_pose(x.head<3>(), x.tail<3>()) * start, 5e-6);

    // of such a system the damping of its solution takes a part in a thousand
    const Isometry3d plain = exp_pose(step.head<3>(), step.tail<3>()) * start;
    expect_pose(solve(sums_of(A, -A * step), record).record.model_live, plain, 5e-5);  // another surface
    record.expected_motion.translation.w = 0;                                          // nothing is known
    expect_pose(solve(sums_of(A, -A * step, kRecognised), record).record.model_live, plain, 5e-5);
}

TEST_F(TrackingKernel, SolveStopsTheLevelWhenTheStepIsSmall) {
    const Matrix6d A = system();
    const double least = 0.5 * std::min(params.converged_translation, params.converged_rotation);
    Vector6d step;
    step << least * random.direction(), least * random.direction();
    EXPECT_EQ(solve(sums_of(A, -A * step), tracking_record(Isometry3d::Identity())).stopped, kThisLevelStopped);
    // either part alone above its threshold keeps the level going
    step << 2.0 * static_cast<double>(params.converged_translation) * random.direction(), Vector3d::Zero();
    EXPECT_EQ(solve(sums_of(A, -A * step), tracking_record(Isometry3d::Identity())).stopped, 0u);
    step << Vector3d::Zero(), 2.0 * static_cast<double>(params.converged_rotation) * random.direction();
    EXPECT_EQ(solve(sums_of(A, -A * step), tracking_record(Isometry3d::Identity())).stopped, 0u);
}

TEST_F(TrackingKernel, SolveLeavesThePoseWhenThereIsNothingToSolve) {
    const auto start = motion({0.01, 0.02, 0.03}, {1, 2, 3}, 1.5);
    Matrix6d indefinite = system();
    indefinite(2, 2) = -1;
    Matrix6d not_finite = system();
    not_finite(1, 1) = std::numeric_limits<double>::quiet_NaN();
    for (const Matrix6d& A : {Matrix6d(Matrix6d::Zero()), indefinite, not_finite}) {
        const auto result = solve(sums_of(A, Vector6d::Ones()), tracking_record(start));
        expect_pose(result.record.model_live, start, 1e-6);
        EXPECT_EQ(result.stopped, kThisLevelStopped);
    }
}

TEST_F(TrackingKernel, SolveHardlyMovesAlongADirectionThatNothingConstrains) {
    // a lone wall: sliding along it and turning about its normal are free; noise of the sums must not blow up
    Matrix6d A = Matrix6d::Zero();
    for (int k = 0; k < 60; ++k) {
        const Vector3d q(random.uniform(-1, 1), random.uniform(-1, 1), 2), n(0, 0, -1);
        Vector6d J;
        J << n, q.cross(n);
        A += 1e6 * J * J.transpose();
    }
    A.diagonal().array() += 1e-3;
    Vector6d step = Vector6d::Zero();
    step(2) = 0.01;
    const auto result = solve(sums_of(A, -A * step), tracking_record(Isometry3d::Identity()));
    expect_pose(result.record.model_live, exp_pose(step.head<3>(), step.tail<3>()), 1e-4);
}

TEST_F(TrackingKernel, SolveKeepsTheScalesWithinReason) {
    auto sums = sums_of(system(), Vector6d::Zero());
    sums[gpu::COLUMN_ICP_ABS] = 1e5, sums[gpu::COLUMN_PHOTOMETRIC_ABS] = 1e4;
    auto result = solve(sums, tracking_record(Isometry3d::Identity()));
    EXPECT_EQ(result.record.icp_scale, gpu::MAX_ICP_SCALE);
    EXPECT_EQ(result.record.photometric_scale, gpu::MAX_PHOTOMETRIC_SCALE);
    sums[gpu::COLUMN_ICP_ABS] = 0, sums[gpu::COLUMN_PHOTOMETRIC_ABS] = 0;
    result = solve(sums, tracking_record(Isometry3d::Identity()));
    EXPECT_EQ(result.record.icp_scale, gpu::MIN_ICP_SCALE);
    EXPECT_EQ(result.record.photometric_scale, gpu::MIN_PHOTOMETRIC_SCALE);
    // no inlier of either kind: the scales stay
    sums[gpu::COLUMN_ICP_COUNT] = 0, sums[gpu::COLUMN_PHOTOMETRIC_COUNT] = 0;
    const auto before = tracking_record(Isometry3d::Identity());
    result = solve(sums, before);
    EXPECT_EQ(result.record.icp_scale, before.icp_scale);
    EXPECT_EQ(result.record.photometric_scale, before.photometric_scale);
    EXPECT_EQ(result.record.photometric_gain, before.photometric_gain);
}

// ------------------------------------------------------------------------------------------------------ pre-alignment

std::vector<double> so3_sums(const Eigen::Matrix3d& A, const Vector3d& g, double squares, double count) {
    return {A(0, 0), A(0, 1), A(0, 2), A(1, 1), A(1, 2), A(2, 2), g(0), g(1), g(2), squares, count};
}

TEST_F(TrackingKernel, PreAlignmentStepsWhileTheErrorFalls) {
    const Eigen::Matrix3d A = Vector3d(400, 700, 90).asDiagonal().toDenseMatrix() + Eigen::Matrix3d::Constant(20);
    const Vector3d step(0.01, -0.004, 0.02);
    auto record = tracking_record(Isometry3d::Identity());
    const auto current = motion(Vector3d::Zero(), {0, 1, 0}, 2);
    record.so3 = to_device(current);
    record.so3_error = 0.1f;
    const auto result = so3_solve(so3_sums(A, -A * step, 0.0025 * 1000, 1000), record);
    EXPECT_NEAR(result.record.so3_error, 0.05, 1e-6);
    expect_pose(result.record.so3_best, current, 1e-6);
    expect_pose(result.record.so3, exp_pose(Vector3d::Zero(), step) * current, 2e-6);
    EXPECT_EQ(result.stopped, 0u);
}

TEST_F(TrackingKernel, PreAlignmentKeepsTheBestWhenTheErrorRises) {
    auto record = tracking_record(Isometry3d::Identity());
    const auto best = motion(Vector3d::Zero(), {1, 0, 0}, 1), worse = motion(Vector3d::Zero(), {0, 1, 0}, 2);
    record.so3_best = to_device(best);
    record.so3 = to_device(worse);
    record.so3_error = 0.05f;
    const auto result =
        so3_solve(so3_sums(Eigen::Matrix3d::Identity() * 100, Vector3d::Ones(), 0.01 * 1000, 1000), record);
    expect_pose(result.record.so3_best, best, 1e-6);
    EXPECT_EQ(result.stopped, kThisLevelStopped);
}

TEST_F(TrackingKernel, PreAlignmentStopsWithoutTextureOrPixels) {
    auto record = tracking_record(Isometry3d::Identity());
    EXPECT_EQ(so3_solve(so3_sums(Eigen::Matrix3d::Zero(), Vector3d::Zero(), 0, 1000), record).stopped,
              kThisLevelStopped);
    EXPECT_EQ(so3_solve(so3_sums(Eigen::Matrix3d::Identity(), Vector3d::Ones(), 1e-6, 3), record).stopped,
              kThisLevelStopped);
    EXPECT_EQ(so3_solve(so3_sums(Eigen::Matrix3d::Zero(), Vector3d::Zero(), 0, 0), record).stopped, kThisLevelStopped);
}

// ---------------------------------------------------------------------------------------------------------------- end

// ---- choose a start

class ChooseStart : public TrackingKernel {
protected:
    const Isometry3d own = motion({0.01, 0, 0}, {0, 1, 0}, 0.2), other = motion({0.1, 0, 0}, {0, 1, 0}, 2);
    TrackingRecord record = tracking_record(own);
    gpu::StartRecord start{};

    ChooseStart() {
        record.so3_best = record.model_live;
        start.model_live = to_device(other);
        start.known = 1;
    }
    struct Chosen {
        TrackingRecord record;
        gpu::StartRecord start;
        std::uint32_t stopped;
    };
    [[nodiscard]] Chosen choose(std::uint32_t step, const std::vector<double>& sums) const {
        const Rows rows(sums);
        Launch launch("tracking/start_choose");
        launch.input("params", params).input("rows", rows.rows).input("row_counts", rows.counts);
        launch.inout("record", record).inout("start", start).inout("arguments", running_arguments());
        launch.run(1, {{"step", step}, {"groups", kGroups}});
        return {launch.read<TrackingRecord>("record")[0], launch.read<gpu::StartRecord>("start")[0],
                stopped(launch.read<DispatchArguments>("arguments"))};
    }
    /// Sums of a reduction. @param met  live pixels on a surface of the model, of 1000  @param sigmas  their residual
    /// @param shade  mean difference of intensity
    [[nodiscard]] static std::vector<double> sums(double met, double sigmas, double shade) {
        std::vector<double> sums(gpu::TRACK_COLUMNS, 0.0);
        sums[gpu::COLUMN_LIVE] = 1000;
        sums[gpu::COLUMN_ICP_COUNT] = met;
        sums[gpu::COLUMN_ICP_ABS] = met * sigmas;
        sums[gpu::COLUMN_PHOTOMETRIC_COUNT] = 400;
        sums[gpu::COLUMN_PHOTOMETRIC_ABS] = 400 * shade;
        return sums;
    }
    [[nodiscard]] static double cost(double met, double sigmas, double shade) {
        const double outliers = static_cast<double>(gpu::START_OUTLIER_SIGMAS) * (1000 - met);
        return (met * sigmas + outliers) / 1000 + shade / static_cast<double>(gpu::FIRST_PHOTOMETRIC_SCALE);
    }
    static constexpr std::uint32_t kComparison = 3u << gpu::START_SLOT;
};

TEST_F(ChooseStart, ComparesOnlyWhatIsFarApart) {
    EXPECT_EQ(choose(0, {}).stopped, 0u);
    const double near = 0.9 * static_cast<double>(gpu::MIN_START_PIXELS / params.fx);
    start.model_live = to_device(own * motion({0, 0, 0}, {0, 1, 0}, near * 57.2958));
    EXPECT_EQ(choose(0, {}).stopped, kComparison) << "tracking finds the one from the other";
    start.model_live =
        to_device(own * motion({1.2 * near * static_cast<double>(gpu::START_DEPTH), 0, 0}, {0, 1, 0}, 0));
    EXPECT_EQ(choose(0, {}).stopped, 0u);
    start.model_live = to_device(other);
    start.known = 0;
    EXPECT_EQ(choose(0, {}).stopped, kComparison) << "there is no other start";
}

TEST_F(ChooseStart, TakesTheOneWithTheLowerCost) {
    Chosen first = choose(1, sums(500, 3, 0.1));
    EXPECT_NEAR(first.start.own_cost, cost(500, 3, 0.1), 1e-3);
    expect_pose(first.record.model_live, other, 1e-6);
    record = first.record, start = first.start;

    const Chosen better = choose(2, sums(600, 3, 0.1));
    EXPECT_NEAR(better.start.cost, cost(600, 3, 0.1), 1e-3);
    EXPECT_EQ(better.start.used, 1u);
    expect_pose(better.record.model_live, other, 1e-6);

    EXPECT_EQ(choose(2, sums(500, 2.5, 0.1)).start.used, 1u) << "nearer to the surfaces";
    EXPECT_EQ(choose(2, sums(500, 3, 0.08)).start.used, 1u) << "more alike";
    for (const auto& worse : {sums(400, 3, 0.1), sums(500, 3.5, 0.1), sums(500, 3, 0.12), sums(0, 0, 0)}) {
        const Chosen kept = choose(2, worse);
        EXPECT_EQ(kept.start.used, 0u);
        expect_pose(kept.record.model_live, own, 1e-6);
    }
}

class TrackingEnd : public TrackingKernel {
protected:
    TrackingEnd() {
        record = tracking_record(step);
        record.world_model = to_device(model);
        record.world_live = to_device(model);
        record.valid_pixels = 15000;
        record.icp_inliers = record.photometric_inliers = 12000;
        record.icp_rmse = 0.01f;
        set_sigmas(0.001, 0.001);
    }
    /// An uncorrelated system of these standard deviations.
    void set_sigmas(double translation, double rotation) {
        int k = 0;
        for (int i = 0; i < 6; ++i) {
            for (int j = i; j < 6; ++j)
                record.hessian[k++] =
                    i == j ? static_cast<float>(1 / std::pow(i < 3 ? translation : rotation, 2)) : 0.0f;
        }
    }
    const Isometry3d model = motion({0.4, -0.1, 2}, {1, 1, 0}, 33),
                     step = motion({0.01, 0.002, -0.004}, {0, 1, 0}, 0.4);
    TrackingRecord record{};

    void expect_held(const TrackingRecord& result) const {
        EXPECT_EQ(result.failed, 1u);
        EXPECT_EQ(result.fusion_weight, 0.0f);
        expect_pose(result.world_live, model, 1e-6);
        expect_pose(result.model_live, Isometry3d::Identity(), 1e-9);
    }
};

TEST_F(TrackingEnd, MovesThePoseOn) {
    const auto result = end(record);
    EXPECT_EQ(result.failed, 0u);
    expect_pose(result.world_live, model * step, 2e-6);
    const double speed = std::max(step.translation().norm(), Eigen::AngleAxisd(step.linear()).angle());
    const double weight = 1 - speed / static_cast<double>(params.speed_scale);
    EXPECT_NEAR(result.fusion_weight, std::max<double>(weight, gpu::MIN_FUSION_WEIGHT), 1e-4);
}

TEST_F(TrackingEnd, WeighsAFastCameraHalf) {
    record.model_live = to_device(motion({0.2, 0, 0}, {0, 1, 0}, 0.1));
    EXPECT_EQ(end(record).fusion_weight, gpu::MIN_FUSION_WEIGHT);
    record.model_live = to_device(motion({0, 0, 0}, {0, 1, 0}, 20));
    EXPECT_EQ(end(record).fusion_weight, gpu::MIN_FUSION_WEIGHT);
    record.model_live = to_device(Isometry3d::Identity());
    EXPECT_EQ(end(record).fusion_weight, 1.0f);
}

TEST_F(TrackingEnd, OneTermWithEnoughInliersIsEnough) {
    record.icp_inliers = 0;
    EXPECT_EQ(end(record).failed, 0u);
    record.icp_inliers = 12000, record.photometric_inliers = 0;
    EXPECT_EQ(end(record).failed, 0u);
}

TEST_F(TrackingEnd, HoldsThePoseWithFewInliers) {
    record.icp_inliers = record.photometric_inliers = static_cast<std::uint32_t>(params.min_inlier_ratio * 15000) - 10;
    expect_held(end(record));
}

TEST_F(TrackingEnd, HoldsThePoseWhenTheViewDoesNotFixIt) {
    set_sigmas(1.1 * static_cast<double>(params.max_translation_sigma), 0.001);
    expect_held(end(record));
    set_sigmas(0.001, 1.1 * static_cast<double>(params.max_rotation_sigma));
    expect_held(end(record));
    set_sigmas(0.9 * static_cast<double>(params.max_translation_sigma),
               0.9 * static_cast<double>(params.max_rotation_sigma));
    EXPECT_EQ(end(record).failed, 0u);
    for (float& element : record.hessian) element = 0;  // a single wall without texture
    expect_held(end(record));
}

TEST_F(TrackingEnd, HoldsThePoseWhenSurfacesAgreeTooRoughly) {
    record.icp_rmse = 1.1f * params.max_icp_rmse;
    expect_held(end(record));
}

TEST_F(TrackingEnd, HoldsThePoseWhenHardlyAnyPixelIsLeft) {
    // all of the few live pixels agree, but they are too few to trust
    record.valid_pixels = record.icp_inliers = record.photometric_inliers = 100;
    expect_held(end(record));
    record.valid_pixels = record.icp_inliers = record.photometric_inliers = 0;
    expect_held(end(record));
}

TEST_F(TrackingEnd, HoldsThePoseAfterAnImplausibleStep) {
    record.model_live = to_device(motion({params.max_step_translation * 1.1f, 0, 0}, {0, 1, 0}, 0));
    expect_held(end(record));
    record.model_live = to_device(motion({0, 0, 0}, {0, 1, 0}, params.max_step_rotation * 1.1f * 57.2958f));
    expect_held(end(record));
}

TEST_F(TrackingEnd, HoldsThePoseWhenItIsNotFinite) {
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        record.model_live = to_device(step);
        record.model_live.row0.w = bad;
        expect_held(end(record));
        record.model_live = to_device(step);
        record.model_live.row2.y = bad;
        expect_held(end(record));
    }
}

}  // namespace
}  // namespace posefusion::test
