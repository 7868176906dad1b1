#pragma once
#include <cstdint>
#include <string>

namespace posefusion {

/// Join: of two pieces of map.
enum class LoopKind { Local, Global, Relocalisation, Join };

[[nodiscard]] constexpr const char* name_of(LoopKind kind) {
    switch (kind) {
        case LoopKind::Local:
            return "local";
        case LoopKind::Global:
            return "global";
        case LoopKind::Relocalisation:
            return "relocalisation";
        case LoopKind::Join:
            return "join";
    }
    return "";
}

/// An attempt to align the live image with an older part of the map.
struct LoopEvent {
    /// A loop was closed: map and trajectory agree with what was there before.
    [[nodiscard]] bool closes_loop() const { return accepted && (kind == LoopKind::Local || kind == LoopKind::Global); }

    std::uint32_t frame = 0;
    LoopKind kind = LoopKind::Local;
    std::uint32_t model_frame = 0;  ///< of the keyframe; local loops: median creation frame of the matched surfels
    bool accepted = false;
    std::string reason;      ///< why it was not accepted
    float overlap = 0;       ///< share of the image that shows the older part
    float inlier_ratio = 0;  ///< of the overlap
    float icp_rmse_m = 0, photometric_rmse = 0;
    float correlation = 0;  ///< of live and model intensities, -1..1; 1 where there is too little contrast to say
    double residual_before_m = 0;  ///< mean displacement of the older part against the live image, before ...
    double residual_after_m = 0;   ///< ... and after the deformation
    std::uint32_t nodes = 0;       ///< of the deformation graph; 0: nothing had to be deformed
    double milliseconds = 0;       ///< duration of the whole attempt, in which tracking waits
    double solve_milliseconds =
        0;  ///< ... of which for the graph: sampling, solving and preparing the deformation; 0 without a graph

    friend bool operator==(const LoopEvent&, const LoopEvent&) = default;
};

}  // namespace posefusion
