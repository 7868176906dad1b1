#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/map/surfel.hpp"
#include "engine/slam/slam_state.hpp"

/// A map in pieces. While the camera is lost it may come to places that the map does not show; a new piece of map
/// begins there, with its first camera as its world. Pieces that see the same place become one (join()).
namespace posefusion {

/// A piece for those who look at the result.
struct MapPiece {
    std::vector<std::uint32_t> frames;          ///< numbers, counted over all frames processed, ascending
    std::vector<Eigen::Isometry3d> trajectory;  ///< T_world_camera of each, in the world of the piece
    std::vector<Surfel> surfels;                ///< in the world of the piece
};

/// A piece as the engine keeps it. The numbers inside `slam` (creation times, keyframes ...) count the frames of the
/// piece.
struct PieceState {
    SlamState slam;
    std::vector<std::uint32_t> frames;  ///< of each of slam.frames frames the number over all frames processed
    std::uint32_t tracked = 0;          ///< frames with a pose
};

/// A place of another piece has been seen; another frame has to agree. For a join it must be another view of it: a
/// pattern that repeats itself deceives all frames of one view alike.
struct PendingJoin {
    std::uint32_t piece = 0;        ///< position in AtlasState::others
    std::uint32_t frame = 0;        ///< in which it was seen, counted over all frames processed
    std::uint32_t model_frame = 0;  ///< of the keyframe that proposed it, likewise
    Eigen::Isometry3d T_other_current = Eigen::Isometry3d::Identity();  ///< from the world of the current piece
    FernCode view;                                                      ///< in which it was seen first
};

/// All that the next frame depends on, other pieces included.
struct AtlasState {
    PieceState current;
    std::vector<PieceState> others;
    std::uint32_t frames = 0;           ///< processed so far; number of the next one
    std::uint32_t restored_frames = 0;  ///< the first so many are those of a map that was restored
    std::optional<PendingJoin> pending;
    ByteArray motion;  ///< MotionJudge::state(); empty = there is no judge
};

/// One piece out of two, in the world of `base`. Frames are in the order of their numbers. Only live surfels are taken
/// along. The camera and what it is tracked against are those of `moved` if that is where the camera is, else of
/// `base`; in either case the model has to be predicted again.
/// @param T_base_moved  from the world of `moved` to that of `base`
/// @param gain  intensities of `base` over those of `moved`: their first frames, whose exposures they have, may differ
[[nodiscard]] PieceState join(const PieceState& base, const PieceState& moved, const Eigen::Isometry3d& T_base_moved,
                              float gain, bool camera_in_moved);

/// The piece before its last frame, which found no pose and so left nothing in the map.
[[nodiscard]] PieceState without_last_frame(PieceState piece);

}  // namespace posefusion
