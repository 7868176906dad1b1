#include "hosts/mesh/reconstruction.hpp"

#include <fcntl.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>
#include <pcl/surface/poisson.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr std::size_t kFewestSurfels = 100;
constexpr int kMinDepth = 5;     ///< of the octree
constexpr int kMaxDepth = 11;    ///< takes several GB
constexpr float kMargin = 1.1f;  ///< side of the octree over that of the surfels (PCL's default)
constexpr float kUnitTolerance = 0.1f;
constexpr int kMostParts = 16;   ///< of the side of a triangle, in the search for holes under it
constexpr float kWidest = 1e5f;  ///< metres; anything wider is not a map

using Points = pcl::PointCloud<pcl::PointXYZ>;
using OrientedPoints = pcl::PointCloud<pcl::PointNormal>;

bool usable(const Surfel& s) {
    return s.position.allFinite() && s.normal.allFinite() && std::abs(s.normal.norm() - 1) < kUnitTolerance;
}

std::vector<Surfel> usable_surfels(const std::vector<Surfel>& surfels) {
    std::vector<Surfel> good;
    std::copy_if(surfels.begin(), surfels.end(), std::back_inserter(good), usable);
    if (good.size() < kFewestSurfels) {
        throw Error("only " + std::to_string(good.size()) +
                    " surfels with normals are left, too few for a surface; lower --min-confidence");
    }
    return good;
}

/// Cells of the octree's finest level are no larger than `resolution`.
int octree_depth(const std::vector<Surfel>& surfels, float resolution) {
    if (!(resolution > 0)) throw Error("the resolution of a mesh must be above 0 m");
    Eigen::Vector3f least = surfels.front().position, most = least;
    for (const Surfel& s : surfels) {
        least = least.cwiseMin(s.position);
        most = most.cwiseMax(s.position);
    }
    const float side = kMargin * (most - least).maxCoeff();
    if (!(side < kWidest))
        throw Error("surfels of the map are more than 100 km apart, it is damaged; use another copy");
    const int depth = static_cast<int>(std::ceil(std::log2(side / resolution)));
    if (depth > kMaxDepth) {
        const auto millimetres = static_cast<int>(std::ceil(1000 * side / std::exp2(kMaxDepth)));
        throw Error("the map is " + std::to_string(static_cast<int>(std::ceil(side))) +
                    " m wide, too much for this resolution; the finest is " + std::to_string(millimetres) + " mm");
    }
    return std::max(depth, kMinDepth);
}

struct PoissonSurface {
    OrientedPoints vertices;
    std::vector<pcl::Vertices> faces;
};

/// PCL's Poisson reconstruction prints remarks on the standard output stream, where results belong; while one of these
/// lives, they go nowhere.
class Muted {
public:
    Muted() : stdout_(dup(STDOUT_FILENO)) {
        std::fflush(stdout);
        const int nowhere = open("/dev/null", O_WRONLY);
        dup2(nowhere, STDOUT_FILENO);
        close(nowhere);
    }
    ~Muted() {
        std::fflush(stdout);
        dup2(stdout_, STDOUT_FILENO);
        close(stdout_);
    }
    Muted(const Muted&) = delete;
    Muted& operator=(const Muted&) = delete;

private:
    int stdout_;
};

PoissonSurface poisson(const std::vector<Surfel>& surfels, int depth) {
    const auto cloud = std::make_shared<OrientedPoints>();
    cloud->reserve(surfels.size());
    for (const Surfel& s : surfels) {
        pcl::PointNormal point;
        point.getVector3fMap() = s.position;
        point.getNormalVector3fMap() = s.normal.normalized();
        cloud->push_back(point);
    }
    pcl::Poisson<pcl::PointNormal> method;
    method.setDepth(depth);
    method.setScale(kMargin);
    method.setThreads(1);  // same input, same bytes
    method.setInputCloud(cloud);
    PoissonSurface surface;
    const Muted muted;
    method.reconstruct(surface.vertices, surface.faces);
    return surface;
}

/// From the disc of a surfel.
float distance_from(const Surfel& surfel, const Eigen::Vector3f& point) {
    const Eigen::Vector3f offset = point - surfel.position;
    const float height = offset.dot(surfel.normal);
    const float beside = std::max(0.0f, (offset - height * surfel.normal).norm() - surfel.radius);
    return std::hypot(height, beside);
}

/// The surfels by place.
class Neighbourhood {
public:
    Neighbourhood(const std::vector<Surfel>& surfels, const MeshConfig& config)
        : surfels_(surfels), config_(config), reach_(config.trim.value_or(2 * config.resolution)) {
        const auto points = std::make_shared<Points>();
        points->reserve(surfels.size());
        for (const Surfel& s : surfels) points->push_back({s.position.x(), s.position.y(), s.position.z()});
        tree_.setInputCloud(points);
    }

    /// Is it where something was measured?
    [[nodiscard]] bool supports(const Eigen::Vector3f& place) {
        const pcl::PointXYZ point(place.x(), place.y(), place.z());
        tree_.nearestKSearch(point, config_.color_neighbours, indices_, squared_distances_);
        return std::any_of(indices_.begin(), indices_.end(), [&](auto i) {
            return distance_from(surfels_[static_cast<std::size_t>(i)], place) <= reach_;
        });
    }

    /// The same for all of a triangle: a large one may span a hole between surfels at its corners.
    [[nodiscard]] bool supports(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
        const float longest = std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()});
        if (longest <= reach_) return true;  // its corners are supported
        const int parts = std::min(kMostParts, static_cast<int>(std::ceil(longest / reach_)));
        for (int i = 0; i <= parts; ++i) {
            for (int k = 0; k <= parts - i; ++k) {
                const float s = static_cast<float>(i) / static_cast<float>(parts);
                const float t = static_cast<float>(k) / static_cast<float>(parts);
                if (!supports(a + s * (b - a) + t * (c - a))) return false;
            }
        }
        return true;
    }

    /// @return false: no surfel is near
    bool paint(MeshVertex& vertex) {
        if (!supports(vertex.position)) return false;
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        float weights = 0;
        for (std::size_t i = 0; i < indices_.size(); ++i) {
            const Surfel& s = surfels_[static_cast<std::size_t>(indices_[i])];
            const float softening = config_.resolution * config_.resolution / 4;
            const float weight = std::max(s.confidence, 1.0f) / (squared_distances_[i] + softening);
            sum += weight * Eigen::Vector3f(s.color.r, s.color.g, s.color.b);
            weights += weight;
        }
        const Eigen::Vector3f color = sum / weights;
        const auto byte = [](float value) {
            return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0l, 255l));
        };
        vertex.color = {byte(color.x()), byte(color.y()), byte(color.z())};
        return true;
    }

private:
    const std::vector<Surfel>& surfels_;
    const MeshConfig& config_;
    float reach_;  ///< metres
    pcl::KdTreeFLANN<pcl::PointXYZ> tree_;
    pcl::Indices indices_;
    std::vector<float> squared_distances_;
};

}  // namespace

extern "C" void reconstruct_mesh_by_pcl(const std::vector<Surfel>& surfels, const MeshConfig& config,
                                        const std::function<void(const std::string&)>& progress, Mesh& mesh) {
    const std::vector<Surfel> good = usable_surfels(surfels);
    const int depth = octree_depth(good, config.resolution);
    progress("reconstructing the surface through " + std::to_string(good.size()) + " surfels, octree of depth " +
             std::to_string(depth));
    const PoissonSurface surface = poisson(good, depth);

    progress("cutting off what no surfel supports from " + std::to_string(surface.faces.size()) +
             " triangles, painting the rest");
    constexpr std::uint32_t kCutOff = std::numeric_limits<std::uint32_t>::max(), kUnused = kCutOff - 1;
    std::vector<MeshVertex> vertices(surface.vertices.size());
    std::vector<std::uint32_t> number(vertices.size(), kCutOff);  // in the resulting mesh
    Neighbourhood near(good, config);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        vertices[i].position = surface.vertices[i].getVector3fMap();
        if (near.paint(vertices[i])) number[i] = kUnused;
    }
    mesh = {};
    for (const pcl::Vertices& face : surface.faces) {
        const bool triangle = face.vertices.size() == 3;
        if (!triangle || std::any_of(face.vertices.begin(), face.vertices.end(),
                                     [&](auto v) { return number[static_cast<std::size_t>(v)] == kCutOff; }))
            continue;
        const auto corner = [&](std::size_t k) {
            return vertices[static_cast<std::size_t>(face.vertices[k])].position;
        };
        if (!near.supports(corner(0), corner(1), corner(2))) continue;
        std::array<std::uint32_t, 3> corners{};
        for (std::size_t k = 0; k < corners.size(); ++k) {
            const auto v = static_cast<std::size_t>(face.vertices[k]);
            if (number[v] == kUnused) {
                number[v] = static_cast<std::uint32_t>(mesh.vertices.size());
                mesh.vertices.push_back(vertices[v]);
            }
            corners[k] = number[v];
        }
        mesh.faces.push_back(corners);
    }
    if (mesh.faces.empty()) throw Error("no surface was found through the surfels; a larger --resolution may help");
}

}  // namespace posefusion
