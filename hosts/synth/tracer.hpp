#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hosts/synth/mesh.hpp"

/// Ray casting into triangle soups (Intel Embree behind it).
namespace posefusion::synth {

/// Rays leave a surface this far from it, metres.
inline constexpr float kSurfaceStart = 0.005f;

struct Hit {
    float t = 0;  ///< ray parameter
    std::uint32_t triangle = 0;
    float u = 0, v = 0;  ///< barycentric: point = (1-u-v) a + u b + v c
};

class RayDevice {
public:
    RayDevice();
    ~RayDevice();
    RayDevice(RayDevice&&) noexcept;
    RayDevice& operator=(RayDevice&&) noexcept;

private:
    friend class RayScene;
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

class RayScene {
public:
    enum class Quality { Fast, Best };  ///< Fast: rebuilt every frame; Best: built once
    /// Copies the triangles. Built by one thread, so that ties between triangles are always resolved the same way.
    /// @param vertices  at one or more times, evenly spaced; between them triangles move evenly
    RayScene(const RayDevice& device, std::span<const std::vector<Vector3f>> vertices,
             const std::vector<Triangle>& triangles, Quality quality);
    ~RayScene();
    RayScene(RayScene&&) noexcept;
    RayScene& operator=(RayScene&&) noexcept;

    /// Nearest triangle with t in (t_min, hit.t); true and `hit` filled if there is one. Safe from many threads.
    /// @param time  0 at the first vertices, 1 at the last
    [[nodiscard]] bool intersect(const Vector3f& origin, const Vector3f& direction, float t_min, Hit& hit,
                                 float time = 0) const;
    [[nodiscard]] bool occluded(const Vector3f& origin, const Vector3f& direction, float t_min, float t_max,
                                float time = 0) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace posefusion::synth
