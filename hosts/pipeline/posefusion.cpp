#include "hosts/pipeline/posefusion.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/error.hpp"

namespace posefusion {

PoseFusion::PoseFusion(const Sequence& sequence, PeopleFinder& people, Slam& slam)
    : sequence_(sequence), people_(people), slam_(slam), bad_frames_(sequence.size()) {}

PipelineOutcome PoseFusion::run(std::size_t max_frames, Schedule schedule, const Observer& observer) {
    Stages<TrackedFrame> stages;
    stages.source = [&] { return read(max_frames == 0 ? sequence_.size() : max_frames, observer); };
    stages.middle = [&](TrackedFrame& frame) { find_people(frame); };
    stages.sink = [&](TrackedFrame& frame) {
        track_and_map(frame);
        observer.frame_done(frame);
    };
    stages.sink_ended = [&] { motion_.close(); };
    stages.cancelled = observer.cancelled;
    return run_pipeline(stages, schedule);
}

std::optional<TrackedFrame> PoseFusion::read(std::size_t max_frames, const Observer& observer) {
    while (next_entry_ < sequence_.size() && next_number_ < max_frames && !observer.cancelled()) {
        TrackedFrame frame;
        try {
            frame.input = sequence_.load(next_entry_++);
        } catch (const SourceLost&) {
            throw;
        } catch (const Error& error) {
            observer.warning(bad_frames_.bad(error.what()));
            continue;
        }
        bad_frames_.good();
        frame.number = next_number_++;
        frame.previous_stamp = std::exchange(last_stamp_, frame.input.stamp);
        frame.read_ms = frame.since_read.milliseconds();
        return frame;
    }
    return std::nullopt;
}

void PoseFusion::find_people(TrackedFrame& frame) {
    const auto T_previous_current = [&] {
        const Stopwatch watch;
        const Eigen::Isometry3f motion = motion_.predict(frame.number, frame.input.stamp, frame.previous_stamp);
        frame.wait_ms = watch.milliseconds();
        return motion;
    };
    frame.people = people_.find(frame.input, T_previous_current);
}

void PoseFusion::track_and_map(TrackedFrame& frame) {
    const Stopwatch watch;
    const Segmentation& people = frame.people.segmentation;
    frame.result = slam_.process(frame.input.color, people.static_depth, people.labels);
    motion_.publish(frame.input.stamp, frame.result.T_world_camera);
    frame.slam_ms = watch.milliseconds();
    frame.latency_ms = frame.since_read.milliseconds();
}

}  // namespace posefusion
