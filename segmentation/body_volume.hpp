#pragma once
#include <Eigen/Core>
#include <vector>

#include "engine/core/intrinsics.hpp"
#include "segmentation/skeleton.hpp"

/// The space a person takes: capsules with anatomical radii around the bones.
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
    /// Signed distance in the picture to the outline of the body, in metres at the body's depth, for pixels whose depth
    /// is not known. (u, v) in pixels of `camera`.
    [[nodiscard]] float outline_distance(float u, float v, const Intrinsics& camera) const;
    /// Signed distance to the space where feet and hair are, whose shape the joints do not say.
    [[nodiscard]] float ends_distance(const Eigen::Vector3f& point) const;
    /// Signed distance to the space the body may also take: hands, limbs and trunk that were not found.
    [[nodiscard]] float reach_distance(const Eigen::Vector3f& point) const;

    /// Same to the limbs between joints whose depth was read, which may stand in front of hidden ones.
    [[nodiscard]] float seen_distance(const Eigen::Vector3f& point) const;

    /// Sphere around everything, reach included.
    [[nodiscard]] const Eigen::Vector3f& center() const { return center_; }
    [[nodiscard]] float extent() const { return extent_; }

private:
    std::vector<Capsule> body_, seen_, ends_, reach_;
    Eigen::Vector3f center_;
    float extent_;
};

}  // namespace posefusion
