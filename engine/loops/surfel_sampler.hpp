#pragma once
#include <vector>

#include "engine/loops/deformation_graph.hpp"
#include "engine/map/surfel_map.hpp"

namespace posefusion {

/// Fetches as many evenly spread surfels from the device as a deformation graph needs to place its nodes.
class SurfelSampler {
public:
    explicit SurfelSampler(vulkan::Context& context);

    /// Those of the map that are sure enough to be predicted, oldest first. Waits for the device.
    [[nodiscard]] std::vector<GraphSample> sample(const SurfelMap& map) const;

private:
    vulkan::Context& context_;
    vulkan::Kernel sample_surfels_;
    vulkan::Buffer samples_, host_samples_;
};

}  // namespace posefusion
