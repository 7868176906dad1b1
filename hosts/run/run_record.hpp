#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/slam/slam.hpp"
#include "hosts/io/trajectory.hpp"
#include "hosts/pipeline/frame_scheduler.hpp"
#include "hosts/report/report.hpp"
#include "hosts/run/calibration_search.hpp"
#include "hosts/run/final_adjustment.hpp"
#include "hosts/run/people_tracks.hpp"
#include "hosts/run/sensor_search.hpp"

namespace posefusion {

/// The record of a frame without its images. Times in milliseconds.
struct FrameRecord {
    std::size_t index = 0;  ///< position in the recording
    Stamp stamp{};
    FrameResult result;
    int people = 0;                     ///< cut out, carried ones included
    int carried = 0;                    ///< of these, without a detection in this frame
    std::vector<PersonInView> in_view;  ///< those whose joints were seen
    LabelImage not_static;              ///< 1 for each block of pixels with people or movers; empty: there are none
    double read_ms = 0;
    std::optional<double> joints_ms, segmentation_ms, features_ms;
    double slam_ms = 0;
    double latency_ms = 0;   ///< from the start of reading to the pose
    double interval_ms = 0;  ///< since the previous frame was finished; its inverse is the frame rate
};

inline constexpr std::size_t kFirstRuns =
    2;  ///< frames in which kernels run for the first time: one without, one with tracking

enum class RunStatus { Finished, Interrupted, Failed };

/// The frames of a run that are in one piece of map (engine/slam/map_piece.hpp).
struct PieceRecord {
    std::vector<std::size_t> frames;       ///< positions in RunRecord::frames, ascending
    std::vector<Eigen::Isometry3d> poses;  ///< of each, consistent with the map after all loop closures
};

/// All results of a run except the map.
struct RunRecord {
    std::vector<FrameRecord> frames;
    /// Set at the end of the run. The first is the map: the largest, or the one that was loaded. Frames of a beginning
    /// that was given up are in none.
    std::vector<PieceRecord> pieces;
    std::vector<Eigen::Isometry3d> earlier_poses;  ///< likewise of the frames of a loaded map
    std::vector<std::uint32_t> keyframes;          ///< positions in earlier_poses and then in the first piece's frames
    std::size_t surfels = 0, stable_surfels = 0;   ///< of the map
    std::optional<LoopGraph> loop_graph;           ///< of the last loop of these frames that bent the map
    std::vector<SampleFrame> samples;              ///< a few frames with pictures, for the report
    std::vector<std::string> warnings;
    RunStatus status = RunStatus::Finished;
    std::string error;                   ///< why the run failed; empty: it did not
    std::optional<std::size_t> dropped;  ///< frames dropped in real time; nullopt: not in real time
    std::size_t skipped = 0;             ///< frames that could not be used, since the start or the resume
    double wall_seconds = 0;
    std::uint64_t peak_memory_bytes = 0;  ///< resident, of the process
    DeviceInfo device;
    std::string people_description;
    std::optional<FoundTiming> sensor;            ///< nullopt: not looked for
    std::optional<FoundCalibration> calibration;  ///< likewise
    std::optional<FinalAdjustment> adjustment;    ///< nullopt: poses are as tracked and corrected by loops

    /// Moves what is kept out of `frame`. @param interval_ms  since the previous frame was finished
    void add(ScheduledFrame& frame, double interval_ms, bool as_sample);

    /// At the end of the run, when the engine has chosen the main piece.
    /// @param frames_before  that the engine had processed before the first of these
    void take_pieces(const Slam& slam, std::size_t frames_before);

    /// Of the map: the frames of its piece, without those in which tracking failed.
    [[nodiscard]] Trajectory trajectory() const;
    [[nodiscard]] Trajectory trajectory(const PieceRecord& piece) const;
    /// Of the object with this label, T_world_object in the world of a piece: its frames in which both camera and
    /// object were tracked.
    [[nodiscard]] Trajectory object_trajectory(const PieceRecord& piece, std::uint8_t label) const;
    /// Frames of a piece in which the camera was found.
    [[nodiscard]] std::size_t tracked(const PieceRecord& piece) const;
    /// In words, if the camera was lost in most of the frames, or they are in pieces; empty if not.
    [[nodiscard]] std::string mostly_lost() const;
    /// In words, if the camera seems to have leapt while the map was young: something near that filled the view and
    /// moved on is taken for the room. Empty if not.
    [[nodiscard]] std::string leap_at_the_beginning() const;
    /// Why the result cannot be used (an empty map, or a camera lost most of the time); empty if it can.
    [[nodiscard]] std::string fault() const;
    /// Makes a run that has finished with a fault() a failed one: `error` and `warnings` say it.
    /// @return what is in doubt otherwise, which is in `warnings`, too
    std::vector<std::string> judge();
    [[nodiscard]] std::vector<LostInterval> lost_intervals() const;
    /// Within some of the frames; the intervals are positions in `among`.
    [[nodiscard]] std::vector<LostInterval> lost_intervals(const std::vector<std::size_t>& among) const;
    /// Frames at the beginning in which the driver compiled shaders: they took far longer than the others. Their times
    /// do not represent the method and are NaN in the functions below.
    [[nodiscard]] std::size_t compiling_frames() const;
    [[nodiscard]] std::vector<double> intervals() const;  ///< milliseconds between frames
    [[nodiscard]] std::vector<StageSeries> host_stages() const;
    [[nodiscard]] std::vector<StageSeries> gpu_stages() const;  ///< in order of execution

private:
    [[nodiscard]] std::vector<double> steady_times(std::vector<double> milliseconds) const;
};

/// Poses of the frames as tracked at the time, without later corrections.
[[nodiscard]] std::vector<MotionPrediction::Pose> tracked_poses(const std::vector<FrameRecord>& frames);

/// Statistics of the values that are not NaN; NaN if there are none.
struct TimeSummary {
    std::size_t count = 0;
    double median = 0, mean = 0, p95 = 0;
};
[[nodiscard]] TimeSummary summarize(std::vector<double> milliseconds);

}  // namespace posefusion
