#pragma once
#include "tools/evaluate_objects/object_truth.hpp"

namespace posefusion {

/// Distances from points to the triangles of a mesh.
class TriangleDistance {
public:
    explicit TriangleDistance(const TrueMesh& mesh);
    /// To the nearest triangle, metres. The mesh has at least one.
    [[nodiscard]] float operator()(const Eigen::Vector3f& point) const;

private:
    struct Face {
        Eigen::Vector3f a, b, c, middle;
        float radius;  ///< of the sphere about the middle that holds it
    };
    std::vector<Face> faces_;
};

/// Ericson, "Real-Time Collision Detection", 2005, 5.1.5.
[[nodiscard]] Eigen::Vector3f closest_on_triangle(const Eigen::Vector3f& p, const Eigen::Vector3f& a,
                                                  const Eigen::Vector3f& b, const Eigen::Vector3f& c);

}  // namespace posefusion
