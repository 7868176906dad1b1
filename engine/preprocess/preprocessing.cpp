#include "engine/preprocess/preprocessing.hpp"

#include <algorithm>
#include <cmath>

namespace posefusion {

using namespace vulkan;

namespace {

constexpr float kMaxDilation = gpu::MASK_WORD - 1;  // mask_dilate looks at the next word of the mask only

std::uint32_t mask_words(const Intrinsics& camera) {
    return ceil_div(static_cast<std::uint32_t>(camera.width), gpu::MASK_WORD) *
           static_cast<std::uint32_t>(camera.height);
}

}  // namespace

void set_params(gpu::Params& params, const PreprocessConfig& config, const Intrinsics& camera) {
    const float dilation =
        std::ceil(static_cast<float>(config.mask_dilation) * static_cast<float>(camera.width) / kReferenceWidth);
    params.dilation = static_cast<gpu::uint>(std::clamp(dilation, 0.0f, kMaxDilation));
    params.depth_min = config.depth_min, params.depth_max = config.depth_max;
    params.bilateral_space = 0.5f / (PreprocessConfig::kBilateralSpace * PreprocessConfig::kBilateralSpace);
    params.bilateral_range = 0.5f / (PreprocessConfig::kBilateralRange * PreprocessConfig::kBilateralRange);
}

ImagePyramid::ImagePyramid(Context& context, const Intrinsics& camera, const std::string& name) {
    for (int level = 0; level < kLevels; ++level) {
        const std::uint32_t n = pixels_at(camera, level);
        const std::string suffix = " " + std::to_string(level);
        depth[level] = device_buffer<float>(context, n, name + " depth" + suffix);
        intensity[level] = device_buffer<float>(context, n, name + " intensity" + suffix);
        geometry[level] = device_buffer<gpu::vec4>(context, n, name + " geometry" + suffix);
        photometric[level] = device_buffer<gpu::vec4>(context, n, name + " photometric" + suffix);
    }
}

PyramidBuilder::PyramidBuilder(Context& context, const Intrinsics& camera, const PreprocessConfig& config)
    : camera_(camera),
      downsample_(context, "preprocess/downsample"),
      plane_normals_(context, "preprocess/plane_normals", {{"RADIUS", config.normal_radius}}),
      normals_up_(context, "preprocess/normals_up"),
      normals_down_(context, "preprocess/normals_down"),
      gradients_(context, "preprocess/gradients") {}

void PyramidBuilder::enqueue_halves(Sequence& sequence, const Buffer& params, const ImagePyramid& pyramid) const {
    for (int level = 0; level + 1 < kLevels; ++level) {
        sequence.dispatch(downsample_,
                          {{"params", params},
                           {"depth", pyramid.depth[level]},
                           {"intensity", pyramid.intensity[level]},
                           {"half_depth", pyramid.depth[level + 1]},
                           {"half_intensity", pyramid.intensity[level + 1]}},
                          {{"level", level}}, downsample_.groups_for(pixels_at(camera_, level + 1)));
    }
    for (int level = 0; level < kLevels; ++level) {
        sequence.dispatch(
            gradients_,
            {{"params", params}, {"intensity", pyramid.intensity[level]}, {"photometric", pyramid.photometric[level]}},
            {{"level", level}}, gradients_.groups_for(pixels_at(camera_, level)));
    }
}

void PyramidBuilder::enqueue_normals_down(Sequence& sequence, const Buffer& params, const ImagePyramid& pyramid,
                                          int level) const {
    sequence.dispatch(normals_down_,
                      {{"params", params},
                       {"geometry", pyramid.geometry[level]},
                       {"half_depth", pyramid.depth[level + 1]},
                       {"half_geometry", pyramid.geometry[level + 1]}},
                      {{"level", level}}, normals_down_.groups_for(pixels_at(camera_, level + 1)));
}

void PyramidBuilder::enqueue_live(Sequence& sequence, const Buffer& params, const ImagePyramid& pyramid) const {
    enqueue_halves(sequence, params, pyramid);
    for (int level = kLevels - 1; level >= 1; --level) {
        const bool use_coarse = level + 1 < kLevels;
        sequence.dispatch(plane_normals_,
                          {{"params", params},
                           {"depth", pyramid.depth[level]},
                           {"coarse_geometry", pyramid.geometry[use_coarse ? level + 1 : 0]},
                           {"geometry", pyramid.geometry[level]}},
                          {{"level", level}, {"use_coarse", use_coarse}},
                          plane_normals_.groups_for(pixels_at(camera_, level)));
    }
    sequence.dispatch(normals_up_,
                      {{"params", params},
                       {"depth", pyramid.depth[0]},
                       {"coarse_geometry", pyramid.geometry[1]},
                       {"geometry", pyramid.geometry[0]}},
                      normals_up_.groups_for(pixels_at(camera_, 0)));
}

void PyramidBuilder::enqueue_model(Sequence& sequence, const Buffer& params, const ImagePyramid& pyramid) const {
    enqueue_halves(sequence, params, pyramid);
    enqueue_normals_down(sequence, params, pyramid, 0);
    enqueue_normals_down(sequence, params, pyramid, 1);
}

Preprocessing::Preprocessing(Context& context, const Intrinsics& camera, const PreprocessConfig& config,
                             const ShutterConfig& shutter)
    : depth(device_buffer<float>(context, pixels_at(camera, 0), "depth")),
      color(device_buffer<std::uint32_t>(context, pixels_at(camera, 0), "colour")),
      mask(device_buffer<std::uint32_t>(context, mask_words(camera), "mask")),
      dilated_mask(device_buffer<std::uint32_t>(context, mask_words(camera), "dilated mask")),
      static_depth(device_buffer<float>(context, pixels_at(camera, 0), "static depth")),
      live(context, camera, "live"),
      camera_(camera),
      host_depth_(host_buffer<float>(context, pixels_at(camera, 0), "host depth")),
      host_color_(host_buffer<std::uint32_t>(context, pixels_at(camera, 0), "host colour")),
      pack_(context, "preprocess/mask_pack"),
      dilate_(context, "preprocess/mask_dilate"),
      static_depth_(context, "preprocess/static_depth"),
      bilateral_(context, "preprocess/bilateral", {{"RADIUS", config.bilateral_radius}}) {
    if (!shutter.is_global()) shutter_.emplace(context, camera);
}

void Preprocessing::upload(const ColorImage& colors, const DepthImage& depths, const LabelImage& labels) const {
    const auto host_depth = host_depth_.host<float>();
    const auto host_color = host_color_.host<std::uint32_t>();
    for (std::size_t i = 0; i < depths.size(); ++i) {
        host_depth[i] = std::isfinite(depths[i]) ? depths[i] : 0.0f;
        const std::uint32_t label = labels.empty() ? 0u : labels[i];
        host_color[i] = pack_rgb(colors[i]) | label << 24;
    }
}

void Preprocessing::enqueue(Sequence& sequence, const Buffer& params, const Buffer& record,
                            const PyramidBuilder& builder, GlobalShutter::Motion motion) const {
    const std::uint32_t n = pixels_at(camera_, 0);
    if (shutter_) {
        shutter_->enqueue(sequence, params, record, host_depth_, host_color_, depth, color, motion);
    } else {
        sequence.copy(host_depth_, depth, n * sizeof(float));
        sequence.copy(host_color_, color, n * sizeof(std::uint32_t));
    }
    sequence.dispatch(pack_, {{"params", params}, {"color", color}, {"mask", mask}},
                      pack_.groups_for(mask_words(camera_)));
    sequence.dispatch(dilate_, {{"params", params}, {"mask", mask}, {"dilated_mask", dilated_mask}},
                      dilate_.groups_for(mask_words(camera_)));
    sequence.dispatch(static_depth_,
                      {{"params", params},
                       {"record", record},
                       {"depth", depth},
                       {"color", color},
                       {"dilated_mask", dilated_mask},
                       {"static_depth", static_depth},
                       {"intensity", live.intensity[0]}},
                      static_depth_.groups_for(ceil_div(n, gpu::PIXELS_PER_INVOCATION)));
    sequence.dispatch(
        bilateral_, {{"params", params}, {"static_depth", static_depth}, {"filtered_depth", live.depth[0]}},
        bilateral_.groups_for(ceil_div(static_cast<std::uint32_t>(camera_.width), gpu::PIXELS_PER_INVOCATION),
                              static_cast<std::uint32_t>(camera_.height)));
    builder.enqueue_live(sequence, params, live);
}

}  // namespace posefusion
