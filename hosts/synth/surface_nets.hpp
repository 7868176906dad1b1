#pragma once
#include <functional>
#include <vector>

#include "hosts/synth/mesh.hpp"

namespace posefusion::synth {

struct Surface {
    std::vector<Vector3f> positions, normals;  ///< normals point to where the field grows
    std::vector<Triangle> triangles;
};

/// Signed distance, or close to it: negative inside, never changing faster than the distance moved.
using DistanceField = std::function<float(const Vector3f&)>;

/// The zero set of a field as triangles: naive surface nets (Gibson 1998), one vertex per cell that the surface
/// crosses, then moved onto the surface along the gradient.
/// @param low,high  box that holds the surface, metres
/// @param cell      edge of a cell, metres
[[nodiscard]] Surface surface_nets(const DistanceField& field, const Vector3f& low, const Vector3f& high, float cell);

}  // namespace posefusion::synth
