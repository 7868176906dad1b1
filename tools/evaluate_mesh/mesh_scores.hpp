#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "tools/evaluate_objects/object_truth.hpp"

/// How near a mesh is to the true surface, and how much of the surface it has (Seitz et al., "A Comparison and
/// Evaluation of Multi-View Stereo Reconstruction Algorithms", CVPR 2006).
namespace posefusion {

struct MeshScoreConfig {
    float within = 0.01f;    ///< metres: what is nearer counts as right
    float invented = 0.05f;  ///< metres: what is farther is no measured surface at all
    float spacing = 0.01f;   ///< metres between the points at which surfaces are compared
};

struct MeshScores {
    std::size_t triangles = 0;
    double area = 0;           ///< of the mesh, m^2
    double mean_distance = 0;  ///< from the mesh to the true surface, metres; what is invented counts as that limit
    double accuracy = 0;       ///< share of the mesh within MeshScoreConfig::within of the true surface
    double invented = 0;       ///< share of the mesh farther than MeshScoreConfig::invented from it
    double completeness = 0;   ///< share of the seen true surface within MeshScoreConfig::within of the mesh
};

/// Points spread evenly over a surface, one for spacing^2 of it; the same mesh gives the same points.
[[nodiscard]] std::vector<Eigen::Vector3f> spread_points(const TrueMesh& mesh, float spacing);

/// @param truth  the true surface  @param seen  points of it that the camera has seen
/// @param mesh   in the frame of the truth
[[nodiscard]] MeshScores score_mesh(const TrueMesh& truth, const std::vector<Eigen::Vector3f>& seen,
                                    const TrueMesh& mesh, const MeshScoreConfig& config = {});

}  // namespace posefusion
