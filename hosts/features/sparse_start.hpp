#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/byte_stream.hpp"
#include "engine/core/depth_noise.hpp"
#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "engine/tracking/start_pose.hpp"
#include "hosts/features/features.hpp"

namespace posefusion {

/// How the camera moved, by features: since the previous frame, since a reference frame that is kept while it is seen,
/// and, after a break (neither is recognised), since earlier reference frames. Called once per frame, in order, by one
/// thread.
class SparseStart {
public:
    SparseStart(const Intrinsics& camera, const DepthNoise& noise, const FeatureConfig& config)
        : camera_(camera), noise_(noise), config_(config) {}

    /// @param labels  people, whose pixels have no features; empty: none
    /// @return the motions that are supported well enough (FeatureConfig): since the previous frame, the reference, and
    /// the place that is recognised best
    [[nodiscard]] std::vector<StartPose> find(const ColorImage& color, const DepthImage& depth,
                                              const LabelImage& labels);

    /// The next frame is the first.
    void restart() { *this = SparseStart(camera_, noise_, config_); }

    /// The memory between calls.
    [[nodiscard]] ByteArray state() const;
    /// Throws Error if the bytes are not such a state.
    void restore(std::span<const std::byte> state);

private:
    /// A view that can be recognised.
    struct View {
        Features features;
        std::uint32_t frame = 0;  ///< counted from 0
    };

    [[nodiscard]] std::optional<StartPose> look_back(const View& earlier, const Features& current) const;
    void replace_reference();
    void look_for_places(const Features& current, std::vector<StartPose>& starts);

    Intrinsics camera_;
    DepthNoise noise_;
    FeatureConfig config_;
    std::uint32_t frame_ = 0;         ///< of the next call
    View previous_, reference_;       ///< without features: there is none
    std::vector<View> places_;        ///< oldest first
    std::uint32_t next_place_ = 0;    ///< the one to be compared next
    bool adrift_ = false;             ///< nothing from before the last break has been recognised
    std::uint32_t search_until_ = 0;  ///< frame
};

}  // namespace posefusion
