#pragma once
#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/byte_stream.hpp"
#include "engine/core/depth_noise.hpp"
#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "pose/joints.hpp"
#include "segmentation/skeleton.hpp"

namespace posefusion {

enum class SegmentationMode {
    Image,  ///< min-cut on the organised image, 3-D distance to the skeleton: the default
    Paper,  ///< eq. (2) and (3) to the letter on PCL's MinCutSegmentation: the reference
};

/// Parameters of step 2 of the paper. The image mode measures distances from the surface of the body and steps from
/// surface to surface: its own lengths (EvidenceConfig, SmoothnessConfig, RefinementConfig) are given at the default
/// radius and sigma below and grow in proportion to them.
struct SegmentationConfig {
    SegmentationMode mode = SegmentationMode::Image;
    float sigma = 0.25f;   ///< eq. (2): length over which neighbours are held together, metres
    float radius = 0.20f;  ///< eq. (3), r: distance from the skeleton at which background wins, metres
    /// Image: things that appeared together with a person and are connected to one (carried or pushed) are cut as well,
    /// up to this distance from the body, metres. 0 = the body alone.
    float reach = 1;
    int paper_step = 4;     ///< Paper: the cloud takes one point of this many pixels in each direction
    int carry_frames = 15;  ///< Image: how many frames a mask is kept when the network misses a person
};

struct Segmentation {
    LabelImage labels;  ///< full resolution, 0 = static, 1..n = person (not the order of People across frames)
    /// Of person 1..n, camera coordinates; one without a joint: not known. Empty if the labels are not from joints.
    std::vector<Skeleton> skeletons;
    int people = 0;   ///< people cut out, carried ones included
    int carried = 0;  ///< of these, masks carried on from earlier frames without a detection
};

/// The segmentation of known labels, without carried masks.
[[nodiscard]] Segmentation segmentation_of(LabelImage labels);

/// The depth image without people: 0 where `labels`, of the same size, are not 0.
[[nodiscard]] DepthImage remove_people(const DepthImage& depth, const LabelImage& labels);

/// Step 2 of the paper: joints + depth -> which pixels are people. Stateful: remembers the last frame's masks to keep
/// people whom the network misses. Deterministic: same calls, same result.
class Segmenter {
public:
    virtual ~Segmenter() = default;
    /// @param people              this frame's joints; nullopt if the network did not run on this frame
    /// @param T_previous_current  camera motion since the previous call (current camera coordinates -> previous), as
    /// far
    ///                            as it is known (the scheduler extrapolates); only used to carry masks
    [[nodiscard]] virtual Segmentation segment(const ColorImage& color, const DepthImage& depth,
                                               const std::optional<People>& people,
                                               const Eigen::Isometry3f& T_previous_current) = 0;
    /// The memory between calls, for a later restore() into a segmenter of the same configuration and camera: it then
    /// continues with the same results.
    [[nodiscard]] virtual ByteArray state() const = 0;
    /// Throws Error if the bytes are not such a state.
    virtual void restore(std::span<const std::byte> state) = 0;
};

/// @param noise  of the depth camera, as assumed by tracking and mapping (SlamConfig::noise)
/// Throws Error if the parameters are invalid; segment() throws Error for images of another size than the camera's.
[[nodiscard]] std::unique_ptr<Segmenter> make_segmenter(const SegmentationConfig& config, const Intrinsics& camera,
                                                        const DepthNoise& noise);

}  // namespace posefusion
