#pragma once
#include "engine/preprocess/preprocessing.hpp"

namespace posefusion {

/// The exposure of each frame relative to that of the map (its first frame): a factor per colour channel, from pixels
/// whose surface the model shows, too. It ends in gpu::TrackingRecord::exposure, by which colours are brought into the
/// map and the intensities of the next frame to those of the model.
class Exposure {
public:
    Exposure(vulkan::Context& context, const Intrinsics& camera);
    /// @param record  after tracking  @param model_geometry, model_color  prediction at the last pose: [pixels]
    void enqueue(vulkan::Sequence& sequence, const vulkan::Buffer& params, const vulkan::Buffer& record,
                 const Preprocessing& frame, const vulkan::Buffer& model_geometry,
                 const vulkan::Buffer& model_color) const;

private:
    std::uint32_t groups_;
    vulkan::Buffer rows_, row_counts_;
    vulkan::Kernel reduce_, solve_;
};

}  // namespace posefusion
