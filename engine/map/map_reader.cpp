#include "engine/map/map_reader.hpp"

#include <algorithm>
#include <span>

#include "engine/core/byte_elements.hpp"
#include "engine/core/error.hpp"
#include "engine/vulkan/pose_conversion.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

/// Appends the live slots of the three streams (shaders/include/surfel.glsl).
void append_live(std::vector<Surfel>& surfels, std::span<const gpu::vec4> p, std::span<const gpu::vec4> n,
                 std::span<const gpu::uvec4> a, float min_confidence) {
    const auto to_byte = [](std::uint32_t unorm16) { return static_cast<std::uint8_t>((unorm16 & 0xffff) / 257); };
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (p[i].w <= 0 || p[i].w < min_confidence) continue;
        surfels.push_back({{p[i].x, p[i].y, p[i].z},
                           {n[i].x, n[i].y, n[i].z},
                           {to_byte(a[i].x), to_byte(a[i].x >> 16), to_byte(a[i].y)},
                           n[i].w,
                           p[i].w,
                           a[i][gpu::CREATED],
                           a[i][gpu::LAST_SEEN]});
    }
}

}  // namespace

std::vector<Surfel> read_surfels(Context& context, const SurfelMap& map, float min_confidence) {
    return read_surfels(context, map.streams(), map.slots(), min_confidence, map.slots());
}

std::vector<Surfel> read_surfels(Context& context, const SurfelStreams& streams, std::uint32_t slots,
                                 float min_confidence, std::uint32_t slice) {
    std::vector<Surfel> surfels;
    if (slots == 0) return surfels;
    const std::uint32_t most = std::min(slice, slots);
    const Buffer positions = host_buffer<gpu::vec4>(context, most, "positions read back");
    const Buffer normals = host_buffer<gpu::vec4>(context, most, "normals read back");
    const Buffer appearances = host_buffer<gpu::uvec4>(context, most, "appearances read back");
    for (std::uint32_t at = 0; at < slots; at += most) {
        const std::uint32_t count = std::min(most, slots - at);
        Sequence sequence(context);
        const auto copy = [&](const Buffer& from, const Buffer& to, std::size_t size) {
            sequence.copy(from, to, count * size, at * size);
        };
        copy(streams.position_confidence, positions, sizeof(gpu::vec4));
        copy(streams.normal_radius, normals, sizeof(gpu::vec4));
        copy(streams.appearance, appearances, sizeof(gpu::uvec4));
        sequence.finish();
        sequence.run();
        append_live(surfels, {positions.host<gpu::vec4>().data(), count}, {normals.host<gpu::vec4>().data(), count},
                    {appearances.host<gpu::uvec4>().data(), count}, min_confidence);
    }
    return surfels;
}

std::vector<Surfel> surfels_of(const MapState& state, float min_confidence) {
    const auto positions = elements_of<gpu::vec4>(state.position_confidence, state.slots);
    const auto normals = elements_of<gpu::vec4>(state.normal_radius, state.slots);
    const auto appearances = elements_of<gpu::uvec4>(state.appearance, state.slots);
    if (normals.size() != positions.size() || appearances.size() != positions.size())
        throw Error("the map contradicts itself; use another copy");
    std::vector<Surfel> surfels;
    append_live(surfels, positions, normals, appearances, min_confidence);
    return surfels;
}

ModelView render_view(Context& context, const SurfelMap& map, const Intrinsics& camera, gpu::Params params,
                      const Eigen::Isometry3d& T_world_camera, const Preprocessing& images) {
    params.predict_confidence = params.stable_confidence;
    gpu::TrackingRecord record{};
    record.world_live = to_device(T_world_camera);
    const std::uint32_t n = pixels_at(camera, 0);
    const Buffer host_params = host_buffer<gpu::Params>(context, 1, "view parameters");
    const Buffer host_record = host_buffer<gpu::TrackingRecord>(context, 1, "view record");
    const ImagePyramid view(context, camera, "view");
    const Buffer color = device_buffer<std::uint32_t>(context, n, "view colour");
    const Buffer host_color = host_buffer<std::uint32_t>(context, n, "view colour read back");
    const Buffer host_depth = host_buffer<float>(context, n, "view depth read back");
    host_params.host<gpu::Params>()[0] = params;
    host_record.host<gpu::TrackingRecord>()[0] = record;
    Sequence sequence(context);
    map.enqueue_prediction(sequence, host_params, host_record, images, false, view, color);
    sequence.copy(color, host_color, n * sizeof(std::uint32_t));
    sequence.copy(view.depth[0], host_depth, n * sizeof(float));
    sequence.finish();
    sequence.run();

    ModelView result{ColorImage(camera.width, camera.height), DepthImage(camera.width, camera.height)};
    const auto colors = host_color.host<std::uint32_t>();
    std::copy_n(host_depth.host<float>().data(), n, result.depth.data());
    for (std::uint32_t i = 0; i < n; ++i) {
        result.color[i] = unpack_rgb(colors[i]);
    }
    return result;
}

}  // namespace posefusion
