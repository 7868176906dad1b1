#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "engine/map/model_view.hpp"
#include "engine/map/surfel.hpp"
#include "engine/map/surfel_map.hpp"

/// Reads the map for the host. All functions wait for the device.
namespace posefusion {

/// Live surfels, in the order of their slots. @param min_confidence  surfels below it are left out
[[nodiscard]] std::vector<Surfel> read_surfels(vulkan::Context& context, const SurfelMap& map, float min_confidence);
/// The same of the first `slots` surfels of `streams`, copied `slice` by `slice`: whoever shares the queue of the
/// device waits for one of them at most.
[[nodiscard]] std::vector<Surfel> read_surfels(vulkan::Context& context, const SurfelStreams& streams,
                                               std::uint32_t slots, float min_confidence, std::uint32_t slice);

/// The stable map as a camera would see it. @param params  camera and map parameters  @param images  of any frame
[[nodiscard]] ModelView render_view(vulkan::Context& context, const SurfelMap& map, const Intrinsics& camera,
                                    gpu::Params params, const Eigen::Isometry3d& T_world_camera,
                                    const Preprocessing& images);

}  // namespace posefusion
