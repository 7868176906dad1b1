#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <random>

#include "engine/core/error.hpp"
#include "engine/loops/camera_ties.hpp"
#include "engine/loops/influence_tree.hpp"
#include "engine/loops/normal_equations.hpp"
#include "tests/engine/support/corridor.hpp"

// The deformation graph on the CPU: where its nodes are, what it does to a map, its derivatives, what it refuses.
namespace posefusion::test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using std::size_t;
using Step = Eigen::Matrix<double, 6, 1>;

Isometry3d motion(const Vector3d& translation, const Vector3d& axis, double degrees) {
    return Eigen::Translation3d(translation) * Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized());
}

double uniform(std::mt19937& random, double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

/// All constraints pinned.
std::vector<LoopConstraint> pinned(std::vector<LoopConstraint> constraints) {
    for (auto& c : constraints) c.pin = true;
    return constraints;
}
void append(std::vector<LoopConstraint>& to, const std::vector<LoopConstraint>& more) {
    to.insert(to.end(), more.begin(), more.end());
}

/// The corridor held at its beginning and led elsewhere at its end, turned about the middle of the end.
std::vector<LoopConstraint> hold_and_lead(const Corridor& corridor, const Isometry3d& T_end, int count = 20) {
    const Vector3d end(0, 0, corridor.length);
    Isometry3d T = T_end;
    T.translation() += end - T_end.linear() * end;
    auto constraints = corridor.ring(0.3, count, Isometry3d::Identity());
    append(constraints, corridor.ring(corridor.length - 0.3, count, T));
    return constraints;
}

double distance_in_space_and_time(const DeformationGraph& graph, const Vector3d& p, std::uint32_t time,
                                  const GraphNode& node) {
    const double before = static_cast<double>(node.time) - time, after = static_cast<double>(time) - node.last_seen;
    const double frames = std::max({0.0, before, after}) - graph.config().temporal_window;
    return std::hypot((p - node.position).norm(), graph.metres_per_frame() * std::max(0.0, frames));
}

/// Nodes of the corridor that were created by its walk.
size_t nodes_since(const DeformationGraph& graph, std::uint32_t time) {
    return static_cast<size_t>(
        std::count_if(graph.nodes().begin(), graph.nodes().end(), [&](const auto& n) { return n.time >= time; }));
}

// ------------------------------------------------------------------------------------------------------------- nodes

TEST(DeformationGraphNodes, CoverSpaceAndTimeEvenly) {
    Corridor first, second;
    first.length = second.length = 5;
    second.start = 1000;
    auto samples = first.samples();
    second.append_to(samples);
    const auto graph = DeformationGraph::sample(samples, {});
    const double spacing = static_cast<double>(graph.config().node_spacing);
    for (const auto& s : samples) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const auto& node : graph.nodes()) {
            nearest = std::min(nearest, distance_in_space_and_time(graph, s.position.cast<double>(), s.created, node));
        }
        // one spacing, and the diagonal of the cube of which only one sample was looked at
        ASSERT_LE(nearest, spacing + std::sqrt(3) * graph.place_size());
    }
    const auto nodes = graph.nodes();
    for (size_t i = 0; i < nodes.size(); ++i) {
        for (size_t j = i + 1; j < nodes.size(); ++j) {
            ASSERT_LE(nodes[i].time, nodes[j].time);
            ASSERT_GE(distance_in_space_and_time(graph, nodes[j].position, nodes[j].time, nodes[i]), spacing - 1e-9);
        }
    }
    // as many for the second visit as for the first
    const double share = static_cast<double>(nodes_since(graph, 1000)) / static_cast<double>(nodes.size());
    EXPECT_NEAR(share, 0.5, 0.02);
}

TEST(DeformationGraphNodes, APlaceThatStaysInViewGetsNoNewOnes) {
    Corridor first, later;
    first.length = later.length = 3;
    first.in_view = 1200;
    later.start = 1000;
    auto samples = first.samples();
    const size_t alone = DeformationGraph::sample(samples, {}).nodes().size();
    later.append_to(samples);
    EXPECT_EQ(DeformationGraph::sample(samples, {}).nodes().size(), alone);
}

TEST(DeformationGraphNodes, HaveNoUpperLimitAndDependOnNothingElse) {
    Corridor corridor;
    corridor.length = 40;
    const auto samples = corridor.samples();
    const auto graph = DeformationGraph::sample(samples, {}), again = DeformationGraph::sample(samples, {});
    EXPECT_GT(graph.nodes().size(), 1024u);
    ASSERT_EQ(graph.nodes().size(), again.nodes().size());
    for (size_t i = 0; i < graph.nodes().size(); ++i) {
        EXPECT_EQ(graph.nodes()[i].position, again.nodes()[i].position);
        EXPECT_EQ(graph.nodes()[i].last_seen, again.nodes()[i].last_seen);
    }
    ASSERT_EQ(graph.edges().size(), again.edges().size());
    for (size_t i = 0; i < graph.edges().size(); ++i) {
        EXPECT_EQ(graph.edges()[i].a, again.edges()[i].a);
        EXPECT_EQ(graph.edges()[i].b, again.edges()[i].b);
    }
}

TEST(DeformationGraphNodes, AreConnected) {
    // a far second place, long after: still tied to what came before
    Corridor near, far;
    near.length = far.length = 2;
    far.start = 5000;
    auto samples = near.samples();
    std::vector<GraphSample> there;
    far.append_to(there);
    for (auto& s : there) s.position.x() += 50;
    samples.insert(samples.end(), there.begin(), there.end());
    const auto graph = DeformationGraph::sample(samples, {});
    std::vector<int> earlier(graph.nodes().size(), 0);
    for (const auto& edge : graph.edges()) {
        EXPECT_LT(edge.a, edge.b);
        ++earlier[edge.b];
    }
    for (size_t i = 1; i < earlier.size(); ++i)
        EXPECT_EQ(earlier[i], std::min<int>(static_cast<int>(i), graph.config().neighbours));
}

TEST(DeformationGraphNodes, LeaveOutWhatIsNotFinite) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
    const std::vector<GraphSample> samples{
        {{kNan, 0, 0}, 0, 0}, {{0, 0, 1}, 3, 0}, {{0, kInfinity, 0}, 1, 1}, {{0, 1e30f, 0}, 1, 1}};
    const auto graph = DeformationGraph::sample(samples, {});
    ASSERT_EQ(graph.nodes().size(), 1u);
    EXPECT_EQ(graph.nodes()[0].time, 3u);
    EXPECT_EQ(graph.nodes()[0].last_seen, 3u);
}

TEST(DeformationGraphNodes, AConfigurationWithoutSenseIsAnError) {
    for (const int k : {0, 1, 2, 3, 4}) {
        DeformationConfig config;
        if (k == 0) config.node_spacing = 0;
        if (k == 1) config.temporal_window = 0;
        if (k == 2) config.neighbours = 0;
        if (k == 3) config.constraint_weight = -1;
        if (k == 4) config.iterations = 0;
        EXPECT_THROW((void)DeformationGraph::sample({}, config), Error) << k;
    }
}

// -------------------------------------------------------------------------------------------------------- influences

TEST(DeformationGraphInfluences, AddUpToOneAndFadeSmoothly) {
    const Corridor corridor;
    const auto graph = DeformationGraph::sample(corridor.samples(), {});
    const auto weights_at = [&](const Vector3d& p, std::uint32_t time) {
        Eigen::VectorXd w = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(graph.nodes().size()));
        for (const auto& share : graph.influences(p, time)) w[share.node] = share.weight;
        return w;
    };
    std::mt19937 random(3);
    for (int k = 0; k < 300; ++k) {
        const Vector3d p = corridor.wall(uniform(random, 0, corridor.length), uniform(random, 0, 6.28));
        const auto w = weights_at(p, corridor.time_at(p.z()));
        EXPECT_NEAR(w.sum(), 1, 1e-12);
        EXPECT_LE((w.array() > 1e-5).count(), kInfluences);
        // a millimetre, a frame: no jump where neighbours change
        EXPECT_LT((weights_at(p + Vector3d(0, 0, 1e-3), corridor.time_at(p.z())) - w).cwiseAbs().maxCoeff(), 0.03);
        EXPECT_LT((weights_at(p, corridor.time_at(p.z()) + 71) - weights_at(p, corridor.time_at(p.z()) + 70))
                      .cwiseAbs()
                      .maxCoeff(),
                  0.1);
    }
}

TEST(InfluenceTree, ListsAllWhoInfluenceAPoint) {
    Corridor first, second;
    first.length = second.length = 5;
    second.start = 700;
    auto samples = first.samples();
    second.append_to(samples);
    const auto graph = DeformationGraph::sample(samples, {});
    const InfluenceTree tree(graph);
    std::mt19937 random(4);
    size_t listed = 0, on_surface = 0;
    for (int k = 0; k < 20000; ++k) {
        const bool is_far = k % 4 == 0;
        const Corridor& walk = k % 2 == 0 ? first : second;
        Vector3d p = walk.wall(uniform(random, 0, 5), uniform(random, 0, 6.28)) +
                     0.02 * Vector3d(uniform(random, -1, 1), uniform(random, -1, 1), 0);
        std::uint32_t time = walk.time_at(p.z()) + static_cast<std::uint32_t>(random() % 20);
        if (is_far) {
            p = Vector3d(uniform(random, -4, 4), uniform(random, -4, 4), uniform(random, -30, 30));
            time = static_cast<std::uint32_t>(random() % 3000);
        }
        const auto candidates = tree.candidates(p, time);
        for (const auto& share : graph.influences(p, time)) {
            ASSERT_TRUE(
                std::any_of(candidates.begin(), candidates.end(), [&](const auto& c) { return c.node == share.node; }));
        }
        for (size_t i = 0; i < candidates.size(); ++i) {
            ASSERT_LE(candidates[i > 0 ? i - 1 : 0].bound, candidates[i].bound);
            const double distance = distance_in_space_and_time(graph, p, time, graph.nodes()[candidates[i].node]);
            ASSERT_LE(static_cast<double>(candidates[i].bound), distance * distance + 1e-6);
        }
        if (!is_far) listed += candidates.size(), ++on_surface;
    }
    EXPECT_LT(static_cast<double>(listed) / static_cast<double>(on_surface), 40) << "long lists make the kernel slow";
}

TEST(InfluenceTree, OfFewNodesListsThemAll) {
    for (int count = 0; count < 8; ++count) {
        std::vector<GraphSample> samples;
        for (int i = 0; i < count; ++i) samples.push_back({{static_cast<float>(i), 0, 0}, 0, 0});
        const InfluenceTree tree(DeformationGraph::sample(samples, {}));
        const auto candidates = tree.candidates({0.5, 0, 0}, 0);
        EXPECT_GE(candidates.size(), static_cast<size_t>(std::min(count, kInfluences + 1)));
        EXPECT_EQ(tree.nodes().size(), static_cast<size_t>(count));
    }
}

// -------------------------------------------------------------------------------------------------------- derivatives

/// A graph in which nothing is at rest.
struct RoughState {
    Corridor corridor;
    DeformationGraph graph;
    std::vector<LoopConstraint> constraints;
    std::vector<GraphNode> nodes;

    RoughState() {
        corridor.length = 2;
        std::mt19937 random(5);
        const auto cameras = corridor.cameras([&](double) {
            Matrix6d root;
            for (double& value : root.reshaped()) value = 1e4 * uniform(random, -1, 1);
            return Matrix6d(root * root.transpose());
        });
        graph = DeformationGraph::sample(corridor.samples(), {}, cameras);
        constraints = corridor.ring(0.4, 3, Isometry3d::Identity());
        append(constraints, pinned(corridor.ring(1.5, 3, motion({0.1, 0.2, 0}, {1, 0, 0}, 5))));
        constraints[1].relative = true;
        constraints[4].relative = true;
        constraints[4].target = corridor.wall(1.7, 1);
        constraints[0].by_camera = true;
        nodes.assign(graph.nodes().begin(), graph.nodes().end());
        nodes.insert(nodes.end(), graph.cameras().begin(), graph.cameras().end());
        for (auto& node : nodes) {
            const Vector3d axis(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
            node.R = Eigen::AngleAxisd(uniform(random, -2, 2), axis.normalized()).toRotationMatrix();
            node.t = Vector3d(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
        }
    }
};

TEST(DeformationEnergy, JacobiansAgreeWithNumericDifferences) {
    const RoughState state;
    const DeformationEnergy energy(state.graph, state.constraints);
    constexpr double h = 1e-6;
    EnergyTerm term, plus, minus;
    size_t checked = 0;
    for (size_t t = 0; t < energy.terms(); ++t) {
        energy.evaluate(t, state.nodes, term);
        for (size_t a = 0; a < term.count; ++a) {
            for (int k = 0; k < 6; ++k, ++checked) {
                const auto moved = [&](double by) {
                    auto nodes = state.nodes;
                    auto& node = nodes[term.node[a]];
                    if (k < 3)
                        node.R = Eigen::AngleAxisd(by, Vector3d::Unit(k)).toRotationMatrix() * node.R;
                    else
                        node.t[k - 3] += by;
                    return nodes;
                };
                energy.evaluate(t, moved(h), plus);
                energy.evaluate(t, moved(-h), minus);
                const Vector3d numeric = (plus.residual - minus.residual) / (2 * h);
                ASSERT_LT((numeric - term.jacobian[a].col(k)).norm(), 1e-6)
                    << "term " << t << " node " << a << " unknown " << k;
            }
        }
    }
    EXPECT_GT(checked, 1000u);
}

TEST(DeformationEnergy, DependsOnNoNodeThatItHasNoDerivativeBy) {
    const RoughState state;
    const DeformationEnergy energy(state.graph, state.constraints);
    EnergyTerm term, changed;
    for (size_t t = 0; t < energy.terms(); ++t) {
        energy.evaluate(t, state.nodes, term);
        for (std::uint32_t i = 0; i < state.nodes.size(); ++i) {
            const auto end = term.node.begin() + static_cast<std::ptrdiff_t>(term.count);
            if (std::find(term.node.begin(), end, i) != end) continue;
            auto nodes = state.nodes;
            nodes[i].t += Vector3d(1, 2, 3);
            energy.evaluate(t, nodes, changed);
            ASSERT_EQ(changed.residual, term.residual);
        }
    }
}

TEST(DeformationEnergy, NormalEquationsAreTheSumsOverAllTerms) {
    const RoughState state;
    const DeformationEnergy energy(state.graph, state.constraints);
    std::vector<bool> is_free(state.nodes.size(), true);
    is_free[2] = is_free[7] = false;
    NormalEquations equations(energy, state.nodes, is_free);
    equations.assemble(energy, state.nodes);

    std::vector<int> block(state.nodes.size(), -1);
    int blocks = 0;
    for (size_t i = 0; i < block.size(); ++i) block[i] = is_free[i] ? blocks++ : -1;
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(3 * energy.terms()), 6 * blocks);
    Eigen::VectorXd r = Eigen::VectorXd::Zero(J.rows());
    EnergyTerm term;
    double total = 0;
    for (size_t t = 0; t < energy.terms(); ++t) {
        energy.evaluate(t, state.nodes, term);
        const auto row = static_cast<Eigen::Index>(3 * t);
        r.segment<3>(row) = term.residual;
        total += term.residual.squaredNorm();
        for (size_t a = 0; a < term.count; ++a) {
            if (block[term.node[a]] >= 0) J.block<3, 6>(row, 6 * block[term.node[a]]) += term.jacobian[a];
        }
    }
    EXPECT_NEAR(energy.total(state.nodes), total, 1e-9 * total);
    const Eigen::MatrixXd H = J.transpose() * J;
    const Eigen::VectorXd g = J.transpose() * r;
    const Eigen::MatrixXd found = Eigen::MatrixXd(equations.hessian()).selfadjointView<Eigen::Lower>();
    EXPECT_LT((found - H).cwiseAbs().maxCoeff(), 1e-9 * H.cwiseAbs().maxCoeff());
    EXPECT_LT((equations.gradient() - g).cwiseAbs().maxCoeff(), 1e-9 * g.cwiseAbs().maxCoeff());

    std::vector<Step> step(state.nodes.size(), Step::Ones());
    ASSERT_TRUE(equations.solve(0, step));
    EXPECT_TRUE(step[2].isZero() && step[7].isZero()) << "fixed nodes have moved";
    Eigen::VectorXd x(6 * blocks);
    for (size_t i = 0; i < block.size(); ++i) {
        if (block[i] >= 0) x.segment<6>(6 * block[i]) = step[i];
    }
    EXPECT_LT((H * x + g).norm(), 1e-8 * g.norm());
}

// -------------------------------------------------------------------------------------------------------------- solve

TEST(DeformationGraph, WithoutASolutionIsTheIdentity) {
    const Corridor corridor;
    auto graph = DeformationGraph::sample(corridor.samples(), {});
    const Vector3d p = corridor.wall(3, 1);
    const auto pose = motion({0.1, 0.2, 4}, {1, 2, 3}, 50);
    EXPECT_LT((graph.deform(p, 90) - p).norm(), 1e-12);
    EXPECT_TRUE(graph.deform(pose, 90).isApprox(pose, 1e-12));
    const DeformationGraph empty;
    EXPECT_EQ(empty.deform(p, 90), p);
    EXPECT_TRUE(empty.deform(pose, 90).isApprox(pose, 0));
}

TEST(DeformationGraph, RigidConstraintsMoveEverythingRigidly) {
    const Corridor corridor;
    auto graph = DeformationGraph::sample(corridor.samples(), {});
    const auto T = motion({0.5, -0.3, 0.2}, {1, 0.3, -0.5}, 20);
    auto constraints = corridor.ring(1, 10, T);
    append(constraints, corridor.ring(5, 10, T));
    const auto result = graph.solve(constraints);
    ASSERT_TRUE(result.accepted) << result.reason;
    EXPECT_LT(result.energy_after, 1e-8 * result.energy_before);
    for (double z = 0; z <= corridor.length; z += 0.25) {
        const Vector3d p = corridor.wall(z, 7 * z);
        EXPECT_LT((graph.deform(p, corridor.time_at(z)) - T * p).norm(), 1e-4);
        const auto pose = motion({0, 0, z}, {0, 1, 0}, 10 * z);
        const auto found = graph.deform(pose, corridor.time_at(z));
        EXPECT_LT((found.linear() - T.linear() * pose.linear()).norm(), 1e-3);
        EXPECT_LT((found.translation() - T * pose.translation()).norm(), 1e-3);
    }
}

/// Where a corridor seen by a camera that drifts is thought to be: it bends with the length walked.
Vector3d drifted(const Vector3d& p) {
    const double z = p.z();
    return motion({0.012 * z * z / 2, 0.02 * z, 0}, {0.2, 1, 0}, 0.6 * z) * Vector3d(p.x(), p.y(), 0) +
           Vector3d(0, 0, z);
}

TEST(DeformationGraph, ClosesABentCorridorSmoothly) {
    const Corridor corridor;
    auto samples = corridor.samples();
    for (auto& s : samples) s.position = drifted(s.position.cast<double>()).cast<float>();
    auto graph = DeformationGraph::sample(samples, {});
    // the beginning is where it belongs, the end was recognised
    auto constraints = corridor.ring(0.2, 20, Isometry3d::Identity());
    for (auto& c : corridor.ring(9.8, 20, Isometry3d::Identity())) {
        c.source = drifted(c.source);
        constraints.push_back(c);
    }
    for (size_t i = 0; i < 20; ++i) constraints[i].source = constraints[i].target = drifted(constraints[i].source);
    const auto result = graph.solve(constraints);
    ASSERT_TRUE(result.accepted) << result.reason;
    EXPECT_GT(result.constraint_error_before_m, 0.1);
    EXPECT_LT(result.constraint_error_after_m, 0.005);
    EXPECT_LT(result.energy_after, 0.05 * result.energy_before);

    double before_last = 0;
    const auto error_at = [&](double z, auto place) {
        double sum = 0;
        for (int k = 0; k < 16; ++k) {
            const Vector3d p = corridor.wall(z, 0.4 * k), there = drifted(p);
            sum += (place(there, corridor.time_at(z)) - p).norm() / 16;
        }
        return sum;
    };
    double largest_jump = 0, last = 0, sum_before = 0, sum_after = 0;
    for (double z = 0; z <= corridor.length; z += 0.1) {
        const double before = error_at(z, [](const Vector3d& p, std::uint32_t) { return p; });
        const double after = error_at(z, [&](const Vector3d& p, std::uint32_t time) { return graph.deform(p, time); });
        sum_before += before, sum_after += after;
        const double moved = before - after;
        if (z > 0) largest_jump = std::max(largest_jump, std::abs(moved - before_last));
        before_last = moved;
        last = after;
    }
    EXPECT_LT(sum_after, 0.5 * sum_before) << "in the middle, too, it is nearer to the truth";
    EXPECT_LT(last, 0.02);
    EXPECT_LT(largest_jump, 0.05) << "between places 10 cm apart";
    EXPECT_LT(error_at(0.0, [&](const Vector3d& p, std::uint32_t time) { return graph.deform(p, time); }) -
                  error_at(0.0, [](const Vector3d& p, std::uint32_t) { return p; }),
              0.01)
        << "what is pinned stays";
}

TEST(DeformationGraph, LayersOfDifferentTimesMoveApart) {
    // the corridor is walked forth, left, and walked again much later, 8 cm off
    const Corridor first;
    Corridor second = first;
    second.start = 1000;
    const Vector3d offset(0.08, 0, 0);
    auto samples = first.samples();
    std::vector<GraphSample> again;
    second.append_to(again);
    for (auto& s : again) s.position += offset.cast<float>();
    samples.insert(samples.end(), again.begin(), again.end());
    auto graph = DeformationGraph::sample(samples, {});
    std::vector<LoopConstraint> constraints;
    for (const double z : {1.0, 3.0, 5.0, 7.0, 9.0}) {
        for (auto c : second.ring(z, 12, Isometry3d::Identity())) {
            c.source += offset;
            c.target_time = first.time_at(z);
            c.pin = true;
            constraints.push_back(c);
        }
    }
    const auto result = graph.solve(constraints);
    ASSERT_TRUE(result.accepted) << result.reason;
    for (double z = 0.5; z < 9.6; z += 0.5) {
        const Vector3d p = first.wall(z, 3 * z);
        EXPECT_LT((graph.deform(p, first.time_at(z)) - p).norm(), 0.01) << "the first layer was to stay, z " << z;
        EXPECT_LT((graph.deform(p + offset, second.time_at(z)) - p).norm(), 0.012)
            << "the second one was to join it, z " << z;
    }
}

/// What is known of a step: 3 mm and 3 mrad per frame after the correlation of pixels, but 3 cm in x between 4 and 5 m.
Matrix6d slipping(double z) {
    Matrix6d information = Matrix6d::Identity() * 1e5 * static_cast<double>(DeformationConfig{}.correlated_pixels);
    if (z > 4 && z <= 5) information(0, 0) *= 0.01;
    return information;
}

TEST(DeformationGraph, BendsWhereTrackingWasUncertain) {
    const Corridor corridor;
    const auto moved_at = [&](const std::vector<GraphCamera>& cameras, double z, const Vector3d& offset) {
        auto graph = DeformationGraph::sample(corridor.samples(), {}, cameras);
        const auto result = graph.solve(hold_and_lead(corridor, motion(offset, {0, 0, 1}, 0)));
        EXPECT_TRUE(result.accepted) << result.reason;
        return graph.deform(motion({0, 0, z}, {0, 0, 1}, 0), corridor.time_at(z))
                       .translation()
                       .dot(offset.normalized()) /
                   offset.norm() -
               Vector3d(0, 0, z).dot(offset.normalized()) / offset.norm();
    };
    const auto slips = corridor.cameras(slipping);
    const auto even = corridor.cameras([](double) { return slipping(0); });
    const Vector3d x(0.15, 0, 0), y(0, 0.15, 0);
    const auto share = [&](const std::vector<GraphCamera>& cameras, const Vector3d& offset) {
        return moved_at(cameras, 5.3, offset) - moved_at(cameras, 3.7, offset);
    };
    // the part of the way in which steps were uncertain takes far more of the offset than where all is known alike (not
    // all of it: the walls of the corridor are one piece); in a direction that was known there, too, it takes its share
    EXPECT_GT(share(slips, x), 1.6 * share(even, x));
    EXPECT_NEAR(share(slips, y), share(even, y), 0.03);
}

TEST(CameraTies, AStepIsAsCertainAsTheViewMadeIt) {
    DeformationConfig config;
    const double unknown_translation = static_cast<double>(DeformationConfig::kStepTranslationSigma),
                 unknown_rotation = static_cast<double>(DeformationConfig::kStepRotationSigma);
    std::vector<GraphCamera> cameras(2);
    Matrix6d covariance = step_covariance(cameras, 1, config);
    EXPECT_NEAR(covariance(0, 0), unknown_translation * unknown_translation, 1e-12) << "nothing is known";
    EXPECT_NEAR(covariance(5, 5), unknown_rotation * unknown_rotation, 1e-12);

    // a wall ahead: the distance to it (z of the camera) is known, along it nothing is; the camera looks along the
    // world's x
    const double sigma = 1e-3;
    cameras[0].T_world_camera = motion({1, 2, 3}, {0, 1, 0}, 90);
    cameras[1].T_world_camera = cameras[0].T_world_camera;
    cameras[1].information(2, 2) = static_cast<double>(config.correlated_pixels) / (sigma * sigma);
    covariance = step_covariance(cameras, 1, config);
    EXPECT_NEAR(covariance(0, 0), sigma * sigma, 1e-3 * sigma * sigma);
    EXPECT_NEAR(covariance(1, 1), unknown_translation * unknown_translation, 1e-12);
    EXPECT_NEAR(covariance(2, 2), unknown_translation * unknown_translation, 1e-12);
}

TEST(CameraTies, ATurnGoneWrongLeadsAllThatFollowsAstray) {
    // a step may have turned about y by 0.01 rad, all others are exact; 2 m further along z that is 2 cm in x
    DeformationConfig config;
    config.correlated_pixels = 1;
    std::vector<GraphCamera> cameras(41);
    for (size_t i = 0; i < cameras.size(); ++i) {
        cameras[i].T_world_camera.translation().z() = 0.05 * static_cast<double>(i);
        cameras[i].information = Matrix6d::Identity() * 1e12;
    }
    cameras[1].information(4, 4) = 1e4;
    const Matrix6d way = way_covariance(cameras, 0, 40, config);
    EXPECT_NEAR(std::sqrt(way(4, 4)), 0.01, 5e-4) << "less what is known before: no step turns by 0.05 rad";
    EXPECT_NEAR(std::sqrt(way(0, 0)), 2 * std::sqrt(way(4, 4)), 1e-4);
    EXPECT_LT(std::sqrt(way(1, 1)), 1e-4);
    EXPECT_NEAR(way(0, 4) / std::sqrt(way(0, 0) * way(4, 4)), 1, 1e-3) << "to the left where it turned left";
    // whitened, an error along what is uncertain is small and any other is large
    const Matrix6d root = whitening(way);
    Step astray = Step::Zero(), impossible = Step::Zero();
    astray(0) = 0.02, astray(4) = 0.01;
    impossible(0) = -0.02, impossible(4) = 0.01;
    EXPECT_NEAR((root * astray).norm(), 1, 0.05);
    EXPECT_GT((root * impossible).norm(), 100);
}

TEST(DeformationGraph, FollowsItsCameras) {
    const Corridor corridor;
    const auto samples = corridor.samples();
    std::vector<GraphCamera> cameras;
    std::uint32_t last = 0;
    for (const GraphSample& s : samples) last = std::max(last, s.last_seen);
    for (std::uint32_t frame = 0; frame <= last; ++frame)
        cameras.push_back({motion({0, 0, 0.01 * frame}, {0, 1, 0}, 0.05 * frame), frame, Matrix6d::Identity()});
    DeformationGraph graph = DeformationGraph::sample(samples, {}, cameras);

    // all cameras were elsewhere: so is all that they saw
    const Isometry3d elsewhere = motion({0.1, -0.05, 0.2}, {1, 2, 0}, 7);
    std::vector<Isometry3d> poses;
    for (const GraphCamera& camera : cameras) poses.push_back(elsewhere * camera.T_world_camera);
    graph.follow(cameras, poses);
    for (const GraphSample& s : samples) {
        const Vector3d p = s.position.cast<double>();
        EXPECT_LT((graph.deform(p, s.created) - elsewhere * p).norm(), 1e-9);
    }
    for (const GraphNode& node : graph.nodes())
        EXPECT_LT((node.R.transpose() * node.R - Eigen::Matrix3d::Identity()).norm(), 1e-9);

    // a drift that grows with time: a surface moves as the cameras did while it was in view, in the mean
    graph = DeformationGraph::sample(samples, {}, cameras);
    for (std::size_t k = 0; k < poses.size(); ++k)
        poses[k] = Eigen::Translation3d(1e-4 * static_cast<double>(k), 0, 0) * cameras[k].T_world_camera;
    graph.follow(cameras, poses);
    for (const GraphNode& node : graph.nodes())
        EXPECT_NEAR(node.t.x(), 1e-4 * 0.5 * (node.time + node.last_seen),
                    1e-4 * (1 + 0.06 * (node.last_seen - node.time)));
    poses.pop_back();
    EXPECT_THROW(graph.follow(cameras, poses), Error);
}

TEST(DeformationGraph, RotationsStayRotations) {
    const Corridor corridor;
    auto graph = DeformationGraph::sample(corridor.samples(), {});
    const auto result = graph.solve(hold_and_lead(corridor, motion({1.0, 0.5, -0.2}, {0, 1, 0}, 25)));
    ASSERT_TRUE(result.accepted) << result.reason;
    double turned = 0;
    for (const auto& node : graph.nodes()) {
        EXPECT_LT((node.R.transpose() * node.R - Eigen::Matrix3d::Identity()).norm(), 1e-12);
        EXPECT_GT(node.R.determinant(), 0);
        turned = std::max(turned, Eigen::AngleAxisd(node.R).angle());
    }
    EXPECT_GT(turned, 0.2);
    for (double z = 0; z <= 10; z += 0.5) {
        const Eigen::Matrix3d R = graph.deform(motion({0.1, 0, z}, {0, 1, 0}, 30 * z), corridor.time_at(z)).linear();
        EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), 1e-12);
        EXPECT_NEAR(R.determinant(), 1, 1e-12);
    }
}

TEST(DeformationGraph, PinsHoldTheTarget) {
    const Corridor corridor;
    const Vector3d shift(0.1, 0, 0);
    // the end belongs 10 cm beside where it is, which is said by its distance from the beginning
    const auto solve = [&](bool pin) {
        auto graph = DeformationGraph::sample(corridor.samples(), {});
        std::vector<LoopConstraint> constraints;
        for (int k = 0; k < 12; ++k) {
            LoopConstraint c;
            c.source = corridor.wall(9.7, k);
            c.source_time = corridor.time_at(9.7);
            c.target = c.source + shift;
            c.target_time = corridor.time_at(9.7);
            constraints.push_back(c);
            c.source = c.target = corridor.wall(0.3, k);
            c.source_time = c.target_time = corridor.time_at(0.3);
            c.pin = pin;
            c.relative = true;  // with itself: says nothing
            constraints.push_back(c);
        }
        const auto result = graph.solve(constraints);
        EXPECT_TRUE(result.accepted) << result.reason;
        return (graph.deform(corridor.wall(0.3, 0.5), corridor.time_at(0.3)) - corridor.wall(0.3, 0.5)).norm();
    };
    EXPECT_GT(solve(false), 0.05) << "without a pin the whole map moves";
    EXPECT_LT(solve(true), 0.003);
}

TEST(DeformationGraph, RelativeConstraintsMoveBothSides) {
    const Corridor corridor;
    auto graph = DeformationGraph::sample(corridor.samples(), {});
    // rings half a metre apart on the same surface cannot meet: refused, though the absolute constraints could be met
    std::vector<LoopConstraint> constraints = corridor.ring(0.3, 12, motion({0.3, 0, 0}, {0, 0, 1}, 0));
    for (int k = 0; k < 12; ++k) {
        LoopConstraint c;
        c.source = corridor.wall(9.5, k);
        c.target = corridor.wall(9.0, k);
        c.source_time = c.target_time = corridor.time_at(9.5);
        c.relative = true;
        constraints.push_back(c);
    }
    const auto before = graph.deform(corridor.wall(9, 0), corridor.time_at(9));
    const auto contradiction = graph.solve(constraints);
    EXPECT_FALSE(contradiction.accepted);
    EXPECT_EQ(graph.deform(corridor.wall(9, 0), corridor.time_at(9)), before);

    // two visits: the second is tied to the first, the first is led away, both go
    Corridor second = corridor;
    second.start = 1000;
    auto samples = corridor.samples();
    second.append_to(samples);
    graph = DeformationGraph::sample(samples, {});
    constraints = corridor.ring(0.5, 12, motion({0.3, 0, 0}, {0, 0, 1}, 0));
    for (const double z : {0.5, 5.0, 9.5}) {
        for (auto c : second.ring(z, 12, Isometry3d::Identity())) {
            c.target_time = corridor.time_at(z);
            c.relative = true;
            constraints.push_back(c);
        }
    }
    const auto result = graph.solve(constraints);
    ASSERT_TRUE(result.accepted) << result.reason;
    for (const double z : {0.5, 5.0, 9.5}) {
        const Vector3d p = corridor.wall(z, 1);
        const Vector3d first_at = graph.deform(p, corridor.time_at(z)), second_at = graph.deform(p, second.time_at(z));
        EXPECT_LT((first_at - second_at).norm(), 0.01);
        EXPECT_GT((second_at - p).norm(), 0.2);
    }
}

TEST(DeformationGraph, OldNodesCanBeHeld) {
    const Corridor corridor;
    auto graph = DeformationGraph::sample(corridor.samples(), {});
    const auto held_until = corridor.time_at(4);
    const auto result = graph.solve(corridor.ring(9.5, 20, motion({0.2, 0.1, 0}, {0, 0, 1}, 0)), held_until);
    ASSERT_TRUE(result.accepted) << result.reason;
    double moved = 0;
    for (const auto& node : graph.nodes()) {
        if (node.time < held_until)
            EXPECT_TRUE(node.t.isZero() && node.R.isIdentity(0));
        else
            moved = std::max(moved, node.t.norm());
    }
    EXPECT_GT(moved, 0.1);
}

TEST(DeformationGraph, SolvesTheSameWayTwice) {
    const Corridor corridor;
    const auto solved = [&] {
        auto graph = DeformationGraph::sample(corridor.samples(), {});
        EXPECT_TRUE(graph.solve(hold_and_lead(corridor, motion({0.3, 0, 0}, {0, 1, 0}, 5))).accepted);
        return graph;
    };
    const auto a = solved(), b = solved();
    for (size_t i = 0; i < a.nodes().size(); ++i) {
        ASSERT_EQ(a.nodes()[i].t, b.nodes()[i].t);
        ASSERT_EQ(a.nodes()[i].R, b.nodes()[i].R);
    }
}

// --------------------------------------------------------------------------------------------------------- rejections

struct Rejection {
    const char* name;
    const char* reason;  // part of it
    std::vector<LoopConstraint> constraints;
    DeformationConfig config = {};
    std::uint32_t fixed_before = 0;
};

std::vector<Rejection> rejections() {
    const Corridor corridor;
    std::vector<Rejection> all;
    const auto good = hold_and_lead(corridor, motion({0.3, 0, 0}, {0, 1, 0}, 5));
    all.push_back({"NoConstraints", "no constraints", {}});
    all.push_back({"NothingToDo", "nothing to do", hold_and_lead(corridor, motion({0.001, 0, 0}, {0, 1, 0}, 0))});
    all.push_back({"AllFixed", "all nodes are fixed", good, {}, 100000});
    all.push_back({"NotConverged", "not converged", good, [] {
                       DeformationConfig c;
                       c.iterations = 1;
                       return c;
                   }()});
    auto broken = good;
    broken[3].target.y() = std::numeric_limits<double>::quiet_NaN();
    all.push_back({"NotANumber", "constraint 3 is not finite", broken});
    broken[3].target.y() = 0;
    broken[5].source.x() = std::numeric_limits<double>::infinity();
    all.push_back({"Infinite", "constraint 5 is not finite", broken});
    auto contradiction = good;
    append(contradiction, corridor.ring(9.7, 20, motion({-0.3, 0, 0}, {0, 1, 0}, 0)));
    all.push_back({"Contradiction", "contradict", contradiction});
    // rings 60 cm apart led 60 cm farther apart: no drift does that
    auto tear = corridor.ring(4.7, 40, Isometry3d::Identity());
    append(tear, corridor.ring(5.3, 40, motion({0, 0, 0.6}, {0, 0, 1}, 0)));
    all.push_back({"Tear", "", tear});  // whichever test finds it first
    all.push_back({"TornEdges", "torn apart", good, [] {
                       DeformationConfig c;
                       c.max_edge_error = 0.001f;
                       return c;
                   }()});
    return all;
}

class DeformationGraphRejects : public testing::TestWithParam<Rejection> {};
INSTANTIATE_TEST_SUITE_P(Each, DeformationGraphRejects, testing::ValuesIn(rejections()),
                         [](const auto& test) { return test.param.name; });
void PrintTo(const Rejection& r, std::ostream* stream) { *stream << r.name; }

TEST_P(DeformationGraphRejects, AndLeavesTheGraphAsItWas) {
    const Corridor corridor;
    auto graph = DeformationGraph::sample(corridor.samples(), GetParam().config);
    const auto result = graph.solve(GetParam().constraints, GetParam().fixed_before);
    EXPECT_FALSE(result.accepted);
    EXPECT_NE(result.reason, "");
    EXPECT_NE(result.reason.find(GetParam().reason), std::string::npos) << result.reason;
    EXPECT_EQ(result.reason.find('\n'), std::string::npos);
    for (const auto& node : graph.nodes()) ASSERT_TRUE(node.t.isZero(0) && node.R.isIdentity(0));
}

TEST(DeformationGraph, WithoutNodesRejects) {
    DeformationGraph graph;
    EXPECT_FALSE(graph.solve(Corridor().ring(1, 4, motion({1, 0, 0}, {1, 0, 0}, 0))).accepted);
}

// --------------------------------------------------------------------------------------------------------------- size

TEST(DeformationGraph, WorksWithFewNodes) {
    for (int count = 1; count <= 7; ++count) {
        std::vector<GraphSample> samples;
        for (int i = 0; i < count; ++i)
            samples.push_back({{0.5f * static_cast<float>(i), 0.1f * static_cast<float>(i * i), 0},
                               static_cast<std::uint32_t>(i),
                               20});
        auto graph = DeformationGraph::sample(samples, {});
        ASSERT_EQ(graph.nodes().size(), static_cast<size_t>(count));
        const auto T = motion({0.1, 0.2, 0.3}, {1, 1, 0}, 10);
        std::vector<LoopConstraint> constraints;
        for (const Vector3d& p : {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1)}) {
            LoopConstraint c;
            c.source = p;
            c.target = T * p;
            constraints.push_back(c);
        }
        const auto result = graph.solve(constraints);
        EXPECT_TRUE(result.accepted) << count << " nodes: " << result.reason;
        EXPECT_LT((graph.deform(Vector3d(0.3, 0.2, 0.1), 3) - T * Vector3d(0.3, 0.2, 0.1)).norm(), 1e-3) << count;
    }
}

/// Milliseconds to solve a corridor of some length with 100 constraints.
double solve_time(double length, size_t least_nodes, size_t most_nodes) {
    Corridor corridor;
    corridor.length = length;
    auto graph = DeformationGraph::sample(corridor.samples(), {}, corridor.cameras(slipping));
    EXPECT_GE(graph.nodes().size(), least_nodes);
    EXPECT_LE(graph.nodes().size(), most_nodes);
    const auto constraints = hold_and_lead(corridor, motion({0.01 * length, 0.1, 0}, {0, 1, 0}, 4), 50);
    // processor time: what others do meanwhile does not count
    const std::clock_t begin = std::clock();
    const auto result = graph.solve(constraints);
    const double ms = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    EXPECT_TRUE(result.accepted) << result.reason;
    std::printf("%zu nodes, %zu cameras, %zu edges, %zu constraints: %d iterations, %.1f ms\n", graph.nodes().size(),
                graph.cameras().size(), graph.edges().size() + graph.camera_ties().size(), constraints.size(),
                result.iterations, ms);
    return ms;
}

TEST(DeformationGraphSpeed, FiveHundredNodesWithinATenthOfASecond) {
    const double ms = solve_time(13, 480, 560);
#if defined(NDEBUG) && !defined(__SANITIZE_ADDRESS__)
    EXPECT_LT(ms, 1000) << "the claim is 100 ms on a processor of today that has nothing else to do";
#else
    (void)ms;  // speed is measured in optimised builds without sanitizers
#endif
}

TEST(DeformationGraphSpeed, FiveThousandNodesWork) { solve_time(125, 4900, 5600); }

}  // namespace
}  // namespace posefusion::test
