#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "hosts/synth/mesh.hpp"

/// Ray casting into triangle soups (Intel Embree behind it).
namespace posefusion::synth {

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
    RayScene(const RayDevice& device, const std::vector<Vector3f>& vertices, const std::vector<Triangle>& triangles,
             Quality quality);
    ~RayScene();
    RayScene(RayScene&&) noexcept;
    RayScene& operator=(RayScene&&) noexcept;

    /// Nearest triangle with t in (t_min, hit.t); true and `hit` filled if there is one. Safe from many threads.
    [[nodiscard]] bool intersect(const Vector3f& origin, const Vector3f& direction, float t_min, Hit& hit) const;
    [[nodiscard]] bool occluded(const Vector3f& origin, const Vector3f& direction, float t_min, float t_max) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace posefusion::synth
