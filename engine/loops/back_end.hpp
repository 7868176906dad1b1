#pragma once
#include <optional>
#include <span>
#include <vector>

#include "engine/loops/aligner.hpp"
#include "engine/loops/back_end_state.hpp"
#include "engine/loops/loop_closer.hpp"
#include "engine/loops/place_recognition.hpp"
#include "engine/loops/relocaliser.hpp"
#include "engine/tracking/tracking_state.hpp"

namespace posefusion {

/// The configuration of the back end, with the values it shares with preprocessing and tracking.
struct BackEndConfig {
    LoopConfig loops;
    AlignmentConfig alignment;
    DeformationConfig deformation;
    RelocalisationConfig relocalisation;
    TrackingConfig tracking;     ///< of the frames; alignments with older parts of the map start from it
    float depth_max = 0;         ///< farthest depth used, metres
    bool localise_only = false;  ///< the map stays as it is
};

/// Keeps the map globally consistent. After a tracked frame it calls the LoopCloser, after a failed one the
/// Relocaliser; both use PlaceRecognition. Runs on the host between two frames; the device does the alignments and
/// deforms the surfels.
class BackEnd {
public:
    BackEnd(vulkan::Context& context, const Intrinsics& camera, const BackEndConfig& config);

    /// Part of every frame: shrinks the prediction for place recognition.
    void enqueue_thumbnail(vulkan::Sequence& sequence, const vulkan::Buffer& params, const vulkan::Buffer& record,
                           const vulkan::Buffer& model_color, const vulkan::Buffer& model_depth,
                           const Preprocessing& frame) const {
        places_.enqueue_thumbnail(sequence, params, record, model_color, model_depth, frame);
    }
    /// Call after the surfel buffers have changed.
    void forget_recordings() { aligner_.forget_recordings(); }

    struct Outcome {
        TrackingState state = TrackingState::Ok;
        bool moved = false;  ///< the camera has another pose now, or the map another shape: predict again
        Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
        std::vector<LoopEvent> events;
    };
    /// Call after every frame.
    [[nodiscard]] Outcome after_frame(const TrackedFrame& frame);

    /// The poses of all frames are known better: map and keyframes follow them. @param poses  as trajectory()
    void follow(const SurfelMap& map, std::span<const Eigen::Isometry3d> poses);

    /// Consecutive frames on which tracking has failed, up to now.
    [[nodiscard]] int failures() const { return relocaliser_.failures(); }
    [[nodiscard]] bool lost() const { return relocaliser_.lost(); }
    [[nodiscard]] std::vector<Eigen::Isometry3d> trajectory() const;
    /// Of the newest frame; there must have been one.
    [[nodiscard]] const Eigen::Isometry3d& last_pose() const { return trajectory_.back().T_world_camera; }
    /// Of the frame `age` before the next one, corrected; nullopt if there is none, or tracking failed on it.
    [[nodiscard]] std::optional<Eigen::Isometry3d> pose_before(std::uint32_t age) const;
    [[nodiscard]] const std::vector<Keyframe>& keyframes() const { return places_.database().keyframes(); }
    /// The graph of the last loop that deformed the map since the start or restore().
    [[nodiscard]] const std::optional<LoopGraph>& loop_graph() const { return loop_closer_.correction().loop_graph(); }

    /// The ferns that encode keyframes.
    [[nodiscard]] FernIdentity fern_identity() const { return places_.identity(); }
    [[nodiscard]] BackEndState state() const;
    /// Throws Error if the keyframes were encoded by other ferns.
    void restore(const BackEndState& state);
    /// The camera may be anywhere: place recognition has to find it.
    void lose_camera();
    /// It has been found by other means.
    void found_camera() { relocaliser_.count_success(); }

    /// Code of the newest frame, to compare with keyframes of other maps.
    [[nodiscard]] FernCode code_of_frame() const { return places_.code_of_frame(); }
    /// See FernDatabase::query().
    [[nodiscard]] std::vector<FernMatch> places_like(const FernCode& code, std::span<const Keyframe> keyframes,
                                                     std::size_t most, std::uint32_t now, std::uint32_t before) const {
        return places_.database().query(code, keyframes, most, now, before);
    }
    /// Does a frame show the map? See Aligner::align().
    [[nodiscard]] Alignment align(const TrackedFrame& frame, const Eigen::Isometry3d& T_world_camera,
                                  float min_overlap) {
        return aligner_.align(frame, ModelPart::Whole, min_overlap, T_world_camera);
    }

private:
    void close_loop(const TrackedFrame& frame, const FernCode& code, Outcome& outcome);
    void find_camera(const TrackedFrame& frame, const FernCode& code, Outcome& outcome);

    bool close_loops_, relocalise_, localise_only_;
    PlaceRecognition places_;
    Aligner aligner_;
    LoopCloser loop_closer_;
    Relocaliser relocaliser_;
    std::vector<GraphCamera> trajectory_;  ///< one camera per frame
};

}  // namespace posefusion
