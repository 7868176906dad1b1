#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "hosts/synth/body.hpp"
#include "hosts/synth/lighting.hpp"
#include "hosts/synth/mover.hpp"
#include "hosts/synth/room.hpp"
#include "hosts/synth/texture.hpp"
#include "hosts/synth/tracer.hpp"

/// What the camera sees: the room, which never changes, and the people and things that move in it.
namespace posefusion::synth {

/// Of everybody and everything, in the order of the bodies and of the movers.
struct CrowdPose {
    std::vector<BoneTransforms> people;
    std::vector<MoverPose> movers;
};

/// The people and the movers while a frame is taken, as one triangle soup that moves.
class Crowd {
public:
    /// @param poses  one pose, or several evenly spaced in time: between them everything moves evenly
    Crowd(const RayDevice& device, const std::vector<Body>& bodies, const std::vector<Mover>& movers,
          const std::vector<CrowdPose>& poses);

    [[nodiscard]] const RayScene& rays() const { return *rays_; }
    [[nodiscard]] bool empty() const { return triangles_.empty(); }
    [[nodiscard]] std::size_t shade_count() const { return shades_.front().size(); }
    /// Index of the person of a triangle, or, from the number of people on, of the mover.
    [[nodiscard]] int part_of(std::uint32_t triangle) const { return part_[triangle]; }
    [[nodiscard]] int people() const { return static_cast<int>(bodies_.size()); }
    /// In the masks: 0 = static.
    [[nodiscard]] int label_of(int part) const {
        return part < people() ? part + 1 : movers_[static_cast<std::size_t>(part - people())].label;
    }

private:
    void add(std::size_t part, const std::vector<Triangle>& triangles);

    friend class Scene;
    friend struct Moment;
    const std::vector<Body>& bodies_;
    const std::vector<Mover>& movers_;
    std::vector<std::vector<Vector3f>> positions_, normals_;  ///< per pose
    std::vector<Triangle> triangles_;                         ///< indices into the positions of a pose
    std::vector<std::uint8_t> part_;
    std::vector<std::uint32_t> first_triangle_;    ///< per part
    std::vector<std::vector<Shade>> shades_;       ///< per pose
    std::vector<std::vector<Vector2f>> pictures_;  ///< per pose, of the movers
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
    [[nodiscard]] Shade shade(std::size_t index) const;
    [[nodiscard]] Vector2f picture(std::size_t mover) const;

private:
    std::size_t before_ = 0;  ///< index of the pose before
    float share_ = 0;         ///< of the way to the next one
};

/// The nearest hit along a ray.
struct SceneHit {
    Hit hit;
    int part = -1;  ///< of the crowd; -1 = the room
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
    [[nodiscard]] Vector3f mover_radiance(const Moment& now, const SceneHit& hit, const Vector3f& point,
                                          const Vector3f& direction, float footprint, std::uint64_t sample) const;
    /// Light that arrives at something that moves. @param openness share of the ambient light that reaches it, 0..1
    [[nodiscard]] Vector3f light_at(const Moment& now, const Vector3f& point, const Vector3f& normal, float openness,
                                    std::uint64_t sample) const;
    Room room_;
    std::vector<Texture> textures_;
    RayDevice device_;
    RayScene rays_;
    std::vector<BakedLight> light_;
};

}  // namespace posefusion::synth
