#include "engine/preprocess/undistortion.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <span>
#include <string>

#include "engine/core/error.hpp"
#include "engine/vulkan/sequence.hpp"
#include "engine/vulkan/transfer.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

constexpr std::uint32_t kMostGroups = 65535;  // guaranteed by Vulkan on every device
const std::string kUndistort = "preprocess/undistort";

const LensMap& checked(const LensMap& lens, const Context& context) {
    if (lens.size() > Undistortion::most_pixels(context)) {
        throw Error("lens: images of " + std::to_string(lens.width()) + "x" + std::to_string(lens.height()) +
                    " are too large for device '" + context.info().name + "'; use smaller ones");
    }
    const bool finite =
        std::all_of(lens.begin(), lens.end(), [](PixelPosition p) { return std::isfinite(p.u) && std::isfinite(p.v); });
    if (lens.empty() || !finite)
        throw Error("lens: its distortion cannot be undone everywhere; correct the distortion in the camera file");
    return lens;
}

template <class Pixel>
void check_size(const Image<Pixel>& image, const char* what, int width, int height) {
    if (image.width() == width && image.height() == height) return;
    throw Error(std::string("the ") + what + " image is " + std::to_string(image.width()) + "x" +
                std::to_string(image.height()) + " but the lens was measured for " + std::to_string(width) + "x" +
                std::to_string(height) + "; correct the image or the camera file");
}

}  // namespace

struct Undistortion::Impl {
    std::shared_ptr<Context> shared_context;
    int width, height;
    std::size_t pixels;
    Buffer lens, host_color, host_depth, distorted_color, distorted_depth, color, depth;
    Kernel undistort;
    Sequence sequence;
    std::mutex busy;  ///< held while the buffers are used

    Impl(std::shared_ptr<Context> context, const LensMap& map)
        : shared_context(std::move(context)),
          width(map.width()),
          height(map.height()),
          pixels(checked(map, *shared_context).size()),
          lens(device_buffer<PixelPosition>(*shared_context, pixels, "lens")),
          host_color(host_buffer<std::uint32_t>(*shared_context, pixels, "host colour of the lens")),
          host_depth(host_buffer<float>(*shared_context, pixels, "host depth of the lens")),
          distorted_color(device_buffer<std::uint32_t>(*shared_context, pixels, "distorted colour")),
          distorted_depth(device_buffer<float>(*shared_context, pixels, "distorted depth")),
          color(device_buffer<std::uint32_t>(*shared_context, pixels, "undistorted colour")),
          depth(device_buffer<float>(*shared_context, pixels, "undistorted depth")),
          undistort(*shared_context, kUndistort),
          sequence(*shared_context) {
        write(*shared_context, std::as_bytes(std::span(map.data(), pixels)), lens);
        sequence.stage("undistort");
        sequence.copy(host_color, distorted_color, host_color.bytes());
        sequence.copy(host_depth, distorted_depth, host_depth.bytes());
        sequence.dispatch(undistort,
                          {{"lens", lens},
                           {"distorted_color", distorted_color},
                           {"distorted_depth", distorted_depth},
                           {"color", color},
                           {"depth", depth}},
                          {{"width", width}, {"height", height}},
                          undistort.groups_for(static_cast<std::uint32_t>(pixels)));
        sequence.copy(color, host_color, host_color.bytes());
        sequence.copy(depth, host_depth, host_depth.bytes());
        sequence.finish();
    }
};

std::size_t Undistortion::most_pixels(const Context& context) {
    return std::min<std::size_t>(context.max_buffer_bytes() / sizeof(PixelPosition),
                                 std::size_t{kMostGroups} * shader_named(kUndistort).group_size[0]);
}

Undistortion::Undistortion(std::shared_ptr<Context> context, const LensMap& lens)
    : impl_(std::make_unique<Impl>(std::move(context), lens)) {}
Undistortion::~Undistortion() = default;
Undistortion::Undistortion(Undistortion&&) noexcept = default;
Undistortion& Undistortion::operator=(Undistortion&&) noexcept = default;

UndistortTime Undistortion::apply(ColorImage& color, DepthImage& depth) const {
    Impl& s = *impl_;
    check_size(color, "colour", s.width, s.height);
    check_size(depth, "depth", s.width, s.height);
    const std::lock_guard lock(s.busy);
    const auto colors = s.host_color.host<std::uint32_t>();
    const auto depths = s.host_depth.host<float>();
    for (std::size_t i = 0; i < s.pixels; ++i) colors[i] = pack_rgb(color[i]);
    std::copy(depth.begin(), depth.end(), depths.begin());
    const auto start = std::chrono::steady_clock::now();
    s.sequence.run();
    const double wall_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    for (std::size_t i = 0; i < s.pixels; ++i) color[i] = unpack_rgb(colors[i]);
    std::copy_n(depths.begin(), s.pixels, depth.begin());
    const auto times = s.sequence.times();
    if (times.empty()) return {};
    return {times[0].milliseconds, std::max(0.0, wall_ms - times[0].milliseconds)};
}

}  // namespace posefusion
