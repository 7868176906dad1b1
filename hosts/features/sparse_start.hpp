#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/byte_stream.hpp"
#include "engine/core/depth_noise.hpp"
#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "engine/tracking/start_pose.hpp"
#include "hosts/features/features.hpp"

namespace posefusion {

/// How the camera moved, by features: since the previous frame, and since a reference frame that is kept while it is
/// seen. Called once per frame, in order, by one thread.
class SparseStart {
public:
    SparseStart(const Intrinsics& camera, const DepthNoise& noise, const FeatureConfig& config)
        : camera_(camera), noise_(noise), config_(config) {}

    /// @param labels  people, whose pixels have no features; empty: none
    /// @return the motions that are supported well enough (FeatureConfig); that since the previous frame first
    [[nodiscard]] std::vector<StartPose> find(const ColorImage& color, const DepthImage& depth,
                                              const LabelImage& labels);

    /// The next frame is the first.
    void restart() { *this = SparseStart(camera_, noise_, config_); }

    /// The memory between calls.
    [[nodiscard]] ByteArray state() const;
    /// Throws Error if the bytes are not such a state.
    void restore(std::span<const std::byte> state);

private:
    Intrinsics camera_;
    DepthNoise noise_;
    FeatureConfig config_;
    Features previous_, reference_;
    std::uint32_t reference_age_ = 0;  ///< frames from the reference to the previous frame
};

}  // namespace posefusion
