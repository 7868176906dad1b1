#include "engine/objects/rigid_motion.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/pinhole.hpp"

namespace posefusion {
namespace {

constexpr float kCellsAcross = 160;
constexpr float kNearest = 0.1f;  ///< metres, in front of the camera

}  // namespace

Eigen::Vector3f DepthGrid::point(int x, int y) const {
    return back_project(static_cast<float>(x), static_cast<float>(y), depth[index(x, y)], camera);
}

std::vector<std::size_t> DepthGrid::connected(std::size_t cell, float most_apart) const {
    std::vector<std::size_t> cells;
    const auto [x0, y0] = position(cell);
    for (int y = y0 - 1; y <= y0 + 1; ++y)
        for (int x = x0 - 1; x <= x0 + 1; ++x) {
            if (!contains(x, y) || (x == x0 && y == y0)) continue;
            const std::size_t other = index(x, y);
            if (depth[other] > 0 && std::abs(depth[other] - depth[cell]) < most_apart) cells.push_back(other);
        }
    return cells;
}

DepthGrid make_depth_grid(const DepthImage& depth, const LabelImage& unusable, const Intrinsics& camera,
                          const DepthNoise& noise) {
    DepthGrid grid;
    grid.step = std::max(1, static_cast<int>(std::lround(static_cast<float>(camera.width) / kCellsAcross)));
    const auto step = static_cast<float>(grid.step);
    grid.noise = noise;
    grid.camera = {camera.fx / step,
                   camera.fy / step,
                   camera.cx / step,
                   camera.cy / step,
                   (camera.width + grid.step - 1) / grid.step,
                   (camera.height + grid.step - 1) / grid.step};
    grid.depth.reserve(static_cast<std::size_t>(grid.camera.width) * static_cast<std::size_t>(grid.camera.height));
    for (int y = 0; y < grid.camera.height; ++y)
        for (int x = 0; x < grid.camera.width; ++x) {
            const int u = x * grid.step, v = y * grid.step;
            const float z = depth(u, v);
            const bool usable = std::isfinite(z) && z > 0 && (unusable.empty() || unusable(u, v) == 0);
            grid.depth.push_back(usable ? z : 0.0f);
        }
    return grid;
}

Agreement agreement(const std::vector<Eigen::Vector3f>& points, const Eigen::Isometry3d& T_now_then,
                    const DepthGrid& now) {
    const Eigen::Isometry3f T = T_now_then.cast<float>();
    Agreement result;
    for (const Eigen::Vector3f& point : points) {
        const Eigen::Vector3f p = T * point;
        if (!(p.z() > kNearest)) continue;
        const Eigen::Vector2f at = project(p, now.camera);
        if (!in_image(at, now.camera)) continue;
        const int x0 = static_cast<int>(std::lround(at.x())), y0 = static_cast<int>(std::lround(at.y()));
        const float sigma = now.noise.sigma(p.z());
        const float same = same_depth(sigma), behind = other_depth(sigma);
        bool fits = false, is_near = false, in_front = false, known = false;
        for (int y = y0 - 1; y <= y0 + 1; ++y)
            for (int x = x0 - 1; x <= x0 + 1; ++x) {
                if (!now.contains(x, y)) continue;
                const float z = now.depth[now.index(x, y)];
                if (z <= 0) continue;
                known = true;
                fits = fits || std::abs(z - p.z()) < same;
                is_near = is_near || std::abs(z - p.z()) < behind;
                in_front = in_front || z < p.z();
            }
        if (!known) continue;
        if (fits)
            ++result.fits;
        else if (is_near)
            continue;  // it cannot be told
        else if (in_front)
            ++result.hidden;
        else
            ++result.through;
    }
    return result;
}

double distance_between(const std::vector<Eigen::Vector3f>& points, const Eigen::Isometry3d& a,
                        const Eigen::Isometry3d& b) {
    double sum = 0;
    for (const Eigen::Vector3f& point : points) sum += (a * point.cast<double>() - b * point.cast<double>()).norm();
    return points.empty() ? 0.0 : sum / static_cast<double>(points.size());
}

}  // namespace posefusion
