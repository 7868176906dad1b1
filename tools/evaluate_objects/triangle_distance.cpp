#include "tools/evaluate_objects/triangle_distance.hpp"

#include <algorithm>
#include <limits>

namespace posefusion {

Eigen::Vector3f closest_on_triangle(const Eigen::Vector3f& p, const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                                    const Eigen::Vector3f& c) {
    const Eigen::Vector3f ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    const float d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d1 <= 0 && d2 <= 0) return a;
    if (d3 >= 0 && d4 <= d3) return b;
    if (d6 >= 0 && d5 <= d6) return c;
    const float vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
    return a + (vb * ab + vc * ac) / (va + vb + vc);
}

TriangleDistance::TriangleDistance(const TrueMesh& mesh) {
    for (const auto& [i, j, k] : mesh.faces) {
        const Eigen::Vector3f &a = mesh.vertices[i], &b = mesh.vertices[j], &c = mesh.vertices[k];
        // The poles of a ball have faces without area.
        if ((b - a).cross(c - a).norm() <= std::numeric_limits<float>::min()) continue;
        const Eigen::Vector3f middle = (a + b + c) / 3;
        faces_.push_back({a, b, c, middle, std::max({(a - middle).norm(), (b - middle).norm(), (c - middle).norm()})});
    }
}

float TriangleDistance::operator()(const Eigen::Vector3f& point) const {
    float nearest = std::numeric_limits<float>::max();
    for (const Face& face : faces_) {
        if ((face.middle - point).norm() - face.radius >= nearest) continue;
        nearest = std::min(nearest, (closest_on_triangle(point, face.a, face.b, face.c) - point).norm());
    }
    return nearest;
}

}  // namespace posefusion
