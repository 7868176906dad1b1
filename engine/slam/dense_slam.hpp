#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/motion_judge.hpp"
#include "engine/loops/back_end.hpp"
#include "engine/map/model_view.hpp"
#include "engine/map/surfel.hpp"
#include "engine/map/surfel_map.hpp"
#include "engine/preprocess/preprocessing.hpp"
#include "engine/slam/frame_result.hpp"
#include "engine/slam/map_snapshot.hpp"
#include "engine/slam/slam_config.hpp"
#include "engine/slam/slam_state.hpp"
#include "engine/tracking/exposure.hpp"
#include "engine/tracking/sensor_timing.hpp"
#include "engine/tracking/start_pose.hpp"
#include "engine/tracking/timing_probe.hpp"
#include "engine/tracking/tracker.hpp"

namespace posefusion {

/// Step 3 of the paper on one map: the single-threaded implementation of Slam.
class DenseSlam {
public:
    DenseSlam(const Intrinsics& camera, const SlamConfig& config, std::shared_ptr<vulkan::Context> context);

    /// Preprocesses, tracks, fuses and predicts on the device; closes loops.
    FrameResult process(const ColorImage& color, const DepthImage& depth, const LabelImage& labels,
                        const FrameTiming& timing, std::span<const StartPose> starts);

    /// Who decides what moves and is no person, from the next frame on; nullptr: nobody does.
    void set_motion_judge(std::shared_ptr<MotionJudge> judge);

    [[nodiscard]] SlamState state() const;
    /// Throws Error if the state does not fit, and leaves everything unchanged.
    void restore(const SlamState& state);
    /// Whether the map should be started again instead of waiting for relocalisation (StartConfig).
    [[nodiscard]] bool has_bad_start() const;
    /// Discards map, keyframes and poses: the next frame is the first.
    void restart();
    void lose_camera() { back_end_.lose_camera(); }
    /// Has the camera been lost for so long that a new piece of map should begin, with a view that is worth it?
    [[nodiscard]] bool is_lost_for_good() const;
    /// Has the newest frame enough static depth to begin a map with, or to recognise something?
    [[nodiscard]] bool sees_enough() const;
    [[nodiscard]] bool is_seen_through() const;
    /// Does the newest frame, though it may have been processed with another map, show this one?
    [[nodiscard]] Alignment align_newest(const Eigen::Isometry3d& T_world_camera, float min_overlap);
    /// The camera is known to be there: the next frame is tracked from there.
    void place_camera(const Eigen::Isometry3d& T_world_camera);
    /// See Slam::follow().
    void follow(std::span<const Eigen::Isometry3d> poses);
    /// Slots that the map can have at most.
    [[nodiscard]] std::uint64_t largest_map() const { return map_.largest_capacity(); }
    /// Takes effect with the next frame, except for values that are part of recorded commands.
    void set_config(const SlamConfig& config);

    [[nodiscard]] std::vector<Surfel> surfels(float min_confidence) const;
    [[nodiscard]] ModelView render(const Eigen::Isometry3d& T_world_camera) const;
    /// Copies the newest frame into an unused snapshot of `exchange`. At least one frame must have been processed.
    [[nodiscard]] std::shared_ptr<MapSnapshot> snapshot(SnapshotExchange& exchange) const;

    [[nodiscard]] SensorTiming::Estimate sensor_timing() const { return sensor_timing_.estimate(); }
    [[nodiscard]] const SlamConfig& config() const { return config_; }
    [[nodiscard]] const BackEnd& back_end() const { return back_end_; }

private:
    void enqueue_frame(vulkan::Sequence& sequence) const;
    void enqueue_tracking(vulkan::Sequence& sequence) const;
    void enqueue_mapping(vulkan::Sequence& sequence) const;
    /// The first frame, kept until the second one says how the camera moved while it was taken.
    struct FirstFrame {
        ColorImage color;
        DepthImage depth;
        LabelImage labels;
        FrameTiming timing;
    };
    void begin_with(const FirstFrame& first, const gpu::Twist& motion);
    void find_first_motion(const ColorImage& color, const DepthImage& depth, const LabelImage& labels);
    bool rest_moves_otherwise(const ColorImage& color, const DepthImage& depth, const LabelImage& labels,
                              const LabelImage& suspect);
    void change_mask(const ColorImage& color, const DepthImage& depth, const LabelImage& labels);
    LabelImage run_with_judge(const ColorImage& color, const DepthImage& depth, const LabelImage& people);
    void run(std::unique_ptr<vulkan::Sequence>& sequence, void (DenseSlam::*enqueue)(vulkan::Sequence&) const);
    void enqueue_prediction(vulkan::Sequence& sequence) const;
    [[nodiscard]] gpu::Params params_of_frame() const;
    void enqueue_preprocessing(vulkan::Sequence& sequence) const;
    void enqueue_pose(vulkan::Sequence& sequence) const;
    void enqueue_second_tracking(vulkan::Sequence& sequence) const;
    [[nodiscard]] FrameResult result_of_frame();
    void offer_start(std::span<const StartPose> starts);
    [[nodiscard]] TrackedFrame tracked_frame(const FrameResult& result);
    void estimate_timing(bool tracked, const FrameTiming& timing);
    void predict_from(const Eigen::Isometry3d& T_world_camera);
    void forget_recordings();

    Intrinsics camera_;
    SlamConfig config_;
    std::shared_ptr<vulkan::Context> shared_context_;
    vulkan::Context& context_;
    vulkan::Buffer host_params_, params_;
    PyramidBuilder pyramids_;
    Preprocessing images_;
    Tracker tracker_;
    std::optional<TimingProbe> timing_probe_;  ///< nullopt: not asked for
    SensorTiming sensor_timing_;
    double previous_depth_delay_s_ = 0;  ///< by the stamps of the previous frame
    Exposure exposure_;
    SurfelMap map_;
    BackEnd back_end_;
    ImagePyramid model_;  ///< prediction that the next frame is tracked against
    vulkan::Buffer model_color_;
    vulkan::Buffer host_before_;                  ///< gpu::TrackingRecord before the newest frame
    vulkan::Buffer start_, host_start_;           ///< gpu::StartRecord of the newest frame
    vulkan::Buffer host_record_, host_counters_;  ///< gpu::TrackingRecord and gpu::MapRecord of the newest frame
    std::unique_ptr<vulkan::Sequence> first_frame_, next_frame_, prediction_;
    std::shared_ptr<MotionJudge> judge_;
    /// The frame in parts, for a judge to decide in between: tracking; mask alone; tracking once more; the rest.
    std::unique_ptr<vulkan::Sequence> tracking_, masking_, second_tracking_, mapping_;
    std::vector<StageTime> times_;  ///< of the newest frame
    std::uint32_t frames_ = 0;
    std::uint32_t start_inliers_ = 0;       ///< of the start offered to the newest frame
    std::optional<PoseProposal> proposal_;  ///< that start, in the world
    std::optional<FirstFrame> first_;       ///< with a rolling shutter
    double since_pose_s_ = 0;               ///< time from the last tracked frame to this one
};

}  // namespace posefusion
