#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "engine/loops/aligner.hpp"
#include "engine/loops/deformation_graph.hpp"
#include "engine/loops/deformer.hpp"
#include "engine/loops/fern_database.hpp"
#include "engine/slam/slam.hpp"
#include "engine/slam/slam_state.hpp"

namespace posefusion {

/// Keeps the map globally consistent: recognises places, closes local and global loops by deforming map, trajectory and
/// keyframes, and finds the camera again after tracking was lost. Runs on the host between two frames; the device does
/// the alignment and the deformation of the surfels.
class BackEnd {
public:
    BackEnd(vulkan::Context& context, const Intrinsics& camera, const SlamConfig& config);

    /// Part of every frame: shrinks the prediction for place recognition.
    void enqueue_thumbnail(vulkan::Sequence& sequence, const vulkan::Buffer& params, const vulkan::Buffer& record,
                           const vulkan::Buffer& model_color, const vulkan::Buffer& model_depth,
                           const Preprocessing& frame) const;
    /// The surfel buffers have changed.
    void forget_recordings() { aligner_.forget_recording(); }

    /// What the frame that has just been tracked and fused looked like to the device.
    struct Tracked {
        gpu::Params params;  ///< of the frame
        Eigen::Isometry3d T_world_camera;
        Matrix6d information;  ///< of the step from the frame before (GraphCamera); nothing if tracking failed
        bool failed = false;
        std::uint32_t inactive_in_view = 0;
        const Preprocessing& frame;
        const PyramidBuilder& pyramids;
        SurfelMap& map;
    };
    struct Outcome {
        TrackingState state = TrackingState::Ok;
        bool moved = false;  ///< the camera has another pose now, or the map another shape: predict again
        Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
        std::vector<LoopEvent> events;
    };
    /// After every frame.
    [[nodiscard]] Outcome after_frame(const Tracked& tracked);

    /// Frames without tracking up to now.
    [[nodiscard]] int failures() const { return failures_; }
    [[nodiscard]] bool lost() const { return failures_ >= config_.relocalisation.lost_after; }
    [[nodiscard]] const std::vector<Eigen::Isometry3d>& trajectory() const { return trajectory_; }
    [[nodiscard]] const FernDatabase& places() const { return places_; }
    /// Of the last loop that has bent the map since the start or restore().
    [[nodiscard]] const std::optional<LoopGraph>& loop_graph() const { return loop_graph_; }

    [[nodiscard]] BackEndState state() const;
    /// Throws Error if keyframes were coded by other ferns.
    void restore(const BackEndState& state);
    /// The camera may be anywhere: place recognition has to find it.
    void lose_camera();

private:
    [[nodiscard]] std::uint32_t thumbnail_pixels() const;
    [[nodiscard]] FernIdentity fern_identity() const;
    [[nodiscard]] Thumbnail thumbnail() const;
    void relocalise(const Tracked& tracked, const FernCode& code, Outcome& outcome);
    [[nodiscard]] bool is_one_step(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) const;
    void close_loop(const Tracked& tracked, const FernCode& code, Outcome& outcome);
    /// Is the view of a possible loop as good as it gets?
    [[nodiscard]] bool view_is_best(float overlap, std::uint32_t frame);
    [[nodiscard]] std::optional<double> travelled_since(std::uint32_t frame, const Tracked& tracked) const;
    /// Bends map, trajectory and keyframes so that the live image lies where `alignment` found it. False: not possible.
    bool deform(const Tracked& tracked, const Alignment& alignment, LoopEvent& event);
    [[nodiscard]] std::vector<GraphSample> sample_map(const SurfelMap& map) const;

    vulkan::Context& context_;
    Intrinsics camera_;
    SlamConfig config_;
    FernDatabase places_;
    Aligner aligner_;
    Deformer deformer_;
    vulkan::Kernel thumbnail_;
    vulkan::Buffer thumbnails_, host_thumbnails_, surfel_samples_, host_surfel_samples_;
    std::vector<Eigen::Isometry3d> trajectory_;
    std::vector<Matrix6d> information_;                 ///< of the steps to them
    std::vector<LoopConstraint> relative_constraints_;  ///< of the loops so far
    int failures_ = 0;                                  ///< consecutive frames without tracking
    float pending_overlap_ = 0;                         ///< of the loop that waits for a better view; 0: none
    std::uint32_t pending_since_ = 0;                   ///< frame in which it was last seen
    std::uint32_t waiting_since_ = 0;                   ///< frame in which it was first seen
    std::optional<Eigen::Isometry3d> found_;            ///< by relocalisation in the frame before, to be confirmed
    std::uint32_t proposal_ = 0;                        ///< next one to try
    std::optional<LoopGraph> loop_graph_;
};

}  // namespace posefusion
