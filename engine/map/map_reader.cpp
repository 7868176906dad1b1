#include "engine/map/map_reader.hpp"

#include <algorithm>
#include <span>

#include "engine/core/byte_elements.hpp"
#include "engine/core/error.hpp"
#include "engine/vulkan/pose_conversion.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

/// Live slots of the three streams (shaders/include/surfel.glsl).
std::vector<Surfel> live_surfels(std::span<const gpu::vec4> p, std::span<const gpu::vec4> n,
                                 std::span<const gpu::uvec4> a, float min_confidence) {
    const auto to_byte = [](std::uint32_t unorm16) { return static_cast<std::uint8_t>((unorm16 & 0xffff) / 257); };
    std::vector<Surfel> surfels;
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
    return surfels;
}

}  // namespace

std::vector<Surfel> read_surfels(Context& context, const SurfelMap& map, float min_confidence) {
    const std::uint32_t slots = map.slots();
    if (slots == 0) return {};
    const Buffer positions = host_buffer<gpu::vec4>(context, slots, "positions read back");
    const Buffer normals = host_buffer<gpu::vec4>(context, slots, "normals read back");
    const Buffer appearances = host_buffer<gpu::uvec4>(context, slots, "appearances read back");
    Sequence sequence(context);
    sequence.copy(map.streams().position_confidence, positions, positions.bytes());
    sequence.copy(map.streams().normal_radius, normals, normals.bytes());
    sequence.copy(map.streams().appearance, appearances, appearances.bytes());
    sequence.finish();
    sequence.run();
    return live_surfels({positions.host<gpu::vec4>().data(), slots}, {normals.host<gpu::vec4>().data(), slots},
                        {appearances.host<gpu::uvec4>().data(), slots}, min_confidence);
}

std::vector<Surfel> surfels_of(const MapState& state, float min_confidence) {
    const auto positions = elements_of<gpu::vec4>(state.position_confidence, state.slots);
    const auto normals = elements_of<gpu::vec4>(state.normal_radius, state.slots);
    const auto appearances = elements_of<gpu::uvec4>(state.appearance, state.slots);
    if (normals.size() != positions.size() || appearances.size() != positions.size())
        throw Error("the map contradicts itself; use another copy");
    return live_surfels(positions, normals, appearances, min_confidence);
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
