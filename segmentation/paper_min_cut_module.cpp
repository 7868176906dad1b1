#include "engine/core/loaded_module.hpp"
#include "segmentation/paper_min_cut.hpp"

namespace posefusion {

PaperMinCut paper_min_cut(const std::vector<Eigen::Vector3f>& points, const std::vector<Eigen::Vector3f>& seeds,
                          const PaperMinCutConfig& config) {
    static PaperMinCutByPcl* const by_pcl =
        function_of_module<PaperMinCutByPcl>(POSEFUSION_PAPER_MIN_CUT_MODULE, "paper_min_cut_by_pcl");
    PaperMinCut result;
    by_pcl(points, seeds, config, result);
    return result;
}

}  // namespace posefusion
