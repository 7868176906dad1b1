#include "tests/engine/support/synthetic_room.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "tests/engine/support/kernel_harness.hpp"

namespace posefusion::test {

using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

// Room frame: y up, the corner at the origin, walls x = 0, z = 0, floor y = 0; a block stands in the corner.
const Eigen::AlignedBox3d kRoom(Vector3d(0, 0, 0), Vector3d(4.5, 2.6, 4.5));
const Eigen::AlignedBox3d kBlock(Vector3d(0.5, 0, 0.6), Vector3d(1.1, 0.75, 1.1));

/// Where the first camera stands: 2.5 m from the corner, looking at it a little downwards.
Isometry3d first_camera() {
    const Vector3d eye(1.9, 1.35, 2.0), target(0.35, 0.6, 0.4);
    const Vector3d z = (target - eye).normalized(), x = z.cross(Vector3d::UnitY()).normalized(), y = z.cross(x);
    Isometry3d T = Isometry3d::Identity();
    T.linear().col(0) = x;
    T.linear().col(1) = y;
    T.linear().col(2) = z;
    T.translation() = eye;
    return T;
}

/// First face of a box that a ray from outside enters, or from inside leaves.
double box_hit(const Eigen::AlignedBox3d& box, const Vector3d& origin, const Vector3d& direction, bool from_inside) {
    double enter = 0, leave = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
        const double a = (box.min()(k) - origin(k)) / direction(k), b = (box.max()(k) - origin(k)) / direction(k);
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    if (from_inside) return leave;
    return enter < leave && enter > 0 ? enter : std::numeric_limits<double>::infinity();
}

double ball_hit(const Ball& ball, const Vector3d& origin, const Vector3d& direction) {
    const Vector3d offset = origin - ball.centre;
    const double a = direction.squaredNorm(), b = offset.dot(direction),
                 c = offset.squaredNorm() - ball.radius * ball.radius;
    const double root = b * b - a * c;
    return root > 0 && b < 0 ? (-b - std::sqrt(root)) / a : std::numeric_limits<double>::infinity();
}

/// Smooth texture, wavelengths of 15 to 60 cm: every pixel of the small cameras sees less than a tenth of one.
Rgb8 texture(const Vector3d& p) {
    const auto channel = [&](double phase) {
        const double value = 0.5 + 0.14 * std::sin(19 * p.x() + 7 * p.y() + phase) +
                             0.13 * std::sin(23 * p.z() - 11 * p.y() + 2 * phase) +
                             0.12 * std::sin(31 * p.y() + 13 * p.x() - 9 * p.z() + phase);
        return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 1.0) * 255));
    };
    return {channel(0.0), channel(0.4), channel(1.1)};
}

}  // namespace

Frame render_room(const Intrinsics& camera, const Isometry3d& T_world_camera, const std::optional<Ball>& ball) {
    Frame frame{ColorImage(camera.width, camera.height), DepthImage(camera.width, camera.height),
                LabelImage(camera.width, camera.height)};
    const Isometry3d T_room_world = first_camera(), T_room_camera = T_room_world * T_world_camera;
    const Ball ball_in_room{ball ? Vector3d(T_room_world * ball->centre) : Vector3d(Vector3d::Zero()),
                            ball ? ball->radius : 0.0};
    for (int v = 0; v < camera.height; ++v) {
        for (int u = 0; u < camera.width; ++u) {
            const Vector3d ray((u - static_cast<double>(camera.cx)) / static_cast<double>(camera.fx),
                               (v - static_cast<double>(camera.cy)) / static_cast<double>(camera.fy), 1);
            const Vector3d origin = T_room_camera.translation(), direction = T_room_camera.linear() * ray;
            double z = std::min(box_hit(kRoom, origin, direction, true), box_hit(kBlock, origin, direction, false));
            Vector3d textured = origin + z * direction;
            if (ball) {
                const double there = ball_hit(ball_in_room, origin, direction);
                if (there < z) {
                    z = there;
                    textured = 2.5 * (origin + z * direction - ball_in_room.centre);  // the texture moves with the ball
                    frame.labels(u, v) = 1;
                }
            }
            frame.depth(u, v) = static_cast<float>(z);
            frame.color(u, v) = texture(textured);
        }
    }
    return frame;
}

double distance_to_room(const Vector3d& point) {
    const Vector3d p = first_camera() * point;
    const double walls = std::min((p - kRoom.min()).cwiseAbs().minCoeff(), (kRoom.max() - p).cwiseAbs().minCoeff());
    const double outside = std::sqrt(kBlock.squaredExteriorDistance(p));
    const double inside = std::min((p - kBlock.min()).minCoeff(), (kBlock.max() - p).minCoeff());
    return std::min(walls, outside > 0 ? outside : inside);
}

std::vector<Isometry3d> path_to(const Isometry3d& end, int frames) {
    const Eigen::AngleAxisd rotation(end.linear());
    std::vector<Isometry3d> path;
    for (int k = 0; k < frames; ++k) {
        const double share = frames > 1 ? static_cast<double>(k) / (frames - 1) : 0;
        Isometry3d T = Isometry3d::Identity();
        T.linear() = Eigen::AngleAxisd(share * rotation.angle(), rotation.axis()).toRotationMatrix();
        T.translation() = share * end.translation();
        path.push_back(T);
    }
    return path;
}

SlamConfig test_config() {
    SlamConfig config;
    config.validation = wants_validation();
    return config;
}

double angle_deg(const Isometry3d& T) {
    return std::abs(Eigen::AngleAxisd(T.linear()).angle()) * 180 / std::numbers::pi;
}

Recording run_slam(const Intrinsics& camera, const SlamConfig& config, const std::vector<Isometry3d>& path) {
    Slam slam(camera, config, test_device());
    Recording run;
    for (const auto& pose : path) {
        const Frame frame = render_room(camera, pose);
        run.results.push_back(slam.process(frame.color, frame.depth));
    }
    run.surfels = slam.surfels(false);
    return run;
}

std::vector<unsigned char> Recording::bytes() const {
    std::vector<unsigned char> all;
    const auto append = [&](const auto& value) {
        const auto* begin = reinterpret_cast<const unsigned char*>(&value);
        all.insert(all.end(), begin, begin + sizeof(value));
    };
    for (const auto& result : results) {
        for (int i = 0; i < 16; ++i) append(result.T_world_camera.matrix().data()[i]);
        append(result.surfels);
        append(result.stable_surfels);
    }
    for (const auto& s : surfels) {
        for (int k = 0; k < 3; ++k) append(s.position(k)), append(s.normal(k));
        append(s.color), append(s.radius), append(s.confidence), append(s.created), append(s.last_seen);
    }
    return all;
}

}  // namespace posefusion::test
