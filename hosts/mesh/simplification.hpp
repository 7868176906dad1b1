#pragma once
#include <cstddef>

#include "hosts/mesh/mesh.hpp"

namespace posefusion {

/// The mesh with at most `triangles`, where its topology allows: edges are collapsed in the order of the error that the
/// quadrics of Garland & Heckbert (1997) give (meshoptimizer's implementation). The vertices that are left keep their
/// places and colours; borders keep their shape. A mesh that is small enough stays as it is.
[[nodiscard]] Mesh simplified(const Mesh& mesh, std::size_t triangles);

}  // namespace posefusion
