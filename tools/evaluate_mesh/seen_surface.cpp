#include "tools/evaluate_mesh/seen_surface.hpp"

#include <cmath>

#include "engine/core/error.hpp"
#include "hosts/evaluate/evaluation.hpp"
#include "hosts/synth/tracer.hpp"

namespace posefusion {

namespace {

synth::RayScene rays_of(const synth::RayDevice& device, const TrueMesh& truth) {
    const std::vector<std::vector<Eigen::Vector3f>> vertices{truth.vertices};
    return {device, vertices, truth.faces, synth::RayScene::Quality::Best};
}

}  // namespace

std::vector<Eigen::Vector3f> seen_points(const Recording& recording, const TrueMesh& truth,
                                         const std::vector<Eigen::Vector3f>& points, const SeenSurfaceConfig& config) {
    const auto groundtruth = recording.groundtruth();
    if (!groundtruth) throw Error(recording.location() + ": has no groundtruth.txt");
    const std::vector<Stamp> stamps = stamps_of(*groundtruth);
    const Intrinsics& k = recording.intrinsics();
    const synth::RayDevice device;
    const synth::RayScene rays = rays_of(device, truth);
    std::vector<int> frames(points.size(), 0);
    for (std::size_t i = 0; i < recording.size(); i += static_cast<std::size_t>(config.every)) {
        const auto pose = nearest_stamp(stamps, recording.frames()[i].stamp);
        if (!pose) continue;
        const DepthImage depth = recording.load(i).depth;
        const Eigen::Isometry3f T_camera_world = (*groundtruth)[*pose].T_world_camera.inverse().cast<float>();
        const Eigen::Vector3f eye = (*groundtruth)[*pose].T_world_camera.translation().cast<float>();
        for (std::size_t n = 0; n < points.size(); ++n) {
            if (frames[n] >= config.least_frames) continue;
            const Eigen::Vector3f p = T_camera_world * points[n];
            if (p.z() <= 0 || p.z() > config.farthest) continue;
            const int u = static_cast<int>(std::lround(k.fx * p.x() / p.z() + k.cx));
            const int v = static_cast<int>(std::lround(k.fy * p.y() / p.z() + k.cy));
            if (!depth.contains(u, v)) continue;
            const float measured = depth(u, v), tolerance = config.constant + config.per_square * p.z() * p.z();
            if (!(measured > 0) || std::abs(measured - p.z()) > tolerance) continue;
            const Eigen::Vector3f way = points[n] - eye;
            if (!rays.occluded(eye, way, 0, 1 - config.rim / way.norm())) ++frames[n];
        }
    }
    std::vector<Eigen::Vector3f> seen;
    for (std::size_t n = 0; n < points.size(); ++n)
        if (frames[n] >= config.least_frames) seen.push_back(points[n]);
    return seen;
}

}  // namespace posefusion
