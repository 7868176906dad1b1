#include "hosts/run/run_session.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <new>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "engine/core/stopwatch.hpp"
#include "engine/slam/map_piece.hpp"
#include "hosts/io/map_file.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/run/late_remark.hpp"

namespace posefusion {
namespace {

constexpr std::chrono::seconds kShaderPatience{
    2};                              ///< for the first frames, before a message says why they take so long
constexpr std::size_t kSamples = 6;  ///< frames with pictures in the report

std::uint64_t peak_memory_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

/// Evenly spread over the run, neither the first nor the last frame.
bool is_sample(std::size_t number, std::size_t total) {
    const std::size_t spacing = std::max<std::size_t>(1, total / kSamples);
    return number % spacing == spacing / 2 && number / spacing < kSamples;
}

bool has_bent_the_map(const FrameResult& result) {
    return std::any_of(result.loops.begin(), result.loops.end(),
                       [](const LoopEvent& event) { return event.accepted && event.nodes > 0; });
}

/// The newest frame has changed the map as a whole.
void say_what_changed(const RunRecord& record, const std::function<void(const std::string&)>& warn, Console& console) {
    const std::vector<FrameRecord>& frames = record.frames;
    const std::string now = seconds_text(frames.back().stamp) + " s";
    switch (frames.back().result.map_change) {
        case MapChange::None:
            break;
        case MapChange::StartedAgain: {
            const auto begun = std::find_if(frames.rbegin(), frames.rend(), [](const FrameRecord& frame) {
                return frame.result.map_change == MapChange::NewPiece;
            });
            if (begun == frames.rend()) {
                warn("given up: " + counted(frames.size() - 1, "frame") +
                     " at the beginning; what filled the view has gone, and the map begins with the frame of " + now);
            } else {
                warn("given up: " + counted(static_cast<std::size_t>(begun - frames.rbegin()), "frame") +
                     " of a piece of map; what it showed was not seen again, and it begins anew with the frame of " +
                     now);
            }
            break;
        }
        case MapChange::NewPiece:
            warn("the camera is lost and sees what is not in the map; a new piece of map begins with the frame of " +
                 now);
            break;
        case MapChange::OtherPiece:
            console.remark("the camera was found in an earlier piece of map, in the frame of " + now);
            break;
        case MapChange::Joined:
            console.remark("two pieces of map see the same place in the frame of " + now + " and are one now");
            break;
    }
}

}  // namespace

SourceOptions source_options(const RunConfig& config) {
    SourceOptions options;
    options.camera_file = config.camera;
    options.calibrated = config.calibrated;
    options.scale = config.scale;
    options.associations_file = config.associations;
    options.color_topic = config.color_topic;
    options.depth_topic = config.depth_topic;
    options.flip_colors = config.flip_colors;
    options.time_unit = config.time_unit;
    options.selection = config.selection;
    options.depth = {config.slam.preprocess.depth_min, config.slam.preprocess.depth_max};
    return options;
}

RunSession::RunSession(const std::filesystem::path& recording, const RunConfig& config, const DeviceSharing& sharing)
    : config_(config),
      location_(recording),
      recording_(recording, cancellable(source_options(config))),
      method_(recording_, config, sharing),
      identity_(identity_of(config, recording_)) {
    restore();
}

SourceOptions RunSession::cancellable(SourceOptions options) const {
    options.cancelled = [this] { return cancelled_(); };
    return options;
}

void RunSession::restart() {
    method_.reset(make_people_finder(config_, recording_));
    restore();
}

void RunSession::restore() {
    if (recording_.live() && (config_.checkpoint_every > 0 || config_.resume)) {
        throw Error("--checkpoint-every and --resume need a recording; a camera cannot be played again");
    }
    remark_.clear();
    const std::filesystem::path checkpoint = checkpoint_file(config_);
    if (config_.resume && !std::filesystem::exists(checkpoint)) {
        remark_ = checkpoint.string() + ": no checkpoint has been written yet; the run starts from the beginning";
    }
    if (config_.resume && remark_.empty()) {
        remove_unfinished(checkpoint);
        resumed_ = read_checkpoint(checkpoint, identity_);
        method_.restore(std::exchange(resumed_.engine, {}), resumed_.people, tracked_poses(resumed_.frames));
    } else if (!config_.load_map.empty()) {
        const SlamState map = read_map(config_.load_map);
        if (map.frames == 0) throw Error(config_.load_map.string() + ": is an empty map; begin without --load-map");
        method_.continue_in(map);
    }
}

void RunSession::write_checkpoint_of(const ScheduledFrame& frame, const RunRecord& record, double wall_seconds,
                                     const std::function<void(const std::string&)>& warn) const {
    const auto every = static_cast<std::size_t>(config_.checkpoint_every);
    if (every == 0 || (frame.number + 1) % every != 0) return;
    try {
        write_checkpoint(checkpoint_file(config_), identity_, slam().atlas_state(), frame.people_state, record,
                         wall_seconds);
    } catch (const Error& error) {
        warn("no checkpoint: " + std::string(error.what()));  // the run continues without it
    }
}

std::size_t RunSession::frames_to_do() const {
    const auto limit = static_cast<std::size_t>(config_.max_frames);
    return limit == 0 ? recording_.size() : std::min(limit, recording_.size());
}

RunRecord RunSession::run(Console& console, const std::function<void(const ScheduledFrame&)>& on_frame) {
    RunHooks hooks;
    hooks.frame_done = on_frame;
    return run(console, hooks);
}

RunRecord RunSession::run(Console& console, const RunHooks& hooks) {
    RunRecord record;
    record.device = slam().device();
    record.people_description = method_.people().description();
    std::mutex warnings_mutex;  // warnings come from the reading thread
    const auto warn = [&](const std::string& text) {
        console.warning(text);
        const std::lock_guard lock(warnings_mutex);
        record.warnings.push_back(text);
    };
    for (const std::string& text : recording_.warnings()) warn(text);
    if (!remark_.empty()) warn(remark_);

    record.frames = std::move(resumed_.frames);
    const std::size_t frames_before = slam().frames_processed() - record.frames.size();  // of a loaded map
    record.samples = std::move(resumed_.samples);
    record.loop_graph = std::exchange(resumed_.loop_graph, std::nullopt);

    LateRemark compiling(kShaderPatience, [&] {
        console.remark("the first frames take longer: the driver compiles the shaders, once");
    });
    PeopleTracks people_tracks;
    for (const FrameRecord& frame : record.frames)
        people_tracks.replay(frame.in_view, frame.result.T_world_camera, frame.result.T_world_tracked, frame.stamp);
    const Stopwatch whole;
    Stopwatch since_last;
    FrameScheduler::Observer observer;
    observer.warning = warn;
    cancelled_ = [&hooks] { return interrupted() || hooks.cancelled(); };
    observer.cancelled = cancelled_;
    observer.frame_due = hooks.frame_due;
    observer.frame_done = [&](ScheduledFrame& frame) {
        frame.people.ids = people_tracks.update(frame.people.segmentation.skeletons, frame.result.T_world_camera,
                                                frame.result.T_world_tracked, frame.input.stamp);
        hooks.frame_done(frame);
        const int people = frame.people.segmentation.people;
        const std::uint32_t surfels = frame.result.surfels;
        record.add(frame, since_last.milliseconds(), is_sample(frame.number, frames_to_do()));
        const FrameResult& result = record.frames.back().result;
        if (result.map_change != MapChange::None) {
            record.loop_graph.reset();  // it was in another world
            say_what_changed(record, warn, console);
        }
        if (has_bent_the_map(result)) record.loop_graph = slam().loop_graph();
        if (frame.number + 1 == kFirstRuns) compiling.needless();
        since_last = Stopwatch();
        write_checkpoint_of(frame, record, resumed_.wall_seconds + whole.milliseconds() / 1000, warn);
        console.progress(record.frames.size(), frames_to_do(), map_text(surfels, people));
    };
    FrameScheduler scheduler(recording_, method_);
    scheduler.keep_people_state(static_cast<std::size_t>(config_.checkpoint_every));
    if (!record.frames.empty()) {
        const FrameRecord& last = record.frames.back();
        scheduler.resume(last.index + 1, record.frames.size(), last.stamp);
    }
    const Schedule schedule = config_.sequential ? Schedule::Sequential : Schedule::Pipelined;
    const Pace pace = real_time() ? Pace::RealTime : Pace::EveryFrame;
    const PipelineOutcome outcome = scheduler.run(frames_to_do(), schedule, observer, pace, hooks.clock);
    cancelled_ = interrupted;
    console.end_progress();
    if (real_time()) record.dropped = scheduler.dropped();
    record.skipped = scheduler.skipped();

    slam().choose_main_piece();
    record.take_pieces(slam(), frames_before);
    if (record.pieces.size() > 1) {
        const std::string all = counted(record.frames.size(), "frame");
        warn("the map is in " + std::to_string(record.pieces.size()) + " pieces that never met; " +
             std::to_string(record.tracked(record.pieces.front())) + " of " + all +
             " are in the main one, the others are written beside it");
    }
    record.wall_seconds = resumed_.wall_seconds + whole.milliseconds() / 1000;
    record.peak_memory_bytes = peak_memory_bytes();
    if (outcome.error) {
        record.status = RunStatus::Failed;
        record.error = error_text(outcome.error);
    } else if (outcome.cancelled) {
        record.status = RunStatus::Interrupted;
    }
    return record;
}

void RunSession::adjust(RunRecord& record, Console& console) {
    const auto progress = [&](std::size_t done, std::size_t total) {
        console.progress(done, total, "adjusting the trajectory");
    };
    try {
        record.adjustment = adjust_at_end(location_, config_, record, progress, interrupted);
        console.end_progress();
        if (!record.adjustment || record.adjustment->poses.empty()) return;
        slam().follow(record.adjustment->poses);
        record.take_pieces(slam(), 0);
    } catch (...) {  // the run has been computed, and is saved
        console.end_progress();
        record.warnings.push_back("the trajectory is not adjusted: " + error_text(std::current_exception()));
        console.warning(record.warnings.back());
    }
}

std::string error_text(const std::exception_ptr& error) {
    try {
        std::rethrow_exception(error);
    } catch (const std::bad_alloc&) {
        return "out of memory; close other programs or shrink the images with --scale";
    } catch (const std::filesystem::filesystem_error& e) {
        return e.path1().string() + ": " + e.code().message();
    } catch (const std::exception& e) {
        return e.what();
    } catch (...) {
        return "unknown error";
    }
}

}  // namespace posefusion
