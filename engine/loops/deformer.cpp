#include "engine/loops/deformer.hpp"

#include <algorithm>

namespace posefusion {

using namespace vulkan;

namespace {

constexpr std::uint32_t kSurfelsPerGroup = 4 * 64;  // shaders/loops/deform.comp

struct DeformPush {
    float metres_per_frame, temporal_window;
};

template <class T>
Buffer filled(Context& context, const std::vector<T>& values, const std::string& name) {
    Buffer buffer = host_buffer<T>(context, values.size(), name);
    std::copy(values.begin(), values.end(), buffer.host<T>().begin());
    return buffer;
}

}  // namespace

Deformer::Deformer(Context& context) : context_(context), deform_(context, "loops/deform", 8, sizeof(DeformPush)) {}

double Deformer::run(const SurfelMap& map, const InfluenceTree& tree) const {
    return run(map.streams(), map.counters(), map.slots(), tree);
}

double Deformer::run(const SurfelStreams& streams, const Buffer& counters, std::uint32_t slots,
                     const InfluenceTree& tree) const {
    if (slots == 0 || tree.nodes().empty()) return 0;
    const Buffer uploads[] = {filled(context_, tree.branches(), "deformation branches"),
                              filled(context_, tree.leaves(), "deformation leaves"),
                              filled(context_, tree.candidates(), "deformation candidates"),
                              filled(context_, tree.nodes(), "deformation nodes")};
    std::vector<Buffer> device;
    Sequence sequence(context_);
    for (const auto& upload : uploads) {
        device.emplace_back(context_, upload.bytes(), MemoryKind::Device, "deformation graph");
        sequence.copy(upload, device.back(), upload.bytes());
    }
    sequence.stage("deform");
    sequence.dispatch(
        deform_,
        {in(counters), in(streams.appearance), in(device[0]), in(device[1]), in(device[2]), in(device[3]),
         inout(streams.position_confidence), inout(streams.normal_radius)},
        DeformPush{static_cast<float>(tree.metres_per_frame()), static_cast<float>(tree.temporal_window())},
        Groups::covering(slots, kSurfelsPerGroup));
    sequence.finish();
    sequence.run();
    const auto times = sequence.times();
    return times.empty() ? 0 : times.front().milliseconds;
}

}  // namespace posefusion
