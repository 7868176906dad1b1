#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "engine/slam/slam.hpp"
#include "tools/gpu_check/packed_recording.hpp"

namespace posefusion {

/// Milliseconds per frame: medians over a replay.
struct FrameTimes {
    double host = 0;                                     ///< from images in to pose out
    double gpu = 0;                                      ///< all stages
    std::vector<std::pair<std::string, double>> stages;  ///< on the GPU, in order of execution
};

struct Replay {
    std::vector<Eigen::Isometry3d> T_world_camera;  ///< per frame, as process() returned it
    std::uint32_t surfels = 0, stable_surfels = 0;  ///< after the last frame
    std::uint32_t lost = 0;                         ///< frames
    FrameTimes times;
};

/// Frames [begin, end) through `slam`. The first kWarmUp of them are not part of the times: drivers compile then.
[[nodiscard]] Replay replay(Slam& slam, const PackedRecording& recording, std::size_t begin, std::size_t end);
inline constexpr std::size_t kWarmUp = 3;

}  // namespace posefusion
