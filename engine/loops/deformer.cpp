#include "engine/loops/deformer.hpp"

#include <algorithm>

namespace posefusion {

using namespace vulkan;

namespace {

/// An array to be uploaded to the device.
struct Upload {
    Buffer host, device;

    template <class T>
    Upload(Context& context, const std::vector<T>& values)
        : host(host_buffer<T>(context, values.size(), "deformation graph on the host")),
          device(device_buffer<T>(context, values.size(), "deformation graph")) {
        std::copy(values.begin(), values.end(), host.host<T>().begin());
    }
};

}  // namespace

Deformer::Deformer(Context& context)
    : context_(context),
      deform_(context, "loops/deform", {{"INFLUENCE_MARGIN", static_cast<float>(kInfluenceMargin)}}) {}

double Deformer::run(const SurfelMap& map, const InfluenceTree& tree) const {
    return run(map.streams(), map.counters(), map.slots(), tree);
}

double Deformer::run(const SurfelStreams& streams, const Buffer& counters, std::uint32_t slots,
                     const InfluenceTree& tree) const {
    if (slots == 0 || tree.nodes().empty()) return 0;
    const Upload branches(context_, tree.branches()), leaves(context_, tree.leaves()),
        candidates(context_, tree.candidates()), nodes(context_, tree.nodes());
    Sequence sequence(context_);
    for (const Upload* upload : {&branches, &leaves, &candidates, &nodes})
        sequence.copy(upload->host, upload->device, upload->host.bytes());
    sequence.stage("deform");
    sequence.dispatch(deform_,
                      {{"counters", counters},
                       {"appearance", streams.appearance},
                       {"branches", branches.device},
                       {"leaves", leaves.device},
                       {"candidates", candidates.device},
                       {"nodes", nodes.device},
                       {"position_confidence", streams.position_confidence},
                       {"normal_radius", streams.normal_radius}},
                      {{"metres_per_frame", static_cast<float>(tree.metres_per_frame())},
                       {"temporal_window", static_cast<float>(tree.temporal_window())}},
                      deform_.groups_for(ceil_div(slots, gpu::SURFELS_PER_INVOCATION)));
    sequence.finish();
    sequence.run();
    const auto times = sequence.times();
    return times.empty() ? 0 : times.front().milliseconds;
}

}  // namespace posefusion
