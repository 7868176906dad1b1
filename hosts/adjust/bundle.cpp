#include "hosts/adjust/bundle.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace posefusion {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kSquare = BundleConfig::kCauchy * BundleConfig::kCauchy;

double robust(double square) { return 0.5 * kSquare * std::log1p(square / kSquare); }
double weight(double square) { return 1 / (1 + square / kSquare); }

/// Position in the image and depth have separate weights: the depth of a corner at an edge may be wrong and its
/// position right.
struct Weights {
    double pixel, depth;
    explicit Weights(const Vector3d& e) : pixel(weight(e.head<2>().squaredNorm())), depth(weight(e.z() * e.z())) {}
    [[nodiscard]] Vector3d both() const { return {pixel, pixel, depth}; }
};

double cost_of_error(const ObservationError& e) {
    // behind the camera: as bad as far outside
    constexpr double kBehind = 1e6;
    if (!e.valid) return 2 * robust(kBehind);
    return robust(e.error.head<2>().squaredNorm()) + robust(e.error.z() * e.error.z());
}

Isometry3d moved(const Isometry3d& T, const Vector6d& x) {
    const double angle = x.tail<3>().norm();
    Isometry3d motion = Isometry3d::Identity();
    motion.translation() = x.head<3>();
    if (angle > 0) motion.linear() = Eigen::AngleAxisd(angle, x.tail<3>() / angle).toRotationMatrix();
    return motion * T;
}

/// The motion that is left between two poses: position and rotation.
Vector6d difference(const Isometry3d& to, const Isometry3d& from) {
    const Isometry3d E = to * from.inverse();
    const Eigen::AngleAxisd turn(E.linear());
    Vector6d error;
    error << E.translation(), turn.angle() * turn.axis();
    return error;
}

/// How far a step is from what is known of it: position and rotation in the later camera.
Vector6d error_of(const PoseStep& step, const std::vector<Isometry3d>& T_camera_world) {
    return difference(T_camera_world[step.to], step.T_to_from * T_camera_world[step.from]);
}

/// @param position, rotation  standard deviations per axis
Vector6d precision_of(double position, double rotation) {
    Vector6d P;
    P << Vector3d::Constant(1 / (position * position)), Vector3d::Constant(1 / (rotation * rotation));
    return P;
}

/// Precision of the prior: of each parameter, and of the bends of the deformation.
CameraMatrix prior_precision(const CameraParameters& given, int width, const BundleConfig& config) {
    CameraMatrix P = prior_sigmas(given, width).cwiseAbs2().cwiseInverse().asDiagonal();
    constexpr int kColumns = DepthDeformation::kColumns, kRows = DepthDeformation::kRows;
    const auto node = [](int row, int column) {
        return static_cast<Index>(kIntrinsicParameters) + static_cast<Index>(row) * kColumns + column;
    };
    const auto bend = [&](std::array<Index, 4> at, std::array<double, 4> factors) {
        for (std::size_t a = 0; a < 4; ++a)
            for (std::size_t b = 0; b < 4; ++b)
                P(at[a], at[b]) += factors[a] * factors[b] / (BundleConfig::kBendSigma * BundleConfig::kBendSigma);
    };
    for (int r = 0; r < kRows; ++r) {
        for (int c = 0; c < kColumns; ++c) {
            if (c + 2 < kColumns) bend({node(r, c), node(r, c + 1), node(r, c + 2), node(r, c)}, {1, -2, 1, 0});
            if (r + 2 < kRows) bend({node(r, c), node(r + 1, c), node(r + 2, c), node(r, c)}, {1, -2, 1, 0});
            if (c + 1 < kColumns && r + 1 < kRows)
                bend({node(r, c), node(r, c + 1), node(r + 1, c), node(r + 1, c + 1)}, {1, -1, -1, 1});
        }
    }
    constexpr double kFixed = 1e18;  // so sure that nothing is moved
    if (!config.intrinsics) intrinsics_part(P.diagonal()).setConstant(kFixed);
    if (!config.deformation) deformation_part(P.diagonal()).setConstant(kFixed);
    if (!config.times) times_part(P.diagonal()).setConstant(kFixed);
    return P;
}

/// The observations of each landmark are adjacent: calls `use(first, end)` for each.
template <class Use>
void for_each_landmark(const std::vector<Observation>& observations, Use&& use) {
    for (std::size_t first = 0; first < observations.size();) {
        std::size_t end = first;
        while (end < observations.size() && observations[end].landmark == observations[first].landmark) ++end;
        use(first, end);
        first = end;
    }
}

class Adjustment {
public:
    Adjustment(Bundle& bundle, const CameraParameters& given, const BundleConfig& config)
        : bundle_(bundle),
          given_(given),
          calibrate_(config.calibrate()),
          poses_(6 * (static_cast<Index>(bundle.T_camera_world.size()) - 1)),
          size_(poses_ + (calibrate_ ? kCameraParameters : 0)),
          prior_(prior_precision(given, bundle.width, config)) {}

    BundleResult run() {
        BundleResult result;
        double damping = 1e-4, cost = cost_of(bundle_);
        for (; result.steps < BundleConfig::kSteps; ++result.steps) {
            linearise();
            bool better = false;
            double decrease = 0;
            for (int attempt = 0; attempt < 8 && !better; ++attempt) {
                Bundle next = bundle_;
                if (!step(damping, next)) break;
                const double after = cost_of(next);
                better = after < cost;
                if (better) {
                    decrease = cost - after;
                    cost = after;
                    bundle_.T_camera_world = std::move(next.T_camera_world);
                    bundle_.landmarks = std::move(next.landmarks);
                    bundle_.camera = next.camera;
                }
                damping = std::clamp(damping * (better ? 0.2 : 8), 1e-9, 1e6);
            }
            if (!better || decrease < BundleConfig::kConverged * cost) break;
        }
        linearise();
        result.cost = cost;
        result.variance = variance();
        if (calibrate_) result.covariance = result.variance * camera_covariance();
        return result;
    }

private:
    [[nodiscard]] double cost_of(const Bundle& bundle) const {
        double cost = 0;
        for (const Observation& o : bundle.observations)
            cost +=
                cost_of_error(error_of(o, bundle.T_camera_world[o.keyframe] * bundle.landmarks[o.landmark], bundle));
        for (const PoseStep& step : bundle.steps)
            cost += 0.5 * precision_of(step.position_sigma, step.rotation_sigma)
                              .dot(error_of(step, bundle.T_camera_world).cwiseAbs2());
        const CameraParameters change = bundle.camera - given_;
        return cost + 0.5 * change.dot(prior_ * change);
    }

    /// Column of a keyframe's pose; negative for the first, which stays.
    [[nodiscard]] static Index column(std::uint32_t keyframe) { return 6 * (static_cast<Index>(keyframe) - 1); }

    /// The system of one landmark: its own part, and how it depends on poses and camera.
    struct LandmarkSystem {
        std::uint32_t landmark = 0;
        Matrix3d V = Matrix3d::Zero();
        Vector3d b = Vector3d::Zero();
        std::vector<Index> columns;  ///< of the poses and the camera's parameters that it depends on
        Eigen::Matrix<double, 3, Eigen::Dynamic> W;
    };

    void linearise() {
        H_ = MatrixXd::Zero(size_, size_);
        b_ = VectorXd::Zero(size_);
        systems_.clear();
        for_each_landmark(bundle_.observations, [&](std::size_t first, std::size_t end) { add_landmark(first, end); });
        for (const PoseStep& known : bundle_.steps) add_step(known);
        if (!calibrate_) return;
        H_.bottomRightCorner<kCameraParameters, kCameraParameters>() += prior_;
        b_.tail<kCameraParameters>() -= prior_ * (bundle_.camera - given_);
    }

    void add_step(const PoseStep& known) {
        const Vector6d error = error_of(known, bundle_.T_camera_world),
                       precision = precision_of(known.position_sigma, known.rotation_sigma);
        // the later pose moves the error as it moves itself, the earlier one by the adjoint of the step
        const Matrix3d R = known.T_to_from.linear();
        const Vector3d t = known.T_to_from.translation();
        Eigen::Matrix<double, 6, 6> by_from = Eigen::Matrix<double, 6, 6>::Zero();
        by_from.topLeftCorner<3, 3>() = by_from.bottomRightCorner<3, 3>() = -R;
        for (int i = 0; i < 3; ++i) by_from.block<3, 1>(0, 3 + i) = -t.cross(R.col(i));
        const Index from = column(known.from), to = column(known.to);
        const Eigen::Matrix<double, 6, 6> weighted = precision.asDiagonal() * by_from;
        if (to >= 0) {
            H_.diagonal().segment<6>(to) += precision;
            b_.segment<6>(to) -= precision.cwiseProduct(error);
        }
        if (from >= 0) {
            H_.block<6, 6>(from, from) += by_from.transpose() * weighted;
            b_.segment<6>(from) -= weighted.transpose() * error;
        }
        if (from >= 0 && to >= 0) {
            H_.block<6, 6>(to, from) += weighted;
            H_.block<6, 6>(from, to) += weighted.transpose();
        }
    }

    void add_landmark(std::size_t first, std::size_t end) {
        LandmarkSystem& system = systems_.emplace_back();
        system.landmark = bundle_.observations[first].landmark;
        const Vector3d& point = bundle_.landmarks[system.landmark];
        const Index n_poses = 6 * static_cast<Index>(end - first);
        const Index n = n_poses + (calibrate_ ? kCameraParameters : 0);
        system.W.setZero(3, n);
        system.columns.resize(static_cast<std::size_t>(n));
        for (Index i = n_poses; i < n; ++i) system.columns[static_cast<std::size_t>(i)] = poses_ + i - n_poses;
        for (std::size_t k = first; k < end; ++k) {
            const Observation& o = bundle_.observations[k];
            const Isometry3d& T = bundle_.T_camera_world[o.keyframe];
            const Vector3d p = T * point;
            const ObservationError e = error_of(o, p, bundle_);
            const Index at = 6 * static_cast<Index>(k - first);
            for (Index i = 0; i < 6; ++i)
                system.columns[static_cast<std::size_t>(at + i)] = o.keyframe == 0 ? -1 : column(o.keyframe) + i;
            if (!e.valid) continue;
            const Matrix3d weights = Weights(e.error).both().asDiagonal();
            const Matrix3d J_point = e.by_point * T.linear();
            Eigen::Matrix<double, 3, 6> J_pose;
            J_pose.leftCols<3>() = e.by_point;
            for (int i = 0; i < 3; ++i) J_pose.col(3 + i) = e.by_point * Vector3d::Unit(i).cross(p);
            const Eigen::Matrix<double, 3, 3> JtW = J_point.transpose() * weights;
            system.V += JtW * J_point;
            system.b -= JtW * e.error;
            system.W.block<3, 6>(0, at) = JtW * J_pose;
            if (o.keyframe > 0) {
                const Index c = column(o.keyframe);
                H_.block<6, 6>(c, c) += J_pose.transpose() * weights * J_pose;
                b_.segment<6>(c) -= J_pose.transpose() * weights * e.error;
            }
            if (!calibrate_) continue;
            Eigen::Matrix<double, 3, kCameraParameters> J_camera = Eigen::Matrix<double, 3, kCameraParameters>::Zero();
            J_camera.leftCols<kIntrinsicParameters>() = e.by_intrinsics;
            for (std::size_t i = 0; i < e.cell.nodes.size(); ++i)
                J_camera(2, kIntrinsicParameters + static_cast<Index>(e.cell.nodes[i])) =
                    e.by_deformation * e.cell.weights[i];
            J_camera.rightCols<kTimeParameters>() = e.by_times;
            system.W.rightCols<kCameraParameters>() += JtW * J_camera;
            H_.bottomRightCorner<kCameraParameters, kCameraParameters>() += J_camera.transpose() * weights * J_camera;
            b_.tail<kCameraParameters>() -= J_camera.transpose() * weights * e.error;
            if (o.keyframe > 0) {
                const Index c = column(o.keyframe);
                H_.block<6, kCameraParameters>(c, poses_) += J_pose.transpose() * weights * J_camera;
                H_.block<kCameraParameters, 6>(poses_, c) += J_camera.transpose() * weights * J_pose;
            }
        }
    }

    /// Takes the landmarks out of the system.
    void reduce(double damping, MatrixXd& H, VectorXd& b) const {
        H = H_;
        b = b_;
        for (Index i = 0; i < size_; ++i) H(i, i) *= 1 + damping;
        for (const LandmarkSystem& s : systems_) {
            const Matrix3d inverse = damped(s.V, damping).inverse();
            const Eigen::Matrix<double, 3, Eigen::Dynamic> inverse_W = inverse * s.W;
            const MatrixXd product = s.W.transpose() * inverse_W;
            const VectorXd right = inverse_W.transpose() * s.b;
            const auto n = static_cast<Index>(s.columns.size());
            for (Index j = 0; j < n; ++j) {
                const Index to = s.columns[static_cast<std::size_t>(j)];
                if (to < 0) continue;
                b(to) -= right(j);
                for (Index i = 0; i < n; ++i) {
                    const Index from = s.columns[static_cast<std::size_t>(i)];
                    if (from >= 0) H(from, to) -= product(i, j);
                }
            }
        }
    }

    static Matrix3d damped(const Matrix3d& V, double damping) {
        constexpr double kLeast = 1e-9;  // so that a landmark without weight can be inverted
        Matrix3d result = V;
        result.diagonal() += damping * V.diagonal() + Vector3d::Constant(kLeast);
        return result;
    }

    [[nodiscard]] bool step(double damping, Bundle& next) const {
        MatrixXd H;
        VectorXd b;
        reduce(damping, H, b);
        const Eigen::LLT<MatrixXd> llt(H);
        if (llt.info() != Eigen::Success) return true;  // more damping: `next` is no better
        const VectorXd x = llt.solve(b);
        if (!x.allFinite()) return false;
        for (std::size_t k = 1; k < next.T_camera_world.size(); ++k) {
            const Vector6d motion = x.segment<6>(column(static_cast<std::uint32_t>(k)));
            next.T_camera_world[k] = moved(next.T_camera_world[k], motion);
        }
        if (calibrate_) next.camera += x.tail<kCameraParameters>();
        for (const LandmarkSystem& s : systems_) {
            Vector3d right = s.b;
            for (std::size_t i = 0; i < s.columns.size(); ++i)
                if (s.columns[i] >= 0) right -= s.W.col(static_cast<Index>(i)) * x(s.columns[i]);
            next.landmarks[s.landmark] += damped(s.V, damping).inverse() * right;
        }
        return true;
    }

    /// Sum of the weighted squares over the degrees of freedom that the weights leave.
    [[nodiscard]] double variance() const {
        double squares = 0, freedom = -static_cast<double>(size_) - 3 * static_cast<double>(systems_.size());
        for (const Observation& o : bundle_.observations) {
            const ObservationError e =
                error_of(o, bundle_.T_camera_world[o.keyframe] * bundle_.landmarks[o.landmark], bundle_);
            if (!e.valid) continue;
            const Vector3d w = Weights(e.error).both();
            squares += w.dot(e.error.cwiseAbs2());
            freedom += w.sum();
        }
        return freedom > 1 ? std::max(1.0, squares / freedom) : 1;
    }

    [[nodiscard]] CameraMatrix camera_covariance() const {
        MatrixXd H;
        VectorXd b;
        reduce(0, H, b);
        const MatrixXd inverse =
            Eigen::LDLT<MatrixXd>(H).solve(MatrixXd::Identity(size_, size_).rightCols(kCameraParameters));
        return inverse.bottomRows(kCameraParameters);
    }

    Bundle& bundle_;
    const CameraParameters given_;
    bool calibrate_;
    Index poses_, size_;
    CameraMatrix prior_;
    MatrixXd H_;
    VectorXd b_;
    std::vector<LandmarkSystem> systems_;
};

}  // namespace

CameraParameters prior_sigmas(const CameraParameters& given, int width) {
    CameraParameters sigmas = CameraParameters::Constant(BundleConfig::kNodeSigma);
    intrinsics_part(sigmas) << BundleConfig::kFocalSigma * given(0), BundleConfig::kFocalSigma * given(1),
        BundleConfig::kCentreSigma * width, BundleConfig::kCentreSigma * width;
    times_part(sigmas) << BundleConfig::kDelaySigma, BundleConfig::kReadoutSigma, BundleConfig::kReadoutSigma;
    return sigmas;
}

CameraParameters parameters_of(const Intrinsics& camera, const DepthDeformation& deformation, const RowTimes& times) {
    CameraParameters p;
    intrinsics_part(p) << camera.fx, camera.fy, camera.cx, camera.cy;
    for (std::size_t i = 0; i < DepthDeformation::kNodes; ++i)
        p(kIntrinsicParameters + static_cast<Index>(i)) = static_cast<double>(deformation.nodes[i]);
    times_part(p) << times.depth_delay, times.depth_readout, times.color_readout;
    return p;
}

Intrinsics intrinsics_of(const CameraParameters& p, int width, int height) {
    return {static_cast<float>(p(0)),
            static_cast<float>(p(1)),
            static_cast<float>(p(2)),
            static_cast<float>(p(3)),
            width,
            height};
}

DepthDeformation deformation_of(const CameraParameters& p) {
    DepthDeformation deformation;
    for (std::size_t i = 0; i < DepthDeformation::kNodes; ++i)
        deformation.nodes[i] = static_cast<float>(p(kIntrinsicParameters + static_cast<Index>(i)));
    return deformation;
}

RowTimes times_of(const CameraParameters& p, double stamp_row) {
    const Vector3d times = times_part(p);
    return {times(0), times(1), times(2), stamp_row};
}

ObservationError error_of(const Observation& o, const Vector3d& point, const Bundle& bundle) {
    ObservationError result;
    const CameraParameters& camera = bundle.camera;
    const RowTimes times = times_of(camera, bundle.stamp_row);
    const FrameReadout frame = bundle.readouts.empty() ? FrameReadout{} : bundle.readouts[o.keyframe];
    const ReadoutMotion::Seen in_color = frame.motion.seen(point, times.of_color(o.pixel.y(), bundle.height)),
                              in_depth = frame.motion.seen(point, times.of_depth(o.pixel.y(), bundle.height, frame));
    constexpr double kNearest = 0.05;  // metres
    if (!(in_color.point.z() > kNearest) || !(in_depth.point.z() > kNearest)) return result;
    result.valid = true;
    result.cell = deformation_cell(o.pixel.x(), o.pixel.y(), bundle.width, bundle.height);
    /// Where a point is seen, and how that changes with it.
    struct Place {
        double x, y;  // of the ray at depth 1
        Eigen::Vector2d pixel;
        Eigen::Matrix<double, 2, 3> by_point;
    };
    const auto place_of = [&](const Vector3d& p) {
        const double inverse = 1 / p.z(), x = p.x() * inverse, y = p.y() * inverse;
        Place place{x, y, {camera(0) * x + camera(2), camera(1) * y + camera(3)}, {}};
        place.by_point << camera(0) * inverse, 0, -camera(0) * x * inverse,  //
            0, camera(1) * inverse, -camera(1) * y * inverse;
        return place;
    };
    const Place color = place_of(in_color.point), depth = place_of(in_depth.point);
    // the surface is measured where depth shows the point
    double measured = o.inverse_depth + o.slope.dot(depth.pixel - o.pixel);
    for (std::size_t i = 0; i < result.cell.nodes.size(); ++i)
        measured += result.cell.weights[i] * camera(kIntrinsicParameters + static_cast<Index>(result.cell.nodes[i]));
    const double inverse = 1 / in_depth.point.z();
    result.error << color.pixel - o.pixel, inverse - measured;
    Eigen::RowVector3d by_depth_point = -o.slope.transpose() * depth.by_point;
    by_depth_point.z() -= inverse * inverse;
    result.by_point << color.by_point * in_color.by_point, by_depth_point * in_depth.by_point;
    result.by_intrinsics << color.x, 0, 1, 0,  //
        0, color.y, 0, 1,                      //
        -o.slope.x() * depth.x, -o.slope.y() * depth.y, -o.slope.x(), -o.slope.y();
    const double below_stamp = times.below_stamp(o.pixel.y(), bundle.height);
    const double by_depth_time = by_depth_point * in_depth.by_time;
    result.by_times.topRightCorner<2, 1>() = color.by_point * in_color.by_time * below_stamp;
    result.by_times.bottomRows<1>() << by_depth_time, by_depth_time * below_stamp, 0;
    const Vector3d weights(1 / o.pixel_sigma, 1 / o.pixel_sigma, 1 / o.inverse_depth_sigma);
    result.error.array() *= weights.array();
    result.by_point = weights.asDiagonal() * result.by_point;
    result.by_intrinsics = weights.asDiagonal() * result.by_intrinsics;
    result.by_times = weights.asDiagonal() * result.by_times;
    result.by_deformation = -weights.z();
    return result;
}

BundleResult adjust(Bundle& bundle, const CameraParameters& given, const BundleConfig& config) {
    if (bundle.T_camera_world.empty() || bundle.observations.empty()) return {};
    return Adjustment(bundle, given, config).run();
}

double cost_of(Bundle bundle) {
    double cost = 0;
    constexpr int kSteps = 8;
    for_each_landmark(bundle.observations, [&](std::size_t first, std::size_t end) {
        Vector3d& point = bundle.landmarks[bundle.observations[first].landmark];
        double least = std::numeric_limits<double>::infinity();
        for (int step = 0; step < kSteps; ++step) {
            Matrix3d H = 1e-9 * Matrix3d::Identity();
            Vector3d b = Vector3d::Zero();
            double now = 0;
            for (std::size_t k = first; k < end; ++k) {
                const Observation& o = bundle.observations[k];
                const Isometry3d& T = bundle.T_camera_world[o.keyframe];
                const ObservationError e = error_of(o, T * point, bundle);
                now += cost_of_error(e);
                if (!e.valid) continue;
                const Matrix3d J = e.by_point * T.linear();
                const Vector3d w = Weights(e.error).both();
                H += J.transpose() * w.asDiagonal() * J;
                b -= J.transpose() * w.asDiagonal() * e.error;
            }
            least = std::min(least, now);
            point += H.inverse() * b;
        }
        cost += least;
    });
    return cost;
}

double mean_cost_of(const Bundle& bundle) {
    return cost_of(bundle) / static_cast<double>(std::max<std::size_t>(1, bundle.observations.size()));
}

Bundle part_of(const Bundle& bundle, std::size_t every, bool held_out) {
    Bundle part = bundle;
    std::erase_if(part.observations, [&](const Observation& o) { return (o.landmark % every == 0) != held_out; });
    return part;
}

namespace {

using Vector12d = Eigen::Matrix<double, 12, 1>;
using Matrix12d = Eigen::Matrix<double, 12, 12>;

/// Derivative of an observation's error by the speed on the side of the stamp where the motion is not known.
Eigen::Matrix<double, 3, 6> error_by_speed(const Observation& o, const Vector3d& point, const Bundle& frame) {
    constexpr double kStep = 1e-4;  // m/s and rad/s
    Eigen::Matrix<double, 3, 6> J;
    Bundle other = frame;
    for (int i = 0; i < 6; ++i) {
        const auto error_at = [&](double speed) -> Vector3d {
            FrameReadout& readout = other.readouts.front();
            readout.motion = frame.readouts.front().motion.faster(*readout.unknown, speed * Vector6d::Unit(i));
            return error_of(o, point, other).error;
        };
        J.col(i) = (error_at(kStep) - error_at(-kStep)) / (2 * kStep);
    }
    return J;
}

}  // namespace

std::optional<Isometry3d> fit_pose(const Bundle& bundle, const std::vector<Observation>& seen,
                                   const FrameReadout& readout, const ExpectedPose& expected) {
    constexpr double kSpeedSigma = 0.3, kTurnSigma = 0.5;  // m/s and rad/s, of one side of the stamp by the other
    constexpr std::size_t kFewest = 12;                    // observations
    constexpr int kSteps = 12;
    constexpr double kConverged = 1e-7;  // metres and radians
    constexpr double kWeakest = 1e-9;    // of the pivots of the system, the smallest to the largest
    if (seen.size() < kFewest) return std::nullopt;
    Bundle frame;
    frame.width = bundle.width, frame.height = bundle.height, frame.stamp_row = bundle.stamp_row;
    frame.camera = bundle.camera;
    if (!bundle.readouts.empty()) frame.readouts = {readout};
    const bool find_speed = !bundle.readouts.empty() && readout.unknown;
    Vector12d known;
    known << precision_of(expected.position_sigma, expected.rotation_sigma), precision_of(kSpeedSigma, kTurnSigma);
    Isometry3d T = expected.T_camera_world;
    Vector6d speed = Vector6d::Zero();  // more than known
    for (int step = 0; step < kSteps; ++step) {
        Matrix12d H = Matrix12d::Zero();
        Vector12d b, off;
        off << difference(T, expected.T_camera_world), speed;
        b.setZero();
        for (Observation o : seen) {
            const Vector3d p = T * bundle.landmarks[o.landmark];
            o.keyframe = 0;
            const ObservationError e = error_of(o, p, frame);
            if (!e.valid) continue;
            Eigen::Matrix<double, 3, 12> J = Eigen::Matrix<double, 3, 12>::Zero();
            J.leftCols<3>() = e.by_point;
            for (int i = 0; i < 3; ++i) J.col(3 + i) = e.by_point * Vector3d::Unit(i).cross(p);
            if (find_speed) J.rightCols<6>() = error_by_speed(o, p, frame);
            const Vector3d w = Weights(e.error).both();
            H += J.transpose() * w.asDiagonal() * J;
            b -= J.transpose() * w.asDiagonal() * e.error;
        }
        const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> pose(H.topLeftCorner<6, 6>());
        if (!(pose.vectorD().minCoeff() > kWeakest * pose.vectorD().maxCoeff())) return std::nullopt;
        H.diagonal() += known;
        b -= known.cwiseProduct(off);
        const Vector12d x = H.ldlt().solve(b);
        if (!x.allFinite()) return std::nullopt;
        T = moved(T, x.head<6>());
        if (find_speed) {
            speed += x.tail<6>();
            frame.readouts.front().motion = readout.motion.faster(*readout.unknown, speed);
        }
        if (x.head<6>().norm() < kConverged) break;
    }
    return T;
}

}  // namespace posefusion
