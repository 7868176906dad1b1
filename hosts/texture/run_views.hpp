#pragma once
#include "hosts/export/chosen_views.hpp"
#include "hosts/texture/texture_views.hpp"

namespace posefusion {

/// The chosen frames of a finished run, undistorted, with the masks that it saved. Throws Error: see ViewSource, or no
/// frame can be used.
[[nodiscard]] TextureViews views_of_run(const FinishedRun& run, const KeyframeConfig& config,
                                        const ViewObserver& observer);

}  // namespace posefusion
