#include "engine/slam/params.hpp"

#include "engine/map/surfel_map.hpp"
#include "engine/preprocess/preprocessing.hpp"
#include "engine/tracking/tracker.hpp"

namespace posefusion {

gpu::Params make_params(const Intrinsics& camera, const SlamConfig& config) {
    gpu::Params p{};
    p.fx = camera.fx, p.fy = camera.fy, p.cx = camera.cx, p.cy = camera.cy;
    p.width = static_cast<gpu::uint>(camera.width), p.height = static_cast<gpu::uint>(camera.height);
    p.noise_a = config.noise.a, p.noise_b = config.noise.b, p.noise_c = config.noise.c;
    p.lateral_noise = config.noise.lateral * static_cast<float>(camera.width) / kReferenceWidth;
    p.noise_floor = config.noise.floor;
    p.first_mover_label = gpu::NO_MOVERS;
    set_params(p, config.shutter, camera);
    set_params(p, config.preprocess, camera);
    set_params(p, config.tracking);
    set_params(p, config.map);
    return p;
}

}  // namespace posefusion
