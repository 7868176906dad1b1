#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "hosts/synth/body.hpp"
#include "hosts/synth/lighting.hpp"
#include "hosts/synth/room.hpp"
#include "hosts/synth/texture.hpp"
#include "hosts/synth/tracer.hpp"

/// What the camera sees: the room, which never changes, and the people of one instant.
namespace posefusion::synth {

/// The people at one instant, as one triangle soup.
class Crowd {
public:
    Crowd(const RayDevice& device, const std::vector<Body>& bodies, const std::vector<BoneTransforms>& poses);

    /// A sphere that approximates a part of a body, for the ambient shadow that people cast.
    struct Shade {
        Vector3f center;
        float radius;
    };

    [[nodiscard]] const RayScene& rays() const { return *rays_; }
    [[nodiscard]] bool empty() const { return triangles_.empty(); }
    [[nodiscard]] int person_of(std::uint32_t triangle) const { return person_[triangle]; }  ///< from 0

private:
    friend class Scene;
    const std::vector<Body>& bodies_;
    std::vector<Vector3f> positions_, normals_;
    std::vector<Triangle> triangles_;  ///< indices into positions_
    std::vector<std::uint8_t> person_;
    std::vector<std::uint32_t> first_triangle_, first_vertex_;  ///< per person
    std::vector<Shade> shades_;
    std::unique_ptr<RayScene> rays_;
};

/// The nearest hit along a ray.
struct SceneHit {
    Hit hit;
    int person = -1;  ///< index, -1 = the room
    bool any = false;
};

class Scene {
public:
    Scene(std::uint64_t seed, RoomKind kind, bool fresh_paint, int threads);

    [[nodiscard]] const Room& room() const { return room_; }
    [[nodiscard]] const RayDevice& device() const { return device_; }

    [[nodiscard]] SceneHit trace(const Crowd& crowd, const Vector3f& origin, const Vector3f& direction) const;
    [[nodiscard]] bool occluded(const Crowd& crowd, const Vector3f& origin, const Vector3f& direction, float t_min,
                                float t_max) const;
    /// Unit normal of the triangle itself, towards where the ray came from.
    [[nodiscard]] Vector3f face_normal(const Crowd& crowd, const SceneHit& hit, const Vector3f& direction) const;
    /// Light that leaves the hit point towards the camera, linear RGB, 1 = white.
    /// @param footprint  metres that a sample covers at unit distance along the ray  @param sample random bits for soft
    /// shadows
    [[nodiscard]] Vector3f radiance(const Crowd& crowd, const SceneHit& hit, const Vector3f& origin,
                                    const Vector3f& direction, float footprint, std::uint64_t sample) const;

private:
    [[nodiscard]] Vector3f room_radiance(const Crowd& crowd, const Hit& hit, const Vector3f& point,
                                         const Vector3f& direction, float footprint, std::uint64_t sample) const;
    [[nodiscard]] Vector3f body_radiance(const Crowd& crowd, const SceneHit& hit, const Vector3f& point,
                                         std::uint64_t sample) const;
    Room room_;
    std::vector<Texture> textures_;
    RayDevice device_;
    RayScene rays_;
    std::vector<BakedLight> light_;
};

}  // namespace posefusion::synth
