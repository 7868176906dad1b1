#include "engine/loops/surfel_sampler.hpp"

#include <algorithm>

#include "engine/vulkan/shared_types.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

constexpr std::uint32_t kNodeSamples = 1u << 16;  // offered to the deformation graph as nodes

}  // namespace

SurfelSampler::SurfelSampler(Context& context)
    : context_(context),
      sample_surfels_(context, "loops/sample_surfels"),
      samples_(device_buffer<gpu::SurfelSample>(context, kNodeSamples, "surfel samples")),
      host_samples_(host_buffer<gpu::SurfelSample>(context, kNodeSamples, "host surfel samples")) {}

std::vector<GraphSample> SurfelSampler::sample(const SurfelMap& map) const {
    const std::uint32_t stride = std::max(1u, (map.slots() + kNodeSamples - 1) / kNodeSamples);
    const std::uint32_t count = map.slots() / stride;
    if (count == 0) return {};
    Sequence sequence(context_);
    sequence.dispatch(sample_surfels_,
                      {{"position_confidence", map.streams().position_confidence},
                       {"appearance", map.streams().appearance},
                       {"samples", samples_}},
                      {{"stride", stride}, {"count", count}}, sample_surfels_.groups_for(count));
    sequence.copy(samples_, host_samples_, count * sizeof(gpu::SurfelSample));
    sequence.finish();
    sequence.run();
    std::vector<GraphSample> samples;
    samples.reserve(count);
    for (const auto& s : host_samples_.host<gpu::SurfelSample>().first(count)) {
        if (s.position.w >= map.config().predict_confidence)
            samples.push_back({{s.position.x, s.position.y, s.position.z}, s.created, s.last_seen});
    }
    return samples;
}

}  // namespace posefusion
