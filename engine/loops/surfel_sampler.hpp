#pragma once
#include <vector>

#include "engine/loops/deformation_graph.hpp"
#include "engine/map/surfel_map.hpp"

namespace posefusion {

/// Reads evenly spread surfels from the device, from which a deformation graph places its nodes.
class SurfelSampler {
public:
    explicit SurfelSampler(vulkan::Context& context);

    /// Samples of the surfels that take part in the prediction, oldest first. Waits for the device.
    [[nodiscard]] std::vector<GraphSample> sample(const SurfelMap& map) const;

private:
    vulkan::Context& context_;
    vulkan::Kernel sample_surfels_;
    vulkan::Buffer samples_, host_samples_;
};

}  // namespace posefusion
