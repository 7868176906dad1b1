#pragma once
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/byte_stream.hpp"
#include "engine/core/image.hpp"

namespace posefusion {

/// Labels of people end here, those of other moving things begin after it.
inline constexpr std::uint8_t kLastPersonLabel = 100;
inline constexpr std::uint8_t kFirstMoverLabel = kLastPersonLabel + 1;

/// One image of the labels of people (up to kLastPersonLabel) and of movers. Either may be empty: nothing.
[[nodiscard]] inline LabelImage with_movers(const LabelImage& people, const LabelImage& movers) {
    LabelImage labels = people.empty() ? movers : people;
    for (std::size_t i = 0; i < people.size(); ++i) {
        labels[i] = std::min(people[i], kLastPersonLabel);
        if (labels[i] == 0 && !movers.empty()) labels[i] = movers[i];
    }
    return labels;
}

/// A rigid thing among what moves, in a frame in which it was tracked.
struct MovingObject {
    std::uint8_t label = 0;  ///< in the label image, from kFirstMoverLabel on; the same in all frames
    Eigen::Isometry3d T_camera_object = Eigen::Isometry3d::Identity();
    std::uint32_t pixels = 0;  ///< in the label image
};

/// How well a tracked frame fits the map.
struct TrackingFit {
    float icp_scale = 0;         ///< of the distances, in standard deviations of the depth noise
    float photometric_rmse = 0;  ///< intensity, 0..1
};

/// Decides what moves in a frame and is no person. The engine asks between tracking and fusion:
///   begin(), then suspect(), and find() for each pose that tracking proposes, then end() with the pose that was kept;
///   or restart().
/// Deterministic: same calls, same result.
class MotionJudge {
public:
    virtual ~MotionJudge() = default;

    /// A new frame. The images must stay alive until end() or restart().
    /// @param people  non-zero where there are people, of the size of the images; empty = nobody
    /// @return what moved in the frame before, where it is expected now (0 or kFirstMoverLabel ..); empty = nothing
    virtual LabelImage begin(const ColorImage& color, const DepthImage& depth, const LabelImage& people) = 0;
    /// What moves, if this is how the camera has moved: 0, or kFirstMoverLabel .. one label per thing; empty = nothing.
    /// @param T_previous_current  current camera coordinates to those of the frame before
    virtual LabelImage find(const Eigen::Isometry3f& T_previous_current) = 0;
    /// What tracking rests on most, where it fits the map less well than it is used to: one connected thing, near and
    /// in front of the rest. If it moves, it takes the camera along. 1, others 0; empty = there is no such thing.
    virtual LabelImage suspect(const TrackingFit& fit) {
        (void)fit;
        return {};
    }
    /// Without the suspect all else fits much better: find() marks it.
    virtual void accuse(const LabelImage& suspect) { (void)suspect; }
    /// Keeps the frame as evidence for later ones. What moved is what find() returned last.
    virtual void end(const Eigen::Isometry3f& T_previous_current) = 0;
    /// The camera's motion is not known: forgets the frames before.
    virtual void restart() = 0;

    /// The rigid things whose poses are known in the frame that was ended last, by ascending label.
    [[nodiscard]] virtual std::vector<MovingObject> objects() const { return {}; }

    /// The memory between frames, for a later restore() into a judge of the same configuration and camera.
    [[nodiscard]] virtual ByteArray state() const = 0;
    /// Throws Error if the bytes are not such a state.
    virtual void restore(std::span<const std::byte> state) = 0;
};

}  // namespace posefusion
