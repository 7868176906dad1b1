#include "hosts/pipeline/frame_scheduler.hpp"

#include <utility>

#include "engine/core/error.hpp"
#include "engine/core/stopwatch.hpp"

namespace posefusion {

FrameScheduler::FrameScheduler(const Recording& recording, PoseFusion& method)
    : recording_(recording), method_(method), bad_frames_(recording.size()) {}

void FrameScheduler::resume(std::size_t next_entry, std::size_t frames, Stamp last_stamp) {
    next_entry_ = next_entry;
    next_number_ = frames;
    last_stamp_ = last_stamp;
    bad_frames_.good();
}

PipelineOutcome FrameScheduler::run(std::size_t max_frames, Schedule schedule, const Observer& observer, Pace pace,
                                    PlayClock* clock) {
    if (clock != nullptr) clock_ = clock;
    if (pace == Pace::RealTime && recording_.live()) camera_pace_.emplace(*clock_);
    if (pace == Pace::RealTime && !recording_.live()) {
        recording_pace_.emplace([this](std::size_t entry) { return to_seconds(recording_.frames()[entry].stamp); },
                                recording_.size(), *clock_);
    }
    Stages<ScheduledFrame> stages;
    stages.entrance = [&](const Entrance& entrance) { entrance_ = entrance; };
    stages.source = [&] { return read(max_frames == 0 ? recording_.size() : max_frames, observer); };
    stages.middle = [&](ScheduledFrame& frame) { find_people(frame); };
    stages.sink = [&](ScheduledFrame& frame) {
        observer.frame_due();
        if (observer.cancelled()) return;  // cancelled while waiting
        track_and_map(frame);
        observer.frame_done(frame);
    };
    stages.sink_ended = [&] { method_.end_tracking(); };
    stages.cancelled = observer.cancelled;
    return run_pipeline(stages, schedule);
}

std::optional<ScheduledFrame> FrameScheduler::read(std::size_t max_frames, const Observer& observer) {
    while (next_number_ < max_frames && !observer.cancelled()) {
        const std::optional<std::size_t> entry = next_entry(observer);
        if (!entry) break;
        ScheduledFrame frame;
        frame.read_at = clock_->seconds();
        const Stopwatch watch;
        try {
            frame.input = recording_.load(*entry);
        } catch (const SourceEnded&) {
            break;
        } catch (const SourceLost&) {
            throw;
        } catch (const Error& error) {
            if (const std::string text = bad_frames_.bad(error.what()); !text.empty()) observer.warning(text);
            continue;
        }
        bad_frames_.good();
        if (!take_in_time()) continue;
        if (recording_.live()) frame.read_at = clock_->seconds();
        frame.number = next_number_++;
        frame.dropped = dropped_;
        frame.previous_stamp = std::exchange(last_stamp_, frame.input.stamp);
        frame.read_ms = watch.milliseconds() - frame.input.undistort.wait_ms;
        return frame;
    }
    return std::nullopt;
}

std::optional<std::size_t> FrameScheduler::next_entry(const Observer& observer) {
    if (recording_pace_) {
        const auto ended = [&] { return observer.cancelled() || entrance_.closed(); };
        const std::optional<std::size_t> entry = recording_pace_->next(entrance_.has_room, ended);
        dropped_ = recording_pace_->dropped();
        return entry;
    }
    if (next_entry_ == recording_.size()) return std::nullopt;
    return next_entry_++;
}

bool FrameScheduler::take_in_time() {
    if (!camera_pace_) return true;
    const bool take = camera_pace_->take(entrance_.has_room());
    dropped_ = camera_pace_->dropped();
    return take;
}

void FrameScheduler::find_people(ScheduledFrame& frame) {
    method_.find_people(frame);
    // this stage runs ahead of the tracker: its current state is kept with the frame
    if (people_state_every_ != 0 && (frame.number + 1) % people_state_every_ == 0)
        frame.people_state = method_.people_state();
}

void FrameScheduler::track_and_map(ScheduledFrame& frame) {
    const double waited = clock_->seconds() - frame.read_at;  // processing is never paused, unlike the clock
    const Stopwatch watch;
    method_.track_and_map(frame);
    frame.slam_ms = watch.milliseconds();
    frame.latency_ms = 1000 * waited + frame.slam_ms;
}

}  // namespace posefusion
