#pragma once
#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "hosts/io/recording.hpp"
#include "hosts/pipeline/pipeline.hpp"
#include "hosts/pipeline/posefusion.hpp"
#include "hosts/pipeline/real_time.hpp"

namespace posefusion {

/// A frame on its way through the stages, with what a run records of it.
struct ScheduledFrame : ProcessedFrame {
    std::size_t dropped = 0;  ///< frames before it that were dropped in real time
    ByteArray people_state;  ///< PoseFusion::people_state() right after this frame, if requested by keep_people_state()

    double read_at = 0;  ///< when reading began (for a camera, when the frame arrived); seconds of the run's clock
    /// Reading, decoding and undistorting, without waiting for the device; for a camera including the wait for the
    /// frame.
    double read_ms = 0;
    double slam_ms = 0;     ///< tracking and mapping, wall-clock time
    double latency_ms = 0;  ///< from read_at to the pose
};

/// Which frames of a recording are processed.
enum class Pace {
    EveryFrame,
    RealTime,  ///< those that the pipeline has time for: a recording is played at its rate, a camera does not wait
               ///< anyway
};

/// Runs the method on a recording or a camera in three parallel stages: reading,
/// PoseFusion::find_people() and PoseFusion::track_and_map().
class FrameScheduler {
public:
    struct Observer {
        std::function<void(ScheduledFrame&)> frame_done;         ///< called in order, by the thread that called run()
        std::function<void(const std::string&)> warning;         ///< by any thread
        std::function<bool()> cancelled = [] { return false; };  ///< by any thread
        /// Before a frame is tracked, by the thread that called run(). May wait; the stages before then wait, too.
        std::function<void()> frame_due = [] {};
    };

    /// Both must outlive this.
    FrameScheduler(const Recording& recording, PoseFusion& method);

    /// The next run() continues after the frames of an earlier one, to which the method has been restored.
    /// @param next_entry  of the recording  @param frames  done before  @param last_stamp  of the last of them
    void resume(std::size_t next_entry, std::size_t frames, Stamp last_stamp);
    /// Fills in ScheduledFrame::people_state every `frames` frames; 0: never.
    void keep_people_state(std::size_t every) { people_state_every_ = every; }

    /// Processes up to `max_frames` frames (0 = all). Unreadable ones are skipped with a warning.
    /// An error ends the run; frames passed to frame_done() before stay valid. Never throws.
    /// @param clock  for real time and latencies; null: wall-clock time
    [[nodiscard]] PipelineOutcome run(std::size_t max_frames, Schedule schedule, const Observer& observer,
                                      Pace pace = Pace::EveryFrame, PlayClock* clock = nullptr);
    /// Frames dropped because the pipeline was late; only in real time.
    [[nodiscard]] std::size_t dropped() const { return dropped_; }
    /// Frames skipped because they could not be used. After run().
    [[nodiscard]] std::size_t skipped() const { return bad_frames_.skipped(); }

private:
    [[nodiscard]] std::optional<ScheduledFrame> read(std::size_t max_frames, const Observer& observer);
    [[nodiscard]] std::optional<std::size_t> next_entry(const Observer& observer);
    /// Whether a frame that has been read is processed rather than dropped.
    [[nodiscard]] bool take_in_time();
    void find_people(ScheduledFrame& frame);
    void track_and_map(ScheduledFrame& frame);

    const Recording& recording_;
    PoseFusion& method_;
    BadFrames bad_frames_;
    WallClock wall_;
    PlayClock* clock_ = &wall_;
    std::optional<RealTimePace> recording_pace_;  // of real time, either this ...
    std::optional<CameraPace> camera_pace_;       // ... or this
    Entrance entrance_;
    std::atomic<std::size_t> dropped_ = 0;
    std::size_t next_entry_ = 0, next_number_ = 0;  // of read()
    Stamp last_stamp_{};                            // of read()
    std::size_t people_state_every_ = 0;
};

}  // namespace posefusion
