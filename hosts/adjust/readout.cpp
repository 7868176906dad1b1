#include "hosts/adjust/readout.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "engine/core/pinhole.hpp"

namespace posefusion {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Vector6d = ReadoutMotion::Vector6d;

Vector6d position_and_rotation(const Isometry3d& T) {
    const Eigen::AngleAxisd rotation(T.linear());
    Vector6d x;
    x << T.translation(), rotation.angle() * rotation.axis();
    return x;
}

Matrix3d rotation_by(const Vector3d& vector) {
    const double angle = vector.norm();
    return angle > 0 ? Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix() : Matrix3d::Identity().eval();
}

/// Steps until a row and what it sees agree: rows are read so quickly that each step comes a hundred times nearer.
constexpr int kSteps = 3;

}  // namespace

ReadoutMotion::ReadoutMotion(std::span<const Neighbour> neighbours, Way way) {
    const auto n = static_cast<Index>(std::min(neighbours.size(), kMostNeighbours));
    if (n == 0) return;
    if (way == Way::Straight) {
        // the nearest on each side; where there is none, the camera goes on as on the other
        const Neighbour *last = nullptr, *next = nullptr;
        for (const Neighbour& neighbour : neighbours) {
            const bool is_before = neighbour.seconds < 0;
            const Neighbour*& nearest = is_before ? last : next;
            if (!nearest || std::abs(neighbour.seconds) < std::abs(nearest->seconds)) nearest = &neighbour;
        }
        const auto speed = [](const Neighbour& neighbour) -> Vector6d {
            return position_and_rotation(neighbour.T_stamp_camera) / neighbour.seconds;
        };
        before_.col(0) = speed(last ? *last : *next);
        after_.col(0) = speed(next ? *next : *last);
        return;
    }
    MatrixXd powers(n, n), poses(6, n);
    for (Index i = 0; i < n; ++i) {
        const auto& [seconds, T] = neighbours[static_cast<std::size_t>(i)];
        poses.col(i) = position_and_rotation(T);
        for (Index k = 0; k < n; ++k) powers(k, i) = (k > 0 ? powers(k - 1, i) : 1) * seconds;
    }
    before_.leftCols(n) = powers.transpose().partialPivLu().solve(poses.transpose()).transpose();
    after_ = before_;
}

ReadoutMotion ReadoutMotion::faster(Side side, const Vector6d& speed) const {
    ReadoutMotion motion = *this;
    (side == Side::Before ? motion.before_ : motion.after_).col(0) += speed;
    return motion;
}

Isometry3d ReadoutMotion::at(double seconds) const {
    Vector6d x = Vector6d::Zero();
    const Coefficients& c = at_side(seconds);
    for (Index k = c.cols() - 1; k >= 0; --k) x = (x + c.col(k)) * seconds;
    Isometry3d T = Isometry3d::Identity();
    T.translation() = x.head<3>();
    T.linear() = rotation_by(x.tail<3>());
    return T;
}

ReadoutMotion::Seen ReadoutMotion::seen(const Vector3d& point, double seconds) const {
    const Isometry3d T = at(seconds);
    Seen seen;
    seen.by_point = T.linear().transpose();
    seen.point = seen.by_point * (point - T.translation());
    // the rotation vector is so short that it changes as the rotation does
    Vector6d rate = Vector6d::Zero();
    const Coefficients& c = at_side(seconds);
    for (Index k = c.cols() - 1; k >= 0; --k) rate = rate * seconds + static_cast<double>(k + 1) * c.col(k);
    seen.by_time = -seen.by_point * rate.head<3>() - rate.tail<3>().cross(seen.point);
    return seen;
}

Vector3d RowCamera::point_at(const Vector2d& pixel, double z, const FrameReadout& frame) const {
    const Vector3d point((pixel.x() - camera.cx) / camera.fx * z, (pixel.y() - camera.cy) / camera.fy * z, z);
    return frame.motion.at(times.of_color(pixel.y(), camera.height)) * point;
}

std::optional<Vector2d> RowCamera::pixel_of(const Vector3d& point, const FrameReadout& frame) const {
    if (!(point.z() > 0)) return std::nullopt;
    Vector2d pixel = project(point, camera);
    for (int step = 0; step < kSteps; ++step) {
        const Vector3d seen = frame.motion.at(times.of_color(pixel.y(), camera.height)).inverse() * point;
        if (!(seen.z() > 0)) return std::nullopt;
        pixel = project(seen, camera);
    }
    return pixel;
}

double RowCamera::depth_with_color(const Vector2d& pixel, double inverse_depth, const Vector2d& slope,
                                   const FrameReadout& frame) const {
    double z = 1 / inverse_depth;
    const Isometry3d T_depth_stamp = frame.motion.at(times.of_depth(pixel.y(), camera.height, frame)).inverse();
    for (int step = 0; step < kSteps; ++step) {
        const Vector3d seen = T_depth_stamp * point_at(pixel, z, frame);
        if (!(seen.z() > 0)) break;
        const double surface = inverse_depth + slope.dot(project(seen, camera) - pixel);
        if (!(surface > 0)) break;
        z += 1 / surface - seen.z();
    }
    return z;
}

}  // namespace posefusion
