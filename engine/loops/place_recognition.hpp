#pragma once
#include "engine/core/intrinsics.hpp"
#include "engine/loops/fern_database.hpp"
#include "engine/preprocess/preprocessing.hpp"
#include "engine/vulkan/sequence.hpp"

namespace posefusion {

/// Finds earlier views that resemble the current frame. The device downsamples every frame, the ferns encode it.
class PlaceRecognition {
public:
    /// @param depth_max  farthest depth used, metres
    PlaceRecognition(vulkan::Context& context, const Intrinsics& camera, float depth_max, const FernConfig& config);

    /// Part of every frame: downsamples the prediction, or the live frame where tracking has failed.
    void enqueue_thumbnail(vulkan::Sequence& sequence, const vulkan::Buffer& params, const vulkan::Buffer& record,
                           const vulkan::Buffer& model_color, const vulkan::Buffer& model_depth,
                           const Preprocessing& frame) const;
    /// Of the frame that has just run.
    [[nodiscard]] FernCode code_of_frame() const;

    [[nodiscard]] FernDatabase& database() { return database_; }
    [[nodiscard]] const FernDatabase& database() const { return database_; }
    [[nodiscard]] const FernIdentity& identity() const { return identity_; }
    /// Throws Error unless codes made with `ferns` are comparable with those of this object.
    void check(const FernIdentity& ferns) const;

private:
    int width_, height_;  ///< of a downsampled view, pixels
    FernIdentity identity_;
    FernDatabase database_;
    vulkan::Kernel thumbnail_;
    vulkan::Buffer texels_, host_texels_;
};

}  // namespace posefusion
