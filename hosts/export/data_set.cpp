#include "hosts/export/data_set.hpp"

#include <cmath>
#include <memory>
#include <optional>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/export/scene_points.hpp"
#include "hosts/export/unfinished_folder.hpp"
#include "hosts/export/view_source.hpp"
#include "hosts/export/view_writer.hpp"

namespace posefusion {
namespace {

void warn_of_what_is_missing(const FinishedRun& run, const ViewSource& views, const DataSetObserver& observer) {
    for (const std::string& warning : run.warnings) observer.warning(warning);
    if (!views.masked() && run.looked_for_people())
        observer.warning(run.folder.string() +
                         ": has no masks of people and movers, so they are in the images without a mask; run the "
                         "recording again with --save-masks");
    if (views.unknown() > 0)
        observer.warning(counted(views.unknown(), "pose") + " of the trajectory belong to no frame of " +
                         views.recording().location() + " and are left out");
    if (views.without_mask() > 0)
        observer.warning(counted(views.without_mask(), "frame") + " without a mask of people are left out");
}

/// Where a frame cannot be read, it is no candidate. nullopt: cancelled.
std::optional<std::vector<std::size_t>> choose_views(const ViewSource& views, const KeyframeConfig& config,
                                                     const DataSetObserver& observer) {
    std::vector<KeyframeCandidate> candidates;
    std::vector<std::size_t> places;
    BadFrames bad_frames(views.size());
    for (std::size_t i = 0; i < views.size(); ++i) {
        if (observer.cancelled()) return std::nullopt;
        try {
            const View view = views.load(i);
            candidates.push_back({view.T_world_camera, sharpness(view.color, view.people)});
            places.push_back(i);
            bad_frames.good();
        } catch (const SourceLost&) {
            throw;
        } catch (const Error& error) {
            if (const std::string text = bad_frames.bad(error.what()); !text.empty()) observer.warning(text);
        }
        observer.progress("choosing views", i + 1, views.size());
    }
    std::vector<std::size_t> chosen;
    for (const std::size_t i : choose_keyframes(candidates, config)) chosen.push_back(places[i]);
    return chosen;
}

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
                        const DataSetObserver& observer) {
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
    warn_of_what_is_missing(run, *views, observer);

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
