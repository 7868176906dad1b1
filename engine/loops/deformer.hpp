#pragma once
#include "engine/loops/influence_tree.hpp"
#include "engine/map/surfel_map.hpp"

namespace posefusion {

/// Applies a deformation graph to the surfels on the device.
class Deformer {
public:
    explicit Deformer(vulkan::Context& context);

    /// Deforms all live surfels of the map and waits for the device. A graph without nodes changes nothing. Must not be
    /// called while a frame runs on the map. Returns the device time, milliseconds (0 without a clock).
    double run(const SurfelMap& map, const InfluenceTree& tree) const;
    /// The same for any surfel streams. @param counters  gpu::MapRecord  @param slots  at least its count
    double run(const SurfelStreams& streams, const vulkan::Buffer& counters, std::uint32_t slots,
               const InfluenceTree& tree) const;

private:
    vulkan::Context& context_;
    vulkan::Kernel deform_;
};

}  // namespace posefusion
