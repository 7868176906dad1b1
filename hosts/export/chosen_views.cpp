#include "hosts/export/chosen_views.hpp"

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"

namespace posefusion {

void warn_of_what_is_missing(const FinishedRun& run, const ViewSource& views, const std::string& consequence,
                             const ViewObserver& observer) {
    for (const std::string& warning : run.warnings) observer.warning(warning);
    if (!views.masked() && run.looked_for_people())
        observer.warning(run.folder.string() + ": has no masks of people and movers, so " + consequence +
                         "; run the recording again with --save-masks");
    if (views.unknown() > 0)
        observer.warning(counted(views.unknown(), "pose") + " of the trajectory belong to no frame of " +
                         views.recording().location() + " and are left out");
    if (views.without_mask() > 0)
        observer.warning(counted(views.without_mask(), "frame") + " without a mask of people are left out");
}

std::optional<std::vector<std::size_t>> choose_views(const ViewSource& views, const KeyframeConfig& config,
                                                     const ViewObserver& observer) {
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

}  // namespace posefusion
