#pragma once
#include <Eigen/Core>
#include <vector>

/// The min-cut segmentation of the paper, as PCL implements it (Golovinskiy and Funkhouser 2009).
namespace posefusion {

struct PaperMinCutConfig {
    float sigma = 0.25f;         ///< eq. (2): C = exp(-(length / sigma)^2), metres
    float radius = 0.20f;        ///< eq. (3): P = sqrt((x - Jx)^2 + (y - Jy)^2) / radius, metres
    int neighbours = 14;         ///< edges per point, the point itself included (PCL's default)
    float source_weight = 0.8f;  ///< edge of every point to the source (PCL's default)
};

struct PaperMinCut {
    std::vector<bool> foreground;  ///< per point
    double max_flow = 0;           ///< energy of the cut
};

/// Of the module with PCL, which is loaded when it is first needed; see paper_min_cut().
using PaperMinCutByPcl = void(const std::vector<Eigen::Vector3f>& points, const std::vector<Eigen::Vector3f>& seeds,
                              const PaperMinCutConfig& config, PaperMinCut& result);
extern "C" PaperMinCutByPcl paper_min_cut_by_pcl;

/// Cuts a cloud (camera coordinates, metres) around the seeds J, the points known to be foreground. Nothing is
/// foreground without seeds. Throws Error if the module cannot be loaded.
[[nodiscard]] PaperMinCut paper_min_cut(const std::vector<Eigen::Vector3f>& points,
                                        const std::vector<Eigen::Vector3f>& seeds, const PaperMinCutConfig& config);

}  // namespace posefusion
