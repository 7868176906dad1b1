#pragma once

/// The outcome of tracking a frame, and its names in statistics, Python, report and viewer.
namespace posefusion {

/// Failed: the pose of the previous frame is held, nothing is fused. Lost: failed for several frames in a row.
/// Relocalised: the pose was recovered by place recognition; fusion resumes with the next tracked frame.
enum class TrackingState { FirstFrame, Ok, Failed, Lost, Relocalised };

/// Whether the pose was determined in this frame, not just held.
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
