#include "hosts/texture/run_views.hpp"

#include <memory>

#include "engine/core/error.hpp"

namespace posefusion {

TextureViews views_of_run(const FinishedRun& run, const KeyframeConfig& config, const ViewObserver& observer) {
    const auto source = std::make_shared<ViewSource>(run, true);
    warn_of_what_is_missing(run, *source, "they can be in the texture", observer);
    const auto chosen = choose_views(*source, config, observer);
    if (!chosen || chosen->empty())
        throw Error(run.folder.string() +
                    ": no frame of the run can be used for a texture; the warnings above say why");
    return {source->camera().intrinsics, chosen->size(),
            [source, chosen = *chosen](std::size_t i) { return source->load(chosen[i]); }};
}

}  // namespace posefusion
