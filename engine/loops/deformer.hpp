#pragma once
#include "engine/loops/influence_tree.hpp"
#include "engine/map/surfel_map.hpp"

namespace posefusion {

/// Applies a deformation graph to the surfels on the device.
class Deformer {
public:
    explicit Deformer(vulkan::Context& context);

    /// Moves all live surfels of the map; waits until it is done. A graph without nodes moves nothing. Not for use
    /// while a frame runs on the map. Returns the time the device took, milliseconds (0 where it cannot tell).
    double run(const SurfelMap& map, const InfluenceTree& tree) const;
    /// The same on any streams. @param counters  gpu::MapRecord  @param slots  at least its count
    double run(const SurfelStreams& streams, const vulkan::Buffer& counters, std::uint32_t slots,
               const InfluenceTree& tree) const;

private:
    vulkan::Context& context_;
    vulkan::Kernel deform_;
};

}  // namespace posefusion
