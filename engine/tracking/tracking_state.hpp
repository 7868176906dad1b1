#pragma once

/// What becomes of a frame, and the words for it that statistics, Python, report and viewer use.
namespace posefusion {

/// Failed: the pose of the frame before is held, nothing is fused. Lost: so for several frames. Relocalised: the pose
/// was found again by place recognition; fusion resumes when the next frame tracks.
enum class TrackingState { FirstFrame, Ok, Failed, Lost, Relocalised };

/// Whether the pose was found in this frame; if not it is only held.
[[nodiscard]] constexpr bool has_pose(TrackingState state) {
    return state != TrackingState::Failed && state != TrackingState::Lost;
}

[[nodiscard]] constexpr const char* name_of(TrackingState state) {
    switch (state) {
        case TrackingState::FirstFrame:
            return "first";
        case TrackingState::Ok:
            return "ok";
        case TrackingState::Failed:
            return "failed";
        case TrackingState::Lost:
            return "lost";
        case TrackingState::Relocalised:
            return "relocalised";
    }
    return "";
}

}  // namespace posefusion
