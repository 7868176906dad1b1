#pragma once
#include <functional>
#include <string>

#include "hosts/mesh/mesh.hpp"
#include "hosts/mesh/textured_mesh.hpp"
#include "hosts/texture/texture_views.hpp"

namespace posefusion {

struct TextureConfig {
    int size = 4096;  ///< most texels per side; what fits into less has less
};

struct TextureObserver {
    std::function<void(const std::string& what, std::size_t done, std::size_t total)> progress;
    std::function<void(const std::string&)> warning;
};

/// Gives the mesh a texture from images. Each place has the colours of the view that shows it best: nearest, most
/// frontal, and the same as its neighbours' unless that is much worse; where two views meet they are blended. A place
/// is seen in a view only if the mesh itself and the measured depth agree, and no people are there. The exposure of the
/// views is levelled. What none shows has the colours of the vertices. Views are loaded one at a time, and twice; a
/// view that cannot be read is left out with a warning.
/// Throws Error: no view can be used, or the texture is too small.
[[nodiscard]] TexturedMesh make_texture(const Mesh& mesh, const TextureViews& views, const TextureConfig& config,
                                        const TextureObserver& observer);

}  // namespace posefusion
