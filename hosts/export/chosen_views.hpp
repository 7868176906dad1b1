#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hosts/export/keyframes.hpp"
#include "hosts/export/view_source.hpp"

/// The frames of a run that become views.
namespace posefusion {

struct ViewObserver {
    /// `what` is what is being done: "choosing views", "writing views".
    std::function<void(const std::string& what, std::size_t done, std::size_t total)> progress;
    std::function<void(const std::string&)> warning;
    std::function<bool()> cancelled = [] { return false; };
};

/// Warns of masks that are missing, and of frames that cannot be views.
/// @param consequence  of missing masks: "they are in the images without a mask"
void warn_of_what_is_missing(const FinishedRun& run, const ViewSource& views, const std::string& consequence,
                             const ViewObserver& observer);

/// Looks at every frame, see choose_keyframes(). One that cannot be read is no candidate.
/// @return positions in `views`; nullopt: cancelled
[[nodiscard]] std::optional<std::vector<std::size_t>> choose_views(const ViewSource& views,
                                                                   const KeyframeConfig& config,
                                                                   const ViewObserver& observer);

}  // namespace posefusion
