#include "engine/slam/params.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace posefusion {
namespace {

constexpr float kReferenceWidth = 640;  // pixel sizes in the configuration are meant for this width

float cosine_of_degrees(float degrees) { return std::cos(degrees * std::numbers::pi_v<float> / 180.0f); }

}  // namespace

gpu::Params make_params(const Intrinsics& camera, const SlamConfig& config) {
    const auto& pre = config.preprocess;
    const auto& track = config.tracking;
    const auto& map = config.map;
    gpu::Params p{};
    p.fx = camera.fx, p.fy = camera.fy, p.cx = camera.cx, p.cy = camera.cy;
    p.width = static_cast<gpu::uint>(camera.width), p.height = static_cast<gpu::uint>(camera.height);
    const float dilation =
        std::ceil(static_cast<float>(pre.mask_dilation) * static_cast<float>(camera.width) / kReferenceWidth);
    p.dilation = static_cast<gpu::uint>(std::clamp(dilation, 0.0f, 31.0f));
    p.depth_min = pre.depth_min, p.depth_max = pre.depth_max;
    p.noise_a = config.noise.a, p.noise_b = config.noise.b, p.noise_c = config.noise.c;
    p.lateral_noise = config.noise.lateral * static_cast<float>(camera.width) / kReferenceWidth;
    p.noise_floor = config.noise.floor;
    p.bilateral_space = 0.5f / (pre.bilateral_space * pre.bilateral_space);
    p.bilateral_range = 0.5f / (pre.bilateral_range * pre.bilateral_range);
    p.icp_enabled = track.icp ? 1.0f : 0.0f;
    p.icp_max_distance = track.icp_max_distance;
    p.icp_min_cosine = cosine_of_degrees(TrackingConfig::kIcpMaxAngleDeg);
    p.icp_robust = track.icp_robust;
    p.photometric_weight = track.photometric ? track.photometric_weight : 0.0f;
    p.photometric_robust = track.photometric_robust;
    p.min_gradient = track.min_gradient;
    p.converged_rotation = track.converged_rotation;
    p.converged_translation = track.converged_translation;
    p.min_inlier_ratio = track.min_inlier_ratio;
    p.max_icp_rmse = track.max_icp_rmse;
    p.max_translation_sigma = track.max_translation_sigma;
    p.max_rotation_sigma = track.max_rotation_sigma;
    p.max_step_translation = track.max_translation;
    p.max_step_rotation = track.max_rotation_deg * std::numbers::pi_v<float> / 180.0f;
    p.speed_scale = map.speed_scale;
    p.association_depth = map.association_depth;
    p.association_sigmas = map.association_sigmas;
    p.association_cosine = cosine_of_degrees(MapConfig::kAssociationAngleDeg);
    p.stable_confidence = map.stable_confidence;
    p.predict_confidence = map.predict_confidence;
    p.max_weight = map.max_weight;
    p.unstable_timeout = static_cast<gpu::uint>(map.unstable_timeout);
    p.duplicate_spacing = map.duplicate_spacing;
    p.duplicate_age = static_cast<gpu::uint>(map.duplicate_age);
    p.duplicate_depth = map.duplicate_depth;
    p.duplicate_sigmas = map.duplicate_sigmas;
    p.free_space_margin = map.free_space_margin;
    p.free_space_sigmas = map.free_space_sigmas;
    p.free_space_decay = map.free_space_decay;
    return p;
}

}  // namespace posefusion
