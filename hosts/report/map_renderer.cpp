#include "hosts/report/map_renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/core/pinhole.hpp"

namespace posefusion {
namespace {

constexpr float kNear = 0.05f;      // nothing nearer to the camera is drawn, metres
constexpr float kConeSlope = 0.7f;  // metres that a disc recedes per metre from its centre

struct Rect {
    int u0, v0, u1, v1;  // inclusive
    [[nodiscard]] bool empty() const { return u0 > u1 || v0 > v1; }
};

class DiscRenderer {
public:
    DiscRenderer(const Intrinsics& camera, const Eigen::Isometry3d& T_world_camera, const MapRenderConfig& config)
        : K_(camera),
          R_(T_world_camera.linear().transpose().cast<float>()),
          origin_(T_world_camera.translation().cast<float>()),
          config_(config),
          color_(camera.width, camera.height, config.background),
          depth_(camera.width, camera.height, std::numeric_limits<float>::infinity()) {}

    void draw(const Surfel& surfel) {
        const Eigen::Vector3f centre = R_ * (surfel.position - origin_);
        if (!(centre.z() > kNear)) return;
        const Eigen::Vector3f normal = R_ * surfel.normal;
        const float facing = -normal.dot(centre.normalized());
        if (!(facing > 0)) return;
        // Discs thinner than the sample spacing would fall between the samples.
        const float sample = centre.z() / std::min(K_.fx, K_.fy);
        const float radius = std::max(surfel.radius * config_.radius_factor, 0.75f * sample);
        const Rect box = bounds(centre, radius);
        if (box.empty()) return;
        const Rgb8 color = shade(surfel.color, facing);
        const float plane = normal.dot(centre);
        for (int v = box.v0; v <= box.v1; ++v)
            for (int u = box.u0; u <= box.u1; ++u) draw_sample(u, v, centre, normal, plane, radius, color);
    }

    [[nodiscard]] const ColorImage& color() const { return color_; }

private:
    [[nodiscard]] Rect bounds(const Eigen::Vector3f& centre, float radius) const {
        const float z = std::max(centre.z() - radius, kNear);
        const float ru = radius / z * K_.fx, rv = radius / z * K_.fy;
        const Eigen::Vector2f at = project(centre, K_);
        const float u = at.x(), v = at.y();
        if (!(std::abs(u) < 1e6f && std::abs(v) < 1e6f)) return {0, 0, -1, -1};
        return {std::max(0, static_cast<int>(std::ceil(u - ru))), std::max(0, static_cast<int>(std::ceil(v - rv))),
                std::min(K_.width - 1, static_cast<int>(std::floor(u + ru))),
                std::min(K_.height - 1, static_cast<int>(std::floor(v + rv)))};
    }

    void draw_sample(int u, int v, const Eigen::Vector3f& centre, const Eigen::Vector3f& normal, float plane,
                     float radius, Rgb8 color) {
        const Eigen::Vector3f ray = pixel_ray(static_cast<float>(u), static_cast<float>(v), K_);
        const float along = normal.dot(ray);
        if (along >= 0) return;
        const float z = plane / along;
        if (!(z > kNear) || z >= depth_(u, v)) return;
        const float off_centre = (ray * z - centre).norm();
        // Discs are drawn as shallow cones: where those of one surface overlap, the nearest centre wins.
        const float cone = z + kConeSlope * off_centre;
        if (off_centre > radius || cone >= depth_(u, v)) return;
        depth_(u, v) = cone;
        color_(u, v) = color;
    }

    [[nodiscard]] Rgb8 shade(Rgb8 c, float facing) const {
        const float light = config_.ambient + (1 - config_.ambient) * facing;
        const auto scale = [&](std::uint8_t x) {
            return static_cast<std::uint8_t>(std::lround(light * static_cast<float>(x)));
        };
        return {scale(c.r), scale(c.g), scale(c.b)};
    }

    Intrinsics K_;
    Eigen::Matrix3f R_;  // world to camera
    Eigen::Vector3f origin_;
    MapRenderConfig config_;
    ColorImage color_;
    DepthImage depth_;
};

ColorImage average_blocks(const ColorImage& fine, int factor) {
    ColorImage coarse(fine.width() / factor, fine.height() / factor);
    const int samples = factor * factor;
    for (int v = 0; v < coarse.height(); ++v) {
        for (int u = 0; u < coarse.width(); ++u) {
            std::array<int, 3> sum{samples / 2, samples / 2, samples / 2};
            for (int y = 0; y < factor; ++y) {
                for (int x = 0; x < factor; ++x) {
                    const Rgb8 c = fine(u * factor + x, v * factor + y);
                    sum[0] += c.r, sum[1] += c.g, sum[2] += c.b;
                }
            }
            coarse(u, v) = {static_cast<std::uint8_t>(sum[0] / samples), static_cast<std::uint8_t>(sum[1] / samples),
                            static_cast<std::uint8_t>(sum[2] / samples)};
        }
    }
    return coarse;
}

/// The given quantiles of the numbers.
std::array<double, 2> quantiles(std::vector<double> values, double low, double high) {
    const auto at = [&](double share) {
        const auto i = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
        std::nth_element(values.begin(), values.begin() + i, values.end());
        return values[static_cast<std::size_t>(i)];
    };
    const double first = at(low);
    return {first, at(high)};
}

bool sees_all(const Intrinsics& K, const Eigen::Isometry3d& T_world_camera,
              const std::vector<Eigen::Vector3d>& points) {
    const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
    return std::all_of(points.begin(), points.end(), [&](const Eigen::Vector3d& point) {
        const Eigen::Vector3d p = T_camera_world * point;
        return p.z() >= kNear && in_image(project(p, K), K);
    });
}

}  // namespace

ColorImage render_map(const std::vector<Surfel>& surfels, const Intrinsics& camera,
                      const Eigen::Isometry3d& T_world_camera, const MapRenderConfig& config) {
    const int factor = std::max(config.supersampling, 1);
    DiscRenderer renderer(camera.scaled(static_cast<float>(factor)), T_world_camera, config);
    for (const Surfel& surfel : surfels) renderer.draw(surfel);
    return factor == 1 ? renderer.color() : average_blocks(renderer.color(), factor);
}

Eigen::Isometry3d look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& up) {
    const Eigen::Vector3d z = (target - eye).normalized();
    const Eigen::Vector3d x = z.cross(up).normalized();
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() << x, z.cross(x), z;
    T.translation() = eye;
    return T;
}

Eigen::Isometry3d overview_pose(const std::vector<Surfel>& surfels, const Intrinsics& camera,
                                const Eigen::Vector3d& direction, const Eigen::Vector3d& up,
                                const std::vector<Eigen::Vector3d>& more) {
    const Eigen::Vector3d back = direction.normalized();
    const Eigen::Matrix3d axes = look_at(Eigen::Vector3d::Zero(), -back, up).linear();
    // The box of the map in the axes of the picture, without the outermost 1 % on each side.
    Eigen::Vector3d low = Eigen::Vector3d::Constant(-0.5), high = Eigen::Vector3d::Constant(0.5);
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d a = axes.col(axis);
        if (surfels.empty() && !more.empty()) low[axis] = high[axis] = a.dot(more.front());
        if (!surfels.empty()) {
            std::vector<double> along;
            along.reserve(surfels.size());
            for (const Surfel& s : surfels) along.push_back(a.cast<float>().dot(s.position));
            const auto [l, h] = quantiles(std::move(along), 0.01, 0.99);
            low[axis] = l;
            high[axis] = h;
        }
        for (const Eigen::Vector3d& point : more) {
            low[axis] = std::min(low[axis], a.dot(point));
            high[axis] = std::max(high[axis], a.dot(point));
        }
    }
    std::vector<Eigen::Vector3d> corners;
    for (int i = 0; i < 8; ++i)
        corners.push_back(axes * Eigen::Vector3d((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                                                 (i & 4) != 0 ? high.z() : low.z()));
    const Eigen::Vector3d centre = axes * ((low + high) / 2);
    constexpr double kStep = 1.02, kMargin = 1.03;
    double distance = 0.1 + (high - low).norm() / 10;
    const auto pose = [&] { return look_at(centre + back * distance, centre, up); };
    while (!sees_all(camera, pose(), corners) && distance < 1e4) distance *= kStep;
    distance *= kMargin;
    return pose();
}

}  // namespace posefusion
