#include "tools/evaluate_mesh/seen_surface.hpp"

#include <cmath>

#include "engine/core/error.hpp"
#include "hosts/evaluate/evaluation.hpp"

namespace posefusion {

std::vector<Eigen::Vector3f> seen_points(const Recording& recording, const std::vector<Eigen::Vector3f>& points,
                                         const SeenSurfaceConfig& config) {
    const auto groundtruth = recording.groundtruth();
    if (!groundtruth) throw Error(recording.location() + ": has no groundtruth.txt");
    const std::vector<Stamp> stamps = stamps_of(*groundtruth);
    const Intrinsics& k = recording.intrinsics();
    std::vector<int> frames(points.size(), 0);
    for (std::size_t i = 0; i < recording.size(); i += static_cast<std::size_t>(config.every)) {
        const auto pose = nearest_stamp(stamps, recording.frames()[i].stamp);
        if (!pose) continue;
        const DepthImage depth = recording.load(i).depth;
        const Eigen::Isometry3f T_camera_world = (*groundtruth)[*pose].T_world_camera.inverse().cast<float>();
        for (std::size_t n = 0; n < points.size(); ++n) {
            const Eigen::Vector3f p = T_camera_world * points[n];
            if (p.z() <= 0 || p.z() > config.farthest) continue;
            const int u = static_cast<int>(std::lround(k.fx * p.x() / p.z() + k.cx));
            const int v = static_cast<int>(std::lround(k.fy * p.y() / p.z() + k.cy));
            if (!depth.contains(u, v)) continue;
            const float measured = depth(u, v), tolerance = config.constant + config.per_square * p.z() * p.z();
            if (measured > 0 && std::abs(measured - p.z()) <= tolerance) ++frames[n];
        }
    }
    std::vector<Eigen::Vector3f> seen;
    for (std::size_t n = 0; n < points.size(); ++n)
        if (frames[n] >= config.least_frames) seen.push_back(points[n]);
    return seen;
}

}  // namespace posefusion
