#include <bit>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <chrono>
#include <numeric>

#include "engine/loops/deformer.hpp"
#include "tests/engine/support/corridor.hpp"
#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"

// The map moved by the deformation kernel, against DeformationGraph::deform.
namespace posefusion::test {
namespace {

using gpu::MapRecord;
using gpu::vec4;
using std::size_t;
using uint = std::uint32_t;

struct Appearance {
    uint red_green, blue_weight, created, last_seen;
};

struct Surfels {
    std::vector<vec4> positions, normals;
    std::vector<Appearance> appearances;

    void add(const Vector3d& p, const Vector3d& n, double confidence, uint created) {
        positions.push_back(vec4_of(p, confidence));
        normals.push_back(vec4_of(n, 0.01));
        appearances.push_back({1, 2, created, created + 3});
    }
    [[nodiscard]] uint count() const { return static_cast<uint>(positions.size()); }
};

/// A graph bent by a closed loop, all of its nodes with another rotation.
DeformationGraph bent_graph(const std::vector<GraphSample>& samples, const Corridor& corridor) {
    auto graph = DeformationGraph::sample(samples, {});
    auto constraints = corridor.ring(0.3, 20, Isometry3d::Identity());
    for (auto& c : corridor.ring(corridor.length - 0.3, 20, motion({0.2, -0.1, 0.05}, {1, 1, 0}, 3))) constraints.push_back(c);
    const auto result = graph.solve(constraints);
    EXPECT_TRUE(result.accepted) << result.reason;
    return graph;
}

template <class T>
void upload(const std::vector<T>& values, const vulkan::Buffer& to) {
    auto host = vulkan::host_buffer<T>(shared_context(), values.size(), "test upload");
    std::copy(values.begin(), values.end(), host.template host<T>().begin());
    vulkan::Sequence sequence(shared_context());
    sequence.copy(host, to, values.size() * sizeof(T));
    sequence.finish();
    sequence.run();
}

using DeformerTest = DeviceTest;

TEST_F(DeformerTest, MovesAMillionSurfelsInTime) {
    Corridor corridor;
    corridor.length = 9;
    corridor.step = 0.0082;
    auto samples = corridor.samples();
    samples.resize(std::min<size_t>(samples.size(), 1000000));
    const auto graph = DeformationGraph::sample(samples, {});
    Surfels surfels;
    for (const auto& s : samples) surfels.add(s.position.cast<double>(), {1, 0, 0}, 10, s.created);
    auto& context = shared_context();
    const SurfelStreams streams(context, surfels.count());
    upload(surfels.positions, streams.position_confidence);
    upload(surfels.normals, streams.normal_radius);
    upload(surfels.appearances, streams.appearance);
    const auto counters = vulkan::device_buffer<MapRecord>(context, 1, "test counters");
    upload(std::vector{MapRecord{surfels.count(), 0, 0, 0}}, counters);
    const Deformer deformer(context);
    auto t0=std::clock();
    const InfluenceTree tree(graph);
    auto t1=std::clock();
    printf("tree %.1f ms, %zu leaves, %zu lists, max\n", 1e-3*(double)(t1-t0), tree.leaves().size(), tree.candidates().size());
    double mean=0; for (auto& s: samples) mean += static_cast<double>(tree.candidates(s.position.cast<double>(), s.created).size());
    printf("mean candidates %.1f\n", mean/1e6);
    for (int i = 0; i < 12; ++i) {
        const auto c0 = std::clock();
        const double ms = deformer.run(streams, counters, surfels.count(), tree);
        std::printf("%zu nodes, %u surfels: wall %.1f ms cpu %.1f ms\n", graph.nodes().size(), surfels.count(), ms, 1e3 * static_cast<double>(std::clock() - c0) / CLOCKS_PER_SEC);
    }
}

}  // namespace
}  // namespace posefusion::test
