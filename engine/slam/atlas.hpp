#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/slam/dense_slam.hpp"
#include "engine/slam/map_piece.hpp"

namespace posefusion {

/// Step 3 of the paper on a map of pieces: what Slam does, without its threads. The current piece is on the device, the
/// others wait in memory until place recognition finds them again.
class Atlas {
public:
    Atlas(const Intrinsics& camera, const SlamConfig& config, std::shared_ptr<vulkan::Context> context);

    FrameResult process(const ColorImage& color, const DepthImage& depth, const LabelImage& labels,
                        const FrameTiming& timing, std::span<const StartPose> starts);

    [[nodiscard]] DenseSlam& current() { return slam_; }
    [[nodiscard]] const DenseSlam& current() const { return slam_; }
    [[nodiscard]] const std::vector<std::uint32_t>& frames() const { return frames_; }  ///< of the current piece
    [[nodiscard]] std::uint32_t frames_processed() const { return next_frame_; }
    /// Of the current piece's last loop, see Slam::loop_graph().
    [[nodiscard]] std::optional<LoopGraph> loop_graph() const;
    /// Those that have not been joined to the current one, oldest first.
    [[nodiscard]] std::vector<MapPiece> other_pieces(float min_confidence) const;
    /// Makes the piece current that holds the frames of a restored map, or else that with the most tracked frames (the
    /// oldest of equal ones).
    void choose_main_piece();

    [[nodiscard]] AtlasState state() const;
    void restore(const AtlasState& state);
    /// Of a map in one piece, whose frames are the first.
    void restore(const SlamState& state);

private:
    struct Input {
        const ColorImage& color;
        const DepthImage& depth;
        const LabelImage& labels;
        const FrameTiming& timing;
        std::span<const StartPose> starts;
    };
    FrameResult track(const Input& input);
    FrameResult start_again(const Input& input);
    FrameResult begin_piece(const Input& input);
    void look_for_other_pieces(const Input& input, FrameResult& result);
    FrameResult move_to(std::uint32_t piece, const Eigen::Isometry3d& T_other_camera, const Input& input);
    void make_current(const PieceState& piece);
    [[nodiscard]] PieceState current_piece() const;
    [[nodiscard]] bool is_due() const;
    [[nodiscard]] bool are_near(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, bool lost) const;

    struct Proposal {
        std::uint32_t piece = 0;
        Eigen::Isometry3d T_other_camera;
        std::uint32_t model_frame = 0;  ///< of the keyframe, counted over all frames processed
        Keyframe* keyframe = nullptr;   ///< nullptr: from a pending join, or features
    };
    [[nodiscard]] std::optional<Proposal> proposal(const Input& input, const FrameResult& result);
    [[nodiscard]] std::optional<Eigen::Isometry3d> pose_in(std::uint32_t piece, const StartPose& start) const;
    [[nodiscard]] bool is_recognised(std::uint32_t piece, const Eigen::Isometry3d& T_other_camera,
                                     std::span<const StartPose> starts) const;

    /// Where in another piece the newest frame was taken.
    struct Place {
        Alignment alignment;
        std::uint32_t model_frame = 0;  ///< of the keyframe that it was aligned from, counted over all frames processed
    };
    /// Aligns the newest frame with another piece. @return nullopt: it does not show that piece, or it is not clear
    /// where
    [[nodiscard]] std::optional<Place> find_in(const Proposal& proposed, FrameResult& result);
    [[nodiscard]] std::vector<Place> places_in(const Proposal& proposed, const FernCode& view);
    /// @param gain  from the exposure of the current piece to that of the other
    void join_with(std::uint32_t piece, const Eigen::Isometry3d& T_other_current, float gain, FrameResult& result);

    DenseSlam slam_;
    std::vector<std::uint32_t> frames_;
    std::uint32_t tracked_ = 0;  ///< frames of the current piece with a pose
    std::vector<PieceState> others_;
    std::uint32_t next_frame_ = 0;
    std::uint32_t restored_frames_ = 0;  ///< of a map that was restored
    std::optional<PendingJoin> pending_;
};

}  // namespace posefusion
