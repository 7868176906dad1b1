#pragma once
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/loops/deformation_graph.hpp"

/// A corridor that was walked along once or twice: what the tests of the deformation graph bend.
namespace posefusion::test {

struct Corridor {
    double length = 10;   ///< metres, along z from 0
    double radius = 1.2;  ///< metres, it is round
    double step = 0.05;   ///< metres between samples
    double frames_per_metre = 30;
    std::uint32_t start = 0;     ///< frame at z = 0
    std::uint32_t in_view = 30;  ///< frames that each place is seen

    [[nodiscard]] std::uint32_t time_at(double z) const {
        return start + static_cast<std::uint32_t>(std::lround(z * frames_per_metre));
    }
    [[nodiscard]] Eigen::Vector3d wall(double z, double angle) const {
        return {radius * std::cos(angle), radius * std::sin(angle), z};
    }

    void append_to(std::vector<GraphSample>& samples) const {
        const int rings = static_cast<int>(std::floor(length / step)) + 1;
        const int per_ring = static_cast<int>(std::ceil(2 * std::numbers::pi * radius / step));
        for (int r = 0; r < rings; ++r) {
            const double z = r * step;
            for (int k = 0; k < per_ring; ++k) {
                const double angle = 2 * std::numbers::pi * k / per_ring;
                samples.push_back({wall(z, angle).cast<float>(), time_at(z), time_at(z) + in_view});
            }
        }
    }
    [[nodiscard]] std::vector<GraphSample> samples() const {
        std::vector<GraphSample> result;
        append_to(result);
        return result;
    }
    /// The camera that has walked it, a frame at a time, and seen each place from there.
    /// @param information  of the step to z
    template <class Information>
    [[nodiscard]] std::vector<GraphCamera> cameras(const Information& information) const {
        std::vector<GraphCamera> result;
        for (std::uint32_t frame = time_at(0); frame <= time_at(length); ++frame) {
            GraphCamera camera;
            camera.frame = frame;
            camera.T_world_camera.translation().z() = (frame - start) / frames_per_metre;
            camera.information = information(camera.T_world_camera.translation().z());
            result.push_back(camera);
        }
        return result;
    }
    /// Constraints all around the corridor at z: the wall there belongs where `T` takes it.
    template <class Transform>
    [[nodiscard]] std::vector<LoopConstraint> ring(double z, int count, const Transform& T) const {
        std::vector<LoopConstraint> result;
        for (int k = 0; k < count; ++k) {
            LoopConstraint c;
            c.source = wall(z, 2 * std::numbers::pi * k / count);
            c.target = T * c.source;
            c.source_time = c.target_time = time_at(z);
            result.push_back(c);
        }
        return result;
    }
};

}  // namespace posefusion::test
