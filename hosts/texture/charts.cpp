#include "hosts/texture/charts.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <tuple>
#include <unordered_set>

#include "hosts/texture/triangle_raster.hpp"

namespace posefusion {
namespace {

constexpr float kSteepest = 0.64f;         // cosine to the axis of a chart, 50 degrees: stretched by 1.6
constexpr float kSameSurface = 0.87f;      // cosine, 30 degrees, to the first triangle: what its axis is the mean of
constexpr std::size_t kFacesOfAxis = 500;  // a hand's width of a mesh with the usual resolution
constexpr int kRotations = 18;             // that are tried for the smallest rectangle, in steps of 5 degrees
constexpr std::uint32_t kNoFace = std::numeric_limits<std::uint32_t>::max();

using FaceNeighbours = std::vector<std::array<std::uint32_t, 3>>;

/// The faces over the three edges of each face; of an edge with more than two faces only pairs.
FaceNeighbours face_neighbours(const Mesh& mesh) {
    struct Edge {
        std::uint32_t low, high, face, side;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * mesh.faces.size());
    for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t a = mesh.faces[f][k], b = mesh.faces[f][(k + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), f, k});
        }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return std::tie(a.low, a.high, a.face) < std::tie(b.low, b.high, b.face);
    });
    FaceNeighbours neighbours(mesh.faces.size(), {kNoFace, kNoFace, kNoFace});
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
        const Edge &a = edges[i], &b = edges[i + 1];
        if (a.low != b.low || a.high != b.high) continue;
        neighbours[a.face][a.side] = b.face;
        neighbours[b.face][b.side] = a.face;
        ++i;
    }
    return neighbours;
}

/// Length: twice the area.
std::vector<Eigen::Vector3f> face_normals(const Mesh& mesh) {
    std::vector<Eigen::Vector3f> normals;
    normals.reserve(mesh.faces.size());
    for (const auto& face : mesh.faces) {
        const Eigen::Vector3f& a = mesh.vertices[face[0]].position;
        normals.push_back((mesh.vertices[face[1]].position - a).cross(mesh.vertices[face[2]].position - a));
    }
    return normals;
}

/// Rotates the axes so that the rectangle around the chart is the smallest.
void fit_rectangle(Chart& chart, const Mesh& mesh) {
    float least_area = std::numeric_limits<float>::infinity();
    const Eigen::Matrix<float, 2, 3> first = chart.axes;
    for (int i = 0; i < kRotations; ++i) {
        const float angle = static_cast<float>(i) * std::numbers::pi_v<float> / 2 / kRotations;
        const Eigen::Matrix<float, 2, 3> axes = Eigen::Rotation2Df(angle).toRotationMatrix() * first;
        Eigen::Vector2f low = Eigen::Vector2f::Constant(std::numeric_limits<float>::infinity()), high = -low;
        for (const std::uint32_t face : chart.faces) {
            for (const std::uint32_t corner : mesh.faces[face]) {
                const Eigen::Vector2f p = axes * mesh.vertices[corner].position;
                low = low.cwiseMin(p);
                high = high.cwiseMax(p);
            }
        }
        const Eigen::Vector2f size = high - low;
        if (!(size.prod() < least_area)) continue;
        least_area = size.prod();
        chart.axes = axes;
        chart.corner = low;
        chart.size = size;
    }
}

class ChartCutter {
public:
    ChartCutter(const Mesh& mesh, float texel, float widest)
        : mesh_(mesh),
          texel_(texel),
          widest_(widest),
          neighbours_(face_neighbours(mesh)),
          normals_(face_normals(mesh)),
          chart_of_(mesh.faces.size(), kNoFace),
          visited_by_(mesh.faces.size(), kNoFace) {}

    std::vector<Chart> cut() {
        std::vector<Chart> charts;
        for (std::uint32_t face = 0; face < mesh_.faces.size(); ++face) {
            if (chart_of_[face] != kNoFace) continue;
            charts.push_back(grow(face, static_cast<std::uint32_t>(charts.size())));
            fit_rectangle(charts.back(), mesh_);
        }
        return charts;
    }

private:
    /// The mean normal of the free surface around a face.
    [[nodiscard]] Eigen::Vector3f axis_of(std::uint32_t seed) {
        const Eigen::Vector3f direction = normals_[seed].stableNormalized();
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        std::deque<std::uint32_t> queue{seed};
        std::size_t taken = 0;
        visited_by_[seed] = seed;
        while (!queue.empty() && taken < kFacesOfAxis) {
            const std::uint32_t face = queue.front();
            queue.pop_front();
            sum += normals_[face];
            ++taken;
            for (const std::uint32_t next : neighbours_[face]) {
                if (next == kNoFace || chart_of_[next] != kNoFace || visited_by_[next] == seed) continue;
                visited_by_[next] = seed;
                if (normals_[next].dot(direction) > kSameSurface * normals_[next].norm()) queue.push_back(next);
            }
        }
        return sum.squaredNorm() > 0 ? Eigen::Vector3f(sum.normalized()) : Eigen::Vector3f(Eigen::Vector3f::UnitZ());
    }

    Chart grow(std::uint32_t seed, std::uint32_t number) {
        Chart chart;
        const Eigen::Vector3f axis = axis_of(seed);
        chart.axes.row(0) = axis.unitOrthogonal().transpose();
        chart.axes.row(1) = axis.cross(axis.unitOrthogonal()).transpose();
        const Eigen::Vector2f origin = chart.axes * mesh_.vertices[mesh_.faces[seed][0]].position;
        low_ = high_ = Eigen::Vector2f::Zero();
        covered_.clear();
        std::deque<std::uint32_t> queue{seed};
        while (!queue.empty()) {
            const std::uint32_t face = queue.front();
            queue.pop_front();
            if (chart_of_[face] != kNoFace) continue;
            const bool faces_axis = normals_[face].dot(axis) >= kSteepest * normals_[face].norm();
            if (face != seed && !faces_axis) continue;
            if (!takes_place(face, chart.axes, origin) && face != seed) continue;
            chart_of_[face] = number;
            chart.faces.push_back(face);
            for (const std::uint32_t next : neighbours_[face])
                if (next != kNoFace && chart_of_[next] == kNoFace) queue.push_back(next);
        }
        return chart;
    }

    /// Occupies the texels of a face unless one of them is taken, or the chart becomes too wide.
    bool takes_place(std::uint32_t face, const Eigen::Matrix<float, 2, 3>& axes, const Eigen::Vector2f& origin) {
        Triangle2 triangle;
        Eigen::Vector2f low = low_, high = high_;
        for (std::size_t k = 0; k < 3; ++k) {
            const Eigen::Vector2f p = axes * mesh_.vertices[mesh_.faces[face][k]].position - origin;
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
            triangle[k] = p / texel_;
        }
        if ((high - low).maxCoeff() > widest_) return false;
        Eigen::Vector2f least = triangle[0], most = triangle[0];
        for (const Eigen::Vector2f& p : triangle) {
            least = least.cwiseMin(p);
            most = most.cwiseMax(p);
        }
        const Eigen::Vector2f first(std::floor(least.x()), std::floor(least.y()));
        Triangle2 here;
        for (std::size_t k = 0; k < 3; ++k) here[k] = triangle[k] - first;
        texels_.clear();
        bool free = true;
        rasterise(here, static_cast<int>(most.x() - first.x()) + 2, static_cast<int>(most.y() - first.y()) + 2,
                  [&](int u, int v, const Eigen::Vector3f&) {
                      const auto x = static_cast<std::uint32_t>(static_cast<int>(first.x()) + u);
                      const auto y = static_cast<std::uint32_t>(static_cast<int>(first.y()) + v);
                      texels_.push_back(std::uint64_t{x} << 32 | y);
                      free = free && !covered_.contains(texels_.back());
                  });
        if (!free) return false;
        covered_.insert(texels_.begin(), texels_.end());
        low_ = low;
        high_ = high;
        return true;
    }

    const Mesh& mesh_;
    float texel_, widest_;
    FaceNeighbours neighbours_;
    std::vector<Eigen::Vector3f> normals_;
    std::vector<std::uint32_t> chart_of_, visited_by_;
    Eigen::Vector2f low_, high_;                 // of the chart that grows
    std::unordered_set<std::uint64_t> covered_;  // its texels
    std::vector<std::uint64_t> texels_;
};

}  // namespace

std::vector<Chart> cut_into_charts(const Mesh& mesh, float texel, float widest) {
    return ChartCutter(mesh, texel, widest).cut();
}

}  // namespace posefusion
