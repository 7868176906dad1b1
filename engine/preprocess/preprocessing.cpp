#include "engine/preprocess/preprocessing.hpp"

#include "engine/vulkan/shared_types.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

std::uint32_t mask_words(const Intrinsics& camera) {
    return static_cast<std::uint32_t>((camera.width + 31) / 32 * camera.height);
}

struct LevelPush {
    std::uint32_t level;
};
struct NormalsPush {
    std::uint32_t level, use_coarse;
};

}  // namespace

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
      downsample_(context, "preprocess/downsample", 5, sizeof(LevelPush)),
      plane_normals_(context, "preprocess/plane_normals", 4, sizeof(NormalsPush),
                     {static_cast<std::uint32_t>(config.normal_radius)}),
      normals_up_(context, "preprocess/normals_up", 4),
      normals_down_(context, "preprocess/normals_down", 4, sizeof(LevelPush)),
      gradients_(context, "preprocess/gradients", 3, sizeof(LevelPush)) {}

void PyramidBuilder::enqueue_halves(Sequence& sequence, const Buffer& params, const ImagePyramid& pyramid) const {
    for (std::uint32_t level = 0; level + 1 < kLevels; ++level) {
        sequence.dispatch(downsample_,
                          {in(params), in(pyramid.depth[level]), in(pyramid.intensity[level]),
                           out(pyramid.depth[level + 1]), out(pyramid.intensity[level + 1])},
                          LevelPush{level}, Groups::covering(pixels_at(camera_, static_cast<int>(level) + 1), 64));
    }
    for (std::uint32_t level = 0; level < kLevels; ++level) {
        sequence.dispatch(gradients_, {in(params), in(pyramid.intensity[level]), out(pyramid.photometric[level])},
                          LevelPush{level}, Groups::covering(pixels_at(camera_, static_cast<int>(level)), 64));
    }
}

void PyramidBuilder::enqueue_normals_down(Sequence& sequence, const Buffer& params, const ImagePyramid& pyramid,
                                          std::uint32_t level) const {
    sequence.dispatch(
        normals_down_,
        {in(params), in(pyramid.geometry[level]), in(pyramid.depth[level + 1]), out(pyramid.geometry[level + 1])},
        LevelPush{level}, Groups::covering(pixels_at(camera_, static_cast<int>(level) + 1), 64));
}

void PyramidBuilder::enqueue_live(Sequence& sequence, const Buffer& params, const ImagePyramid& pyramid) const {
    enqueue_halves(sequence, params, pyramid);
    for (int level = kLevels - 1; level >= 1; --level) {
        const bool use_coarse = level + 1 < kLevels;
        sequence.dispatch(plane_normals_,
                          {in(params), in(pyramid.depth[level]), in(pyramid.geometry[use_coarse ? level + 1 : 0]),
                           out(pyramid.geometry[level])},
                          NormalsPush{static_cast<std::uint32_t>(level), use_coarse},
                          Groups::covering(pixels_at(camera_, level), 64));
    }
    sequence.dispatch(normals_up_,
                      {in(params), in(pyramid.depth[0]), in(pyramid.geometry[1]), out(pyramid.geometry[0])},
                      Groups::covering(pixels_at(camera_, 0), 64));
}

void PyramidBuilder::enqueue_model(Sequence& sequence, const Buffer& params, const ImagePyramid& pyramid) const {
    enqueue_halves(sequence, params, pyramid);
    enqueue_normals_down(sequence, params, pyramid, 0);
    enqueue_normals_down(sequence, params, pyramid, 1);
}

Preprocessing::Preprocessing(Context& context, const Intrinsics& camera, const PreprocessConfig& config)
    : host_depth(host_buffer<float>(context, pixels_at(camera, 0), "host depth")),
      host_color(host_buffer<std::uint32_t>(context, pixels_at(camera, 0), "host colour")),
      depth(device_buffer<float>(context, pixels_at(camera, 0), "depth")),
      color(device_buffer<std::uint32_t>(context, pixels_at(camera, 0), "colour")),
      mask(device_buffer<std::uint32_t>(context, mask_words(camera), "mask")),
      dilated_mask(device_buffer<std::uint32_t>(context, mask_words(camera), "dilated mask")),
      static_depth(device_buffer<float>(context, pixels_at(camera, 0), "static depth")),
      live(context, camera, "live"),
      camera_(camera),
      pack_(context, "preprocess/mask_pack", 3),
      dilate_(context, "preprocess/mask_dilate", 3),
      static_depth_(context, "preprocess/static_depth", 6),
      bilateral_(context, "preprocess/bilateral", 3, 0, {static_cast<std::uint32_t>(config.bilateral_radius)}) {}

void Preprocessing::enqueue(Sequence& sequence, const Buffer& params, const PyramidBuilder& builder) const {
    const std::uint32_t n = pixels_at(camera_, 0);
    sequence.copy(host_depth, depth, n * sizeof(float));
    sequence.copy(host_color, color, n * sizeof(std::uint32_t));
    sequence.dispatch(pack_, {in(params), in(color), out(mask)}, Groups::covering(mask_words(camera_), 64));
    sequence.dispatch(dilate_, {in(params), in(mask), out(dilated_mask)}, Groups::covering(mask_words(camera_), 64));
    sequence.dispatch(static_depth_,
                      {in(params), in(depth), in(color), in(dilated_mask), out(static_depth), out(live.intensity[0])},
                      Groups::covering(n, 256));
    sequence.dispatch(bilateral_, {in(params), in(static_depth), out(live.depth[0])},
                      {Groups::covering(static_cast<std::uint32_t>(camera_.width), 64).x,
                       Groups::covering(static_cast<std::uint32_t>(camera_.height), 4).x});
    builder.enqueue_live(sequence, params, live);
}

}  // namespace posefusion
