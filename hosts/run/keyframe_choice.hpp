#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "hosts/adjust/landmarks.hpp"
#include "hosts/io/recording.hpp"
#include "hosts/run/first_look.hpp"

/// The frames of a run, or of a look at a recording, that bundle adjustment is about.
namespace posefusion {

struct KeyframeChoice {
    /// A view is new if the camera has moved by this, in parts of the depth that it sees, or turned by this, rad; more
    /// where that would be too many keyframes.
    static constexpr double kStep = 0.01, kTurn = 0.015;
    static constexpr double kNeighbours_s = 0.25;  ///< frames farther apart say nothing of the motion during read-out
    /// The errors must be so much smaller for a camera that goes straight: nearly all are in hands.
    static constexpr double kStraight = 0.95;
};

/// How much two views differ: 1 is a step that makes a new one (KeyframeChoice).
class ViewDistance {
public:
    /// @param frames  the depth of the first tracked one tells how far away things are
    ViewDistance(const Recording& recording, const std::vector<LookedFrame>& frames);
    /// @param a, b  T_world_camera
    [[nodiscard]] double operator()(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) const;

private:
    double depth_ = 1;  ///< metres, in the middle of what the camera sees
};

/// Positions in `frames` of views that differ from each other, spread over the frames, tracked ones only.
/// @param rolling  only frames of which the motion during read-out is known  @param most  of them, about
[[nodiscard]] std::vector<std::size_t> choose_views(const std::vector<LookedFrame>& frames,
                                                    const ViewDistance& distance, bool rolling, std::size_t most);

/// How the camera moved while a frame was read out, by the poses round it; nullopt: none is known on either side.
/// @param both  nullopt already if none is known on one of them
[[nodiscard]] std::optional<FrameReadout> readout_of(const std::vector<LookedFrame>& frames, std::size_t i, Way way,
                                                     bool both);

/// @param at  positions in `frames`  @param rolling  the motion during read-out matters
[[nodiscard]] std::vector<KeyframeImages> load_views(const Recording& recording, const std::vector<LookedFrame>& frames,
                                                     const std::vector<std::size_t>& at, bool rolling);

/// Does the camera go smoothly or straight from frame to frame? The bundle is given the motions that fit it better.
/// @param bundle  of load_views() of the same frames, rolling
Way choose_way(Bundle& bundle, const std::vector<LookedFrame>& frames, const std::vector<std::size_t>& at);

[[nodiscard]] RowTimes row_times(const ShutterConfig& shutter);

}  // namespace posefusion
