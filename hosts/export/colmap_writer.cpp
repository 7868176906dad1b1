#include "hosts/export/colmap_model.hpp"
#include "hosts/export/scene_points.hpp"
#include "hosts/export/view_writer.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/io/output_file.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

/// Points that say in which images they are seen, as COLMAP's dense stereo needs to choose pairs of images. A few
/// hundred to a thousand are in an image then, as in COLMAP's own models; all of the points would be a hundred
/// megabytes of text. The others have no track.
constexpr std::size_t kTrackedPoints = 5000;

class ColmapWriter final : public ViewWriter {
public:
    ColmapWriter(fs::path folder, const Scene& scene)
        : folder_(std::move(folder)), masked_(scene.masked), tracked_(evenly_spread(scene.points, kTrackedPoints)) {
        prepare_output_folder(folder_ / "images");
        if (masked_) prepare_output_folder(folder_ / "masks");
        model_.camera = scene.camera;
        // those with a track first
        for (const Surfel& s : tracked_) model_.points.push_back({s.position, s.color});
        std::size_t next = 0;  // both are in the same order
        for (const Surfel& s : scene.points) {
            if (next < tracked_.size() && tracked_[next].position == s.position)
                ++next;
            else
                model_.points.push_back({s.position, s.color});
        }
    }

    void add(const View& view) override {
        const std::string file = view.name + ".png";
        write_png(folder_ / "images" / file, view.color);
        if (masked_) write_labels(folder_ / "masks" / (file + ".png"), usable_pixels(view));
        ColmapImage image{file, view.T_world_camera, {}};
        for (const PointInView& seen : points_in_view(tracked_, view, model_.camera))
            image.points.push_back({seen.pixel, seen.point});
        model_.images.push_back(std::move(image));
    }

    void finish() override {
        const fs::path sparse = folder_ / "sparse" / "0";
        prepare_output_folder(sparse);
        write_colmap_model(sparse, model_);
    }

private:
    fs::path folder_;
    bool masked_;
    std::vector<Surfel> tracked_;
    ColmapModel model_;
};

}  // namespace

std::unique_ptr<ViewWriter> make_colmap_writer(const fs::path& folder, const Scene& scene) {
    return std::make_unique<ColmapWriter>(folder, scene);
}

}  // namespace posefusion
