#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "hosts/synth/body.hpp"
#include "hosts/synth/lighting.hpp"
#include "hosts/synth/room.hpp"
#include "hosts/synth/texture.hpp"
#include "hosts/synth/tracer.hpp"

/// What the camera sees: the room, which never changes, and the people in it.
namespace posefusion::synth {

/// Of everybody, in the order of the bodies.
using CrowdPose = std::vector<BoneTransforms>;

/// The people while a frame is taken, as one triangle soup that moves.
class Crowd {
public:
    /// @param poses  one pose, or several evenly spaced in time: between them everything moves evenly
    Crowd(const RayDevice& device, const std::vector<Body>& bodies, const std::vector<CrowdPose>& poses);

    /// A sphere that approximates a part of a body, for the ambient shadow that people cast.
    struct Shade {
        Vector3f center;
        float radius;
    };

    [[nodiscard]] const RayScene& rays() const { return *rays_; }
    [[nodiscard]] bool empty() const { return triangles_.empty(); }
    [[nodiscard]] std::size_t shade_count() const { return shades_.front().size(); }
    [[nodiscard]] int person_of(std::uint32_t triangle) const { return person_[triangle]; }  ///< from 0

private:
    friend class Scene;
    friend struct Moment;
    const std::vector<Body>& bodies_;
    std::vector<std::vector<Vector3f>> positions_, normals_;  ///< per pose
    std::vector<Triangle> triangles_;                         ///< indices into the positions of a pose
    std::vector<std::uint8_t> person_;
    std::vector<std::uint32_t> first_triangle_, first_vertex_;  ///< per person
    std::vector<std::vector<Shade>> shades_;                    ///< per pose
    std::unique_ptr<RayScene> rays_;
};

/// A crowd at one moment.
struct Moment {
    const Crowd& crowd;
    float time;  ///< 0 at the first of its poses, 1 at the last
    /// Where a crowd has one pose, that is the only moment.
    Moment(const Crowd& people, float at = 0);

    [[nodiscard]] Vector3f position(std::uint32_t vertex) const;
    [[nodiscard]] Vector3f normal(std::uint32_t vertex) const;
    [[nodiscard]] Crowd::Shade shade(std::size_t index) const;

private:
    std::size_t before_ = 0;  ///< index of the pose before
    float share_ = 0;         ///< of the way to the next one
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

    [[nodiscard]] SceneHit trace(const Moment& now, const Vector3f& origin, const Vector3f& direction) const;
    [[nodiscard]] bool occluded(const Moment& now, const Vector3f& origin, const Vector3f& direction, float t_min,
                                float t_max) const;
    /// Unit normal of the triangle itself, towards where the ray came from.
    [[nodiscard]] Vector3f face_normal(const Moment& now, const SceneHit& hit, const Vector3f& direction) const;
    /// Light that leaves the hit point towards the camera, linear RGB, 1 = white.
    /// @param footprint  metres that a sample covers at unit distance along the ray  @param sample random bits for soft
    /// shadows
    [[nodiscard]] Vector3f radiance(const Moment& now, const SceneHit& hit, const Vector3f& origin,
                                    const Vector3f& direction, float footprint, std::uint64_t sample) const;

private:
    [[nodiscard]] Vector3f room_radiance(const Moment& now, const Hit& hit, const Vector3f& point,
                                         const Vector3f& direction, float footprint, std::uint64_t sample) const;
    [[nodiscard]] Vector3f body_radiance(const Moment& now, const SceneHit& hit, const Vector3f& point,
                                         std::uint64_t sample) const;
    Room room_;
    std::vector<Texture> textures_;
    RayDevice device_;
    RayScene rays_;
    std::vector<BakedLight> light_;
};

}  // namespace posefusion::synth
