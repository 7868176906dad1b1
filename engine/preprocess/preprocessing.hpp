#pragma once
#include <array>
#include <optional>

#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "engine/preprocess/global_shutter.hpp"
#include "engine/preprocess/preprocess_config.hpp"
#include "engine/vulkan/sequence.hpp"
#include "engine/vulkan/shared_types.hpp"

namespace posefusion {

/// Copies the preprocessing configuration into the kernels' parameters.
void set_params(gpu::Params& params, const PreprocessConfig& config, const Intrinsics& camera);

inline constexpr int kLevels = gpu::LEVELS;  ///< full, half and quarter resolution

/// Number of pixels of pyramid level `level`.
[[nodiscard]] inline std::uint32_t pixels_at(const Intrinsics& camera, int level) {
    return static_cast<std::uint32_t>((camera.width >> level) * (camera.height >> level));
}

/// The pyramid of an image, live or predicted, that tracking reads: three levels of
///   depth [n] metres, intensity [n] 0..1 or -1, geometry [n] (normal, depth), photometric [n] (intensity, gradient).
struct ImagePyramid {
    std::array<vulkan::Buffer, kLevels> depth, intensity, geometry, photometric;
    ImagePyramid(vulkan::Context& context, const Intrinsics& camera, const std::string& name);
};

/// Builds levels 1 and 2 of a pyramid, the normals and the gradients.
class PyramidBuilder {
public:
    PyramidBuilder(vulkan::Context& context, const Intrinsics& camera, const PreprocessConfig& config);
    /// Live image: depth[0] and intensity[0] are given; normals are fitted at the coarser levels and upsampled.
    void enqueue_live(vulkan::Sequence& sequence, const vulkan::Buffer& params, const ImagePyramid& pyramid) const;
    /// Prediction: geometry[0] is given as well, with the surfels' normals.
    void enqueue_model(vulkan::Sequence& sequence, const vulkan::Buffer& params, const ImagePyramid& pyramid) const;

private:
    void enqueue_halves(vulkan::Sequence& sequence, const vulkan::Buffer& params, const ImagePyramid& pyramid) const;
    void enqueue_normals_down(vulkan::Sequence& sequence, const vulkan::Buffer& params, const ImagePyramid& pyramid,
                              int level) const;

    Intrinsics camera_;
    vulkan::Kernel downsample_, plane_normals_, normals_up_, normals_down_, gradients_;
};

/// Step 2 of the paper ends here: the person mask turns depth and colour into the static depth image and the live
/// pyramid. Person pixels have depth 0 and intensity -1 in all of them.
class Preprocessing {
public:
    Preprocessing(vulkan::Context& context, const Intrinsics& camera, const PreprocessConfig& config,
                  const ShutterConfig& shutter);
    /// Uploads a frame for the next run. Labels mark people (non-zero); empty = no people.
    void upload(const ColorImage& colors, const DepthImage& depths, const LabelImage& labels) const;
    /// @param record  gpu::TrackingRecord with the motion of the camera
    void enqueue(vulkan::Sequence& sequence, const vulkan::Buffer& params, const vulkan::Buffer& record,
                 const PyramidBuilder& builder, GlobalShutter::Motion motion = GlobalShutter::Motion::Expected) const;

    vulkan::Buffer depth, color;        ///< input: metres; pack_rgb() | label << 24
    vulkan::Buffer mask, dilated_mask;  ///< one bit per pixel, rows of whole words
    vulkan::Buffer static_depth;        ///< unfiltered, in range, no person
    ImagePyramid live;                  ///< from the filtered static depth

private:
    Intrinsics camera_;
    vulkan::Buffer host_depth_, host_color_;
    std::optional<GlobalShutter> shutter_;  ///< nullopt: global shutter, nothing to correct
    vulkan::Kernel pack_, dilate_, static_depth_, bilateral_;
};

}  // namespace posefusion
