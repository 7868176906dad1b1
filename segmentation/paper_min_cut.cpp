#include "segmentation/paper_min_cut.hpp"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/segmentation/min_cut_segmentation.h>

namespace posefusion {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

Cloud::Ptr to_cloud(const std::vector<Eigen::Vector3f>& points) {
    Cloud::Ptr cloud(new Cloud);
    cloud->reserve(points.size());
    for (const Eigen::Vector3f& p : points) cloud->push_back({p.x(), p.y(), p.z()});
    return cloud;
}

}  // namespace

extern "C" void paper_min_cut_by_pcl(const std::vector<Eigen::Vector3f>& points,
                                     const std::vector<Eigen::Vector3f>& seeds, const PaperMinCutConfig& config,
                                     PaperMinCut& result) {
    result.foreground.assign(points.size(), false);
    if (points.empty() || seeds.empty()) return;
    pcl::MinCutSegmentation<pcl::PointXYZ> segmentation;
    segmentation.setInputCloud(to_cloud(points));
    segmentation.setForegroundPoints(to_cloud(seeds));
    segmentation.setSigma(config.sigma);    // eq. (2)
    segmentation.setRadius(config.radius);  // eq. (3)
    segmentation.setNumberOfNeighbours(static_cast<unsigned>(config.neighbours));
    segmentation.setSourceWeight(config.source_weight);
    std::vector<pcl::PointIndices> clusters;  // background, foreground
    segmentation.extract(clusters);
    result.max_flow = segmentation.getMaxFlow();
    if (clusters.size() == 2)
        for (const int i : clusters[1].indices) result.foreground[static_cast<std::size_t>(i)] = true;
}

}  // namespace posefusion
