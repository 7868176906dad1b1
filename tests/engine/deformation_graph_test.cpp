#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <gtest/gtest.h>

#include "engine/loops/normal_equations.hpp"

namespace posefusion {
namespace {
using Eigen::Vector3d;

std::vector<GraphSample> tube(double length, double radius, double step, double frames_per_metre) {
    std::vector<GraphSample> s;
    for (double z = 0; z < length; z += step)
        for (double a = 0; a < 2 * std::numbers::pi; a += step / radius)
            s.push_back({Eigen::Vector3d(radius * std::cos(a), radius * std::sin(a), z).cast<float>(), (std::uint32_t)(z * frames_per_metre), (std::uint32_t)(z * frames_per_metre)+30});
    return s;
}
TEST(Graph, Speed) {
    for (double length : {8.0, 16.0, 80.0}) {
        auto t0 = std::chrono::steady_clock::now();
        auto samples = tube(length, 1.5, 0.02, 30);
        auto t1 = std::chrono::steady_clock::now();
        auto g = DeformationGraph::sample(samples, {});
        auto t2 = std::chrono::steady_clock::now();
        std::vector<LoopConstraint> c;
        for (int i = 0; i < 100; ++i) {
            double a = i * 0.0628;
            Vector3d p(1.5 * std::cos(a), 1.5 * std::sin(a), length - 0.3);
            c.push_back({p, (std::uint32_t)(30 * p.z()), p + Vector3d(0.3, 0.1, 0), 0});
            Vector3d q(1.5 * std::cos(a), 1.5 * std::sin(a), 0.3);
            c.push_back({q, 9, q, 9});
        }
        auto r = g.solve(c, 0);
        auto t3 = std::chrono::steady_clock::now();
        auto ms = [](auto a, auto b) { return std::chrono::duration<double, std::milli>(b - a).count(); };
        printf("%zu samples %zu nodes %zu edges: sample %.1f ms solve %.1f ms, %d it, %d %s err %g -> %g edge %g E %g\n", samples.size(), g.nodes().size(), g.edges().size(), ms(t1, t2), ms(t2, t3), r.iterations, r.accepted, r.reason.c_str(), r.constraint_error_before_m, r.constraint_error_after_m, r.edge_error_m, r.energy_after);
    }
}
}
}
