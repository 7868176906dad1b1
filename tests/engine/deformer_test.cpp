#include "engine/loops/deformer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>

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

template <class T>
std::vector<T> download(const vulkan::Buffer& from) {
    auto host = vulkan::host_buffer<T>(shared_context(), from.bytes() / sizeof(T), "test download");
    vulkan::Sequence sequence(shared_context());
    sequence.copy(from, host, from.bytes());
    sequence.finish();
    sequence.run();
    const auto values = host.template host<T>();
    return {values.begin(), values.end()};
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

/// Surfels on the device, as the deformer takes them.
struct DeviceSurfels {
    explicit DeviceSurfels(const Surfels& surfels)
        : streams(shared_context(), surfels.count()),
          counters(vulkan::device_buffer<MapRecord>(shared_context(), 1, "test counters")) {
        upload(surfels.positions, streams.position_confidence);
        upload(surfels.normals, streams.normal_radius);
        upload(surfels.appearances, streams.appearance);
        upload(std::vector{MapRecord{surfels.count(), 0, 0, 0}}, counters);
    }
    SurfelStreams streams;
    vulkan::Buffer counters;
};

/// A graph bent by a closed loop, all of its nodes with another rotation.
DeformationGraph bent_graph(const std::vector<GraphSample>& samples, const Corridor& corridor) {
    auto graph = DeformationGraph::sample(samples, {});
    auto constraints = corridor.ring(0.3, 20, Isometry3d::Identity());
    for (auto& c : corridor.ring(corridor.length - 0.3, 20, motion({0.2, -0.1, 0.05}, {1, 1, 0}, 3)))
        constraints.push_back(c);
    const auto result = graph.solve(constraints);
    EXPECT_TRUE(result.accepted) << result.reason;
    return graph;
}

/// Surfels all over a corridor and off it: near the wall, in mid-air, far away, of other times, dead.
Surfels make_surfels(const Corridor& corridor, uint count, unsigned seed) {
    Random random(seed);
    Surfels s;
    for (uint i = 0; i < count; ++i) {
        const bool is_stray = random.chance(0.1);
        const double z = is_stray ? random.uniform(-12, 22) : corridor.length * i / count;
        Vector3d p = corridor.wall(z, random.uniform(0, 0.1) + 0.01 * i) + 0.03 * random.direction();
        if (is_stray) p += random.uniform(0, 3) * random.direction();
        const uint created =
            random.chance(0.05) ? random.below(2000) : corridor.time_at(std::max(0.0, z)) + random.below(10);
        s.add(p, random.direction(), random.chance(0.1) ? 0.0 : random.uniform(0.1, 20), created);
    }
    return s;
}

class DeformerTest : public DeviceTest {
protected:
    static void expect_moved(const DeformationGraph& graph, const Surfels& before, const std::vector<vec4>& positions,
                             const std::vector<vec4>& normals) {
        std::vector<Eigen::Vector4d> expected_positions, expected_normals;
        for (uint i = 0; i < before.count(); ++i) {
            Vector3d p = xyz(before.positions[i]), n = xyz(before.normals[i]);
            if (before.positions[i].w > 0) {
                Eigen::Matrix3d R = Eigen::Matrix3d::Zero();
                for (const auto& share : graph.influences(p, before.appearances[i].created))
                    R += share.weight * graph.nodes()[share.node].R;
                n = (R * n).normalized();
                p = graph.deform(p, before.appearances[i].created);
            }
            expected_positions.push_back({p.x(), p.y(), p.z(), static_cast<double>(before.positions[i].w)});
            expected_normals.push_back({n.x(), n.y(), n.z(), static_cast<double>(before.normals[i].w)});
        }
        // coordinates and distances up to 30 m are floats: 2e-6 m, 1e-7 of a distance in the weights; times what
        // neighbouring nodes differ by far from all of them (metres), where weights react most
        expect_near(positions, expected_positions, 5e-5, 0, "position");
        expect_near(normals, expected_normals, 5e-5, 0, "normal");
    }
};

TEST_F(DeformerTest, MovesSurfelsAsTheGraphDoes) {
    const Corridor corridor;
    const auto graph = bent_graph(corridor.samples(), corridor);
    const InfluenceTree tree(graph);
    // below, at and above four surfels per invocation and 256 per workgroup
    for (const uint count : {1u, 3u, 4u, 5u, 255u, 256u, 257u, 6000u}) {
        const auto surfels = make_surfels(corridor, count, 80 + count);
        Launch launch("loops/deform", {{"INFLUENCE_MARGIN", static_cast<float>(kInfluenceMargin)}});
        launch.input("counters", MapRecord{count, 0, 0, 0}).input("appearance", surfels.appearances);
        launch.input("branches", tree.branches()).input("leaves", tree.leaves());
        launch.input("candidates", tree.candidates()).input("nodes", tree.nodes());
        launch.inout("position_confidence", surfels.positions).inout("normal_radius", surfels.normals);
        launch.run_over(vulkan::ceil_div(count, gpu::SURFELS_PER_INVOCATION),
                        {{"metres_per_frame", static_cast<float>(tree.metres_per_frame())},
                         {"temporal_window", static_cast<float>(tree.temporal_window())}});
        expect_moved(graph, surfels, launch.read<vec4>("position_confidence"), launch.read<vec4>("normal_radius"));
    }
}

TEST_F(DeformerTest, MovesTwoVisitsApart) {
    const Corridor first;
    Corridor second = first;
    second.start = 1000;
    auto samples = first.samples();
    second.append_to(samples);
    auto graph = DeformationGraph::sample(samples, {});
    std::vector<LoopConstraint> constraints;
    for (const double z : {1.0, 5.0, 9.0}) {
        for (auto c : second.ring(z, 12, motion({0.1, 0.05, 0}, {0, 0, 1}, 0))) constraints.push_back(c);
        for (auto c : first.ring(z, 12, Isometry3d::Identity())) constraints.push_back(c);
    }
    ASSERT_TRUE(graph.solve(constraints).accepted);
    const InfluenceTree tree(graph);
    Surfels surfels = make_surfels(first, 2000, 91);
    const Surfels others = make_surfels(second, 2000, 92);
    for (uint i = 0; i < others.count(); ++i)
        surfels.add(xyz(others.positions[i]), xyz(others.normals[i]), others.positions[i].w,
                    others.appearances[i].created);

    auto& context = shared_context();
    const DeviceSurfels on_device(surfels);
    const auto& [streams, counters] = on_device;
    const Deformer deformer(context);
    // a graph without nodes moves nothing
    (void)deformer.run(streams, counters, surfels.count(), InfluenceTree(DeformationGraph()));
    EXPECT_EQ(std::memcmp(download<vec4>(streams.position_confidence).data(), surfels.positions.data(),
                          surfels.positions.size() * sizeof(vec4)),
              0);
    (void)deformer.run(streams, counters, surfels.count(), tree);
    expect_moved(graph, surfels, download<vec4>(streams.position_confidence), download<vec4>(streams.normal_radius));
}

TEST_F(DeformerTest, MovesAMillionSurfelsInTime) {
    Corridor corridor;
    corridor.length = 12.5;
    corridor.step = 0.0097;
    const auto samples = corridor.samples();
    const auto graph = DeformationGraph::sample(samples, {});
    Surfels surfels;
    for (const auto& s : samples) surfels.add(s.position.cast<double>(), {1, 0, 0}, 10, s.created);
    EXPECT_GE(surfels.count(), 1000000u);
    EXPECT_GE(graph.nodes().size(), 480u);
    auto& context = shared_context();
    const DeviceSurfels on_device(surfels);
    const auto& [streams, counters] = on_device;
    const Deformer deformer(context);
    const std::clock_t begin = std::clock();
    const InfluenceTree tree(graph);
    const double build = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    double fastest = 1e9, processor = 1e9;
    for (int i = 0; i < 5; ++i) {
        const std::clock_t start = std::clock();
        fastest = std::min(fastest, deformer.run(streams, counters, surfels.count(), tree));
        processor = std::min(processor, 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
    std::printf("%u surfels, %zu nodes: %.1f ms, processor time of all threads %.1f ms; tree of %zu leaves %.1f ms\n",
                surfels.count(), graph.nodes().size(), fastest, processor, tree.leaves().size(), build);
    // the claim is 60 ms with two threads on two quiet cores; here there is one thread and neighbours
    EXPECT_LT(fastest, 1000);
}

}  // namespace
}  // namespace posefusion::test
