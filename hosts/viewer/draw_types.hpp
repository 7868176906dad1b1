#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <glm/gtc/type_ptr.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

/// Types that the viewer shares with its shaders, byte by byte. Poses are Eigen types, drawing uses GLM types.
namespace posefusion::gpu {

using glm::mat4;
using glm::uint;
using glm::vec2;
using glm::vec3;
using glm::vec4;

#include "shaders/include/viewer_types.h"

static_assert(sizeof(View) == 128 && offsetof(View, focal) == 64 && offsetof(View, near) == 88);
static_assert(sizeof(Segment) == 32 && offsetof(Segment, to) == 16);
static_assert(sizeof(TileView) == 48 && offsetof(TileView, window) == 16 && offsetof(TileView, content) == 32);

}  // namespace posefusion::gpu

namespace posefusion {

[[nodiscard]] inline glm::vec3 to_glm(const Eigen::Vector3f& v) { return glm::make_vec3(v.data()); }
[[nodiscard]] inline glm::mat4 to_glm(const Eigen::Isometry3f& T) { return glm::make_mat4(T.matrix().data()); }

}  // namespace posefusion
