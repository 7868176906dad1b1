#include "hosts/export/data_set.hpp"

#include <cmath>
#include <memory>
#include <optional>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/export/chosen_views.hpp"
#include "hosts/export/scene_points.hpp"
#include "hosts/export/unfinished_folder.hpp"
#include "hosts/export/view_source.hpp"
#include "hosts/export/view_writer.hpp"

namespace posefusion {
namespace {

/// A data set that is being written.
struct Writing {
    UnfinishedFolder folder;
    std::unique_ptr<ViewWriter> writer;

    template <class Make>
    Writing(const std::filesystem::path& place, const Scene& scene, Make&& make)
        : folder(place), writer(make(folder.path(), scene)) {}
};

}  // namespace

void check(const DataSetConfig& config) {
    const auto is_length = [](float value) { return value > 0 && std::isfinite(value); };
    if (!is_length(config.keyframes.distance)) throw Error("the distance between views must be above 0 m");
    if (!is_length(config.keyframes.angle)) throw Error("the angle between views must be above 0 degrees");
    if (config.points == 0) throw Error("the number of points must be at least 1");
    std::error_code error;
    if (config.wanted() && config.nerfstudio.lexically_normal() == config.colmap.lexically_normal())
        throw Error(config.colmap.string() + ": --nerfstudio and --colmap need a folder each");
}

DataSet write_data_sets(const FinishedRun& run, const std::vector<Surfel>& map, const DataSetConfig& config,
                        const ViewObserver& observer) {
    bool undistort = config.undistort;
    std::optional<ViewSource> views(std::in_place, run, undistort);
    if (!undistort && !config.nerfstudio.empty() && !nerfstudio_knows(views->camera().distortion)) {
        observer.warning("nerfstudio has no model for this lens (k4, k5, k6); the images are written undistorted");
        undistort = true;
        views.emplace(run, undistort);
    }
    Scene scene{views->camera(), views->masked(), evenly_spread(map, config.points)};
    std::vector<std::unique_ptr<Writing>> sets;
    if (!config.nerfstudio.empty())
        sets.push_back(std::make_unique<Writing>(config.nerfstudio, scene, make_nerfstudio_writer));
    if (!config.colmap.empty()) sets.push_back(std::make_unique<Writing>(config.colmap, scene, make_colmap_writer));
    warn_of_what_is_missing(run, *views, "they are in the images without a mask", observer);

    DataSet result{views->size(), 0, scene.points.size()};
    const auto chosen = choose_views(*views, config.keyframes, observer);
    result.cancelled = !chosen;
    for (std::size_t i = 0; !result.cancelled && i < chosen->size(); ++i) {
        const View view = views->load((*chosen)[i]);
        for (const auto& set : sets) set->writer->add(view);
        observer.progress("writing views", ++result.views, chosen->size());
        result.cancelled = observer.cancelled();
    }
    if (result.cancelled) return result;
    if (result.views == 0)
        throw Error(run.folder.string() + ": no frame of the run can be exported; the warnings above say why");
    for (const auto& set : sets) set->writer->finish();
    for (const auto& set : sets) set->folder.finish();
    return result;
}

}  // namespace posefusion
