#pragma once
#include <filesystem>
#include <functional>

#include "hosts/config/run_config.hpp"
#include "hosts/io/recording.hpp"
#include "hosts/pipeline/frame_scheduler.hpp"
#include "hosts/pipeline/play_clock.hpp"
#include "hosts/pipeline/posefusion.hpp"
#include "hosts/run/checkpoint.hpp"
#include "hosts/run/console.hpp"
#include "hosts/run/run_record.hpp"
#include "hosts/run/signals.hpp"

namespace posefusion {

/// Callbacks of a run. All but `cancelled` are called by the thread that called run().
struct RunHooks {
    std::function<void(const ScheduledFrame&)> frame_done = [](const ScheduledFrame&) {};
    std::function<void()> frame_due = [] {};                 ///< before a frame is tracked; may wait
    std::function<bool()> cancelled = [] { return false; };  ///< by any thread
    PlayClock* clock = nullptr;                              ///< for real time and latencies; null: wall-clock time
};

/// Everything that a run needs, created in an order in which errors that are cheap to detect come first.
class RunSession {
public:
    /// Throws Error: recording, model, masks, device, map or checkpoint cannot be used.
    /// @param sharing  requirements of a renderer that shares the device
    RunSession(const std::filesystem::path& recording, const RunConfig& config, const DeviceSharing& sharing = {});
    RunSession(const RunSession&) = delete;  // its recording asks it whether to go on
    RunSession& operator=(const RunSession&) = delete;

    /// Processes the frames, shows progress and stops at Ctrl-C. Errors are returned in the record.
    /// @param on_frame  called for every finished frame
    [[nodiscard]] RunRecord run(Console& console, const std::function<void(const ScheduledFrame&)>& on_frame);
    [[nodiscard]] RunRecord run(Console& console, const RunHooks& hooks);
    /// After run(): bundle adjustment at the end (adjust_at_end()), which map and record follow.
    void adjust(RunRecord& record, Console& console);
    /// Resets everything to the start, including a loaded map, for the next run().
    void restart();

    [[nodiscard]] const Recording& recording() const { return recording_; }
    /// Frames are dropped when the pipeline is late: on request, or with a camera.
    [[nodiscard]] bool real_time() const { return config_.real_time || recording_.live(); }
    [[nodiscard]] const Slam& slam() const { return method_.engine(); }
    [[nodiscard]] Slam& slam() { return method_.engine(); }
    /// Models of the rigid things that move (PoseFusion::object_maps()).
    [[nodiscard]] std::vector<ObjectMap> object_maps(bool stable_only) const {
        return method_.object_maps(stable_only);
    }
    [[nodiscard]] std::size_t frames_to_do() const;

private:
    void restore();
    void write_checkpoint_of(const ScheduledFrame& frame, const RunRecord& record, double wall_seconds,
                             const std::function<void(const std::string&)>& warn) const;

    [[nodiscard]] SourceOptions cancellable(SourceOptions options) const;

    const RunConfig& config_;
    std::filesystem::path location_;
    std::function<bool()> cancelled_ = interrupted;  ///< changes only while nothing is read
    Recording recording_;
    PoseFusion method_;
    RunIdentity identity_;
    std::string remark_;  ///< how the run begins, if not as requested; else empty
    Checkpoint resumed_;  ///< without its state; empty: the run starts from its first frame
};

/// What the configuration says about reading the recording.
[[nodiscard]] SourceOptions source_options(const RunConfig& config);

/// The line to print for an exception of any kind.
[[nodiscard]] std::string error_text(const std::exception_ptr& error);

}  // namespace posefusion
