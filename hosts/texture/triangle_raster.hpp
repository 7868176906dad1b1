#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

namespace posefusion {

using Triangle2 = std::array<Eigen::Vector2f, 3>;

/// Calls `pixel(u, v, barycentric)` for the pixels of an image whose centres (whole numbers) are within the triangle,
/// whichever way round it is. Of two triangles with a common edge one has the centres on it (top-left rule).
template <class Visit>
void rasterise(const Triangle2& triangle, int width, int height, Visit&& pixel) {
    std::array<Eigen::Vector2d, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = triangle[i].cast<double>();
    const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); };
    const double twice_area = cross(p[1] - p[0], p[2] - p[0]);
    if (twice_area == 0 || !std::isfinite(twice_area)) return;
    const double sign = twice_area > 0 ? 1 : -1;
    const auto first = [](double least) { return static_cast<int>(std::ceil(std::max(least, 0.0))); };
    const auto last = [](double most, int size) {
        return static_cast<int>(std::floor(std::min(most, static_cast<double>(size - 1))));
    };
    const int u_end = last(std::max({p[0].x(), p[1].x(), p[2].x()}), width);
    const int v_end = last(std::max({p[0].y(), p[1].y(), p[2].y()}), height);
    for (int v = first(std::min({p[0].y(), p[1].y(), p[2].y()})); v <= v_end; ++v) {
        for (int u = first(std::min({p[0].x(), p[1].x(), p[2].x()})); u <= u_end; ++u) {
            Eigen::Vector3d weights;
            bool inside = true;
            for (std::size_t i = 0; i < 3 && inside; ++i) {  // the edge opposite to corner i
                const Eigen::Vector2d &a = p[(i + 1) % 3], edge = sign * (p[(i + 2) % 3] - a);
                const double side = cross(edge, Eigen::Vector2d(u, v) - a);
                const bool top_left = edge.y() < 0 || (edge.y() == 0 && edge.x() > 0);
                inside = side > 0 || (side == 0 && top_left);
                weights[static_cast<Eigen::Index>(i)] = side * sign / twice_area;
            }
            if (inside) pixel(u, v, Eigen::Vector3f(weights.cast<float>()));
        }
    }
}

}  // namespace posefusion
