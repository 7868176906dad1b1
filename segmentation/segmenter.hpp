#pragma once
#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <span>

#include "engine/core/byte_stream.hpp"
#include "engine/core/depth_noise.hpp"
#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "pose/joints.hpp"

namespace posefusion {

enum class SegmentationMode {
    Image,  ///< min-cut on the organised image, 3-D distance to the skeleton: the default
    Paper,  ///< eq. (2) and (3) to the letter on PCL's MinCutSegmentation: the reference
};

/// Numbers of step 2 of the paper and of ours. Add what the implementation needs, each with unit and source.
struct SegmentationConfig {
    SegmentationMode mode = SegmentationMode::Image;
    float sigma = 0.25f;    ///< Paper: eq. (2), smoothness length scale, metres
    float radius = 0.20f;   ///< Paper: eq. (3), r: distance from the skeleton at which background wins, metres
    int paper_step = 4;     ///< Paper: the cloud takes one point of so many pixels in each direction
    int carry_frames = 15;  ///< Image: how many frames a mask lives on when the network misses a person
};

struct Segmentation {
    LabelImage labels;  ///< full resolution, 0 = static, 1..n = person (not the order of People across frames)
    int people = 0;     ///< people cut out, carried ones included
    int carried = 0;    ///< of these, masks carried on from earlier frames without a detection
};

/// Of labels that are known, nobody carried.
[[nodiscard]] Segmentation segmentation_of(LabelImage labels);

/// The depth image without people: 0 where `labels`, of the same size, are not 0.
[[nodiscard]] DepthImage static_depth(const DepthImage& depth, const LabelImage& labels);

/// Steps 2 of the paper: joints + depth -> who is foreground. Stateful: remembers the last frame's masks to carry
/// people on whom the network misses. Deterministic: same calls, same result.
class Segmenter {
public:
    virtual ~Segmenter() = default;
    /// @param people              this frame's joints; std::nullopt if the network was not run on this frame
    /// (--pose-every)
    /// @param T_previous_current  camera motion since the previous call (current camera coordinates -> previous), as
    /// far
    ///                            as it is known (the scheduler extrapolates); only used to carry masks
    [[nodiscard]] virtual Segmentation segment(const ColorImage& color, const DepthImage& depth,
                                               const std::optional<People>& people,
                                               const Eigen::Isometry3f& T_previous_current) = 0;
    /// What is remembered between calls, for a later restore() into a segmenter made of the same configuration and
    /// camera: it then goes on with the same results.
    [[nodiscard]] virtual ByteArray state() const = 0;
    /// Throws Error if the bytes are no such state.
    virtual void restore(std::span<const std::byte> state) = 0;
};

/// @param noise  of the depth camera; hosts hand over what they configure (SlamConfig::noise)
/// Throws Error if the numbers make no sense; segment() throws Error for images of another size than the camera's.
[[nodiscard]] std::unique_ptr<Segmenter> make_segmenter(const SegmentationConfig& config, const Intrinsics& camera,
                                                        const DepthNoise& noise);

}  // namespace posefusion
