#pragma once
#include <Eigen/Core>
#include <vector>

#include "engine/core/intrinsics.hpp"
#include "segmentation/skeleton.hpp"

/// The volume of a person: capsules with anatomical radii around the bones.
namespace posefusion {

struct Capsule {
    Eigen::Vector3f a, b;  ///< ends of the axis, metres, camera coordinates
    float radius;          ///< metres
};

class BodyVolume {
public:
    explicit BodyVolume(const Skeleton& skeleton);

    /// Signed distance to the surface of the body, metres, negative inside.
    [[nodiscard]] float distance(const Eigen::Vector3f& point) const;
    /// Signed distance in the image plane to the outline of the body, in metres at the body's depth, for pixels without
    /// depth. (u, v) in pixels of `camera`.
    [[nodiscard]] float outline_distance(float u, float v, const Intrinsics& camera) const;
    /// Signed distance to the volume of feet and hair, whose shape the joints do not determine.
    [[nodiscard]] float ends_distance(const Eigen::Vector3f& point) const;
    /// Signed distance to the volume that undetected parts of the body may occupy: hands, limbs and trunk.
    [[nodiscard]] float reach_distance(const Eigen::Vector3f& point) const;

    /// The same to limbs between joints with measured depth, which may be in front of hidden ones.
    [[nodiscard]] float seen_distance(const Eigen::Vector3f& point) const;

    /// Bounding sphere, the volume of undetected parts included.
    [[nodiscard]] const Eigen::Vector3f& center() const { return center_; }
    [[nodiscard]] float extent() const { return extent_; }

private:
    std::vector<Capsule> body_, seen_, ends_, reach_;
    Eigen::Vector3f center_;
    float extent_;
};

}  // namespace posefusion
