#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "engine/map/surfel.hpp"
#include "hosts/export/view.hpp"

namespace posefusion {

/// Writes views one after the other in the layout of a program.
class ViewWriter {
public:
    virtual ~ViewWriter() = default;
    /// Writes the images of a view. Throws Error, as finish() does.
    virtual void add(const View& view) = 0;
    /// Writes what is about all of them.
    virtual void finish() = 0;
};

/// What the views have in common.
struct Scene {
    Camera camera;               ///< of the views
    bool masked = false;         ///< it is known where people are: there is a mask with every view
    std::vector<Surfel> points;  ///< of the map, world frame
};

/// transforms.json with its images, depth, masks and points for nerfstudio (https://docs.nerf.studio/quickstart/
/// data_conventions.html): OpenGL's cameras (x right, y up, z back), pixel centres at halves, depth in millimetres.
/// @param folder  exists  @param scene  must outlive the writer, as for all of these
[[nodiscard]] std::unique_ptr<ViewWriter> make_nerfstudio_writer(const std::filesystem::path& folder,
                                                                 const Scene& scene);
/// Whether nerfstudio has a model for the lens.
[[nodiscard]] bool nerfstudio_knows(const LensCoefficients& lens);

/// images/, masks/ (IMAGE.png beside the name of the image, as COLMAP looks for them) and sparse/0/ with cameras,
/// images and points3D as text and binary (https://colmap.github.io/format.html).
[[nodiscard]] std::unique_ptr<ViewWriter> make_colmap_writer(const std::filesystem::path& folder, const Scene& scene);

}  // namespace posefusion
