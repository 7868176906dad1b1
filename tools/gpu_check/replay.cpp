#include "tools/gpu_check/replay.hpp"

#include "engine/core/median.hpp"
#include "engine/core/stopwatch.hpp"

namespace posefusion {

Replay replay(Slam& slam, const PackedRecording& recording, std::size_t begin, std::size_t end) {
    Replay result;
    std::vector<double> host, gpu;
    std::vector<std::string> order;
    std::map<std::string, std::vector<double>> stages;
    for (std::size_t i = begin; i < end; ++i) {
        const PackedFrame& frame = recording.frames[i];
        const Stopwatch watch;
        const FrameResult now = slam.process(frame.color, frame.depth, frame.labels);
        const double milliseconds = watch.milliseconds();
        result.T_world_camera.push_back(now.T_world_camera);
        result.surfels = now.surfels;
        result.stable_surfels = now.stable_surfels;
        if (!has_pose(now.tracking)) ++result.lost;
        if (i < begin + kWarmUp) continue;
        host.push_back(milliseconds);
        gpu.push_back(0);
        std::map<std::string, double> of_frame;  // a stage may come more than once
        for (const StageTime& stage : now.gpu_times) {
            if (!stages.contains(stage.name)) {
                stages[stage.name];
                order.push_back(stage.name);
            }
            of_frame[stage.name] += stage.milliseconds;
            gpu.back() += stage.milliseconds;
        }
        for (const auto& [name, time] : of_frame) stages[name].push_back(time);
    }
    if (host.empty()) return result;
    result.times.host = upper_median(host);
    result.times.gpu = upper_median(gpu);
    for (const std::string& name : order) result.times.stages.emplace_back(name, upper_median(stages[name]));
    return result;
}

}  // namespace posefusion
