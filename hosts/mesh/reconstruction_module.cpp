#include "engine/core/loaded_module.hpp"
#include "hosts/mesh/reconstruction.hpp"
#include "hosts/mesh/simplification.hpp"

namespace posefusion {

Mesh reconstruct_mesh(const std::vector<Surfel>& surfels, const MeshConfig& config,
                      const std::function<void(const std::string&)>& progress) {
    static ReconstructMeshByPcl* const by_pcl =
        function_of_module<ReconstructMeshByPcl>(POSEFUSION_RECONSTRUCTION_MODULE, "reconstruct_mesh_by_pcl");
    Mesh mesh;
    by_pcl(surfels, config, progress, mesh);
    if (config.max_triangles == 0 || mesh.faces.size() <= config.max_triangles) return mesh;
    progress("simplifying " + std::to_string(mesh.faces.size()) + " triangles");
    return simplified(mesh, config.max_triangles);
}

}  // namespace posefusion
