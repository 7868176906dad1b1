#include "tools/evaluate_mesh/mesh_scores.hpp"

#include <cmath>

#include "engine/core/error.hpp"
#include "tools/evaluate_mesh/surface_index.hpp"

namespace posefusion {
namespace {

/// R2, the two-dimensional golden ratio (Roberts 2018): even without a pattern.
constexpr double kFirst = 0.7548776662466927, kSecond = 0.5698402909980532;

double fraction(double value) { return value - std::floor(value); }

}  // namespace

std::vector<Eigen::Vector3f> spread_points(const TrueMesh& mesh, float spacing) {
    std::vector<Eigen::Vector3f> points;
    const double cell = static_cast<double>(spacing) * static_cast<double>(spacing);
    double due = 0.5;  // points; what a triangle is too small for is left to the next
    std::size_t number = 0;
    for (const auto& [i, j, k] : mesh.faces) {
        const Eigen::Vector3f &a = mesh.vertices[i], &b = mesh.vertices[j], &c = mesh.vertices[k];
        due += static_cast<double>((b - a).cross(c - a).norm()) / 2 / cell;
        for (; due >= 1; due -= 1, ++number) {
            double u = fraction(kFirst * static_cast<double>(number)),
                   v = fraction(kSecond * static_cast<double>(number));
            if (u + v > 1) u = 1 - u, v = 1 - v;
            points.push_back(a + static_cast<float>(u) * (b - a) + static_cast<float>(v) * (c - a));
        }
    }
    return points;
}

MeshScores score_mesh(const TrueMesh& truth, const std::vector<Eigen::Vector3f>& seen, const TrueMesh& mesh,
                      const MeshScoreConfig& config) {
    MeshScores scores;
    scores.triangles = mesh.faces.size();
    const std::vector<Eigen::Vector3f> points = spread_points(mesh, config.spacing);
    if (points.empty()) throw Error("the mesh has no area");
    if (seen.empty()) throw Error("nothing of the true surface was seen");
    const double per_point = static_cast<double>(config.spacing) * static_cast<double>(config.spacing);
    scores.area = static_cast<double>(points.size()) * per_point;

    const SurfaceIndex true_surface(truth, config.invented), own(mesh, config.invented);
    double sum = 0;
    std::size_t right = 0, invented = 0, complete = 0;
    for (const Eigen::Vector3f& point : points) {
        const auto distance = true_surface.distance(point);
        sum += static_cast<double>(distance.value_or(config.invented));
        if (!distance)
            ++invented;
        else if (*distance <= config.within)
            ++right;
    }
    for (const Eigen::Vector3f& point : seen) {
        const auto distance = own.distance(point);
        if (distance && *distance <= config.within) ++complete;
    }
    const auto count = static_cast<double>(points.size());
    scores.mean_distance = sum / count;
    scores.accuracy = static_cast<double>(right) / count;
    scores.invented = static_cast<double>(invented) / count;
    scores.completeness = static_cast<double>(complete) / static_cast<double>(seen.size());
    return scores;
}

}  // namespace posefusion
