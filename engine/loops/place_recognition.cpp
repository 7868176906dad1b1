#include "engine/loops/place_recognition.hpp"

#include <string>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

/// A pixel as written by shaders/loops/thumbnail.comp.
struct Texel {
    std::uint32_t color;  ///< pack_rgb()
    float depth;          ///< metres, 0 = unknown
};

std::size_t texel_count(const Intrinsics& camera) {
    return static_cast<std::size_t>(camera.width / FernConfig::kShrink) *
           static_cast<std::size_t>(camera.height / FernConfig::kShrink);
}

}  // namespace

PlaceRecognition::PlaceRecognition(Context& context, const Intrinsics& camera, float depth_max,
                                   const FernConfig& config)
    : width_(camera.width / FernConfig::kShrink),
      height_(camera.height / FernConfig::kShrink),
      identity_{config.ferns, FernConfig::kShrink, config.seed, depth_max},
      database_(width_, height_, depth_max, config),
      thumbnail_(context, "loops/thumbnail", {{"SHRINK", FernConfig::kShrink}}),
      texels_(device_buffer<Texel>(context, texel_count(camera), "thumbnail")),
      host_texels_(host_buffer<Texel>(context, texel_count(camera), "host thumbnail")) {}

void PlaceRecognition::enqueue_thumbnail(Sequence& sequence, const Buffer& params, const Buffer& record,
                                         const Buffer& model_color, const Buffer& model_depth,
                                         const Preprocessing& frame) const {
    sequence.dispatch(thumbnail_,
                      {{"params", params},
                       {"record", record},
                       {"model_color", model_color},
                       {"model_depth", model_depth},
                       {"color", frame.color},
                       {"static_depth", frame.static_depth},
                       {"thumbnail", texels_}},
                      thumbnail_.groups_for(static_cast<std::uint32_t>(width_ * height_)));
    sequence.copy(texels_, host_texels_, texels_.bytes());
}

FernCode PlaceRecognition::code_of_frame() const {
    Thumbnail view{width_, height_, {}};
    for (const Texel& texel : host_texels_.host<Texel>()) {
        const Rgb8 c = unpack_rgb(texel.color);
        view.pixels.push_back({c.r, c.g, c.b, texel.depth});
    }
    return database_.encode(view);
}

void PlaceRecognition::check(const FernIdentity& ferns) const {
    if (ferns == identity_) return;
    throw Error("the keyframes of the map were coded by other ferns; use its loops.ferns = " +
                std::to_string(ferns.ferns) + ", loops.fern_seed = " + std::to_string(ferns.seed) +
                " and preprocess.depth_max = " + shortest_text(ferns.depth_max));
}

}  // namespace posefusion
