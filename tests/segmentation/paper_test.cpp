#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgproc/detail/gcgraph.hpp>
#include <set>
#include <string>

#include "segmentation/paper_min_cut.hpp"
#include "segmentation/segmenter.hpp"
#include "tests/segmentation/scene.hpp"

namespace posefusion {
namespace {

using Eigen::Vector3f;

std::filesystem::path shared_data() {
    if (const char* folder = std::getenv("POSEFUSION_SHARED_DATA")) return folder;
    return std::filesystem::path(POSEFUSION_SOURCE_DIR) / ".." / "shared" / "data";
}

std::vector<Vector3f> read_ascii_pcd(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string line;
    while (std::getline(in, line) && line.rfind("DATA", 0) != 0) {
    }
    std::vector<Vector3f> points;
    for (Vector3f p; in >> p.x() >> p.y() >> p.z();) points.push_back(p);
    return points;
}

double thread_seconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Two points, the seed on the first. Source edges weigh 1 each, the sink edge of the second P = d / r of eq. (3), of
// the first 0, and the edge between C = exp(-(length / sigma)^2) of eq. (2). The flow to the sink is min(P, 1 + min(C,
// 1)).
TEST(PaperMinCut, FlowOfTwoPointsIsGivenByEquations2And3) {
    PaperMinCutConfig config;
    config.source_weight = 1;
    config.sigma = 0.25f;
    config.radius = 0.05f;
    const double length = 0.2;
    const double smoothness = std::exp(-(length / 0.25) * (length / 0.25));
    ASSERT_GT(length / 0.05, 1 + smoothness);
    const PaperMinCut across = paper_min_cut({{0, 0, 1}, {0.2f, 0, 1}}, {{0, 0, 1}}, config);
    EXPECT_NEAR(across.max_flow, 1 + smoothness, 1e-5);

    config.radius = 0.4f;  // now the sink edge is the narrowest: P = 0.2 / 0.4
    EXPECT_NEAR(paper_min_cut({{0, 0, 1}, {0.2f, 0, 1}}, {{0, 0, 1}}, config).max_flow, 0.5, 1e-5);
}

TEST(PaperMinCut, DistanceOfEquation3IgnoresDepth) {
    PaperMinCutConfig config;
    config.radius = 0.4f;
    const PaperMinCut cut = paper_min_cut({{0, 0, 1}, {0.12f, 0.16f, 3}}, {{0, 0, 1}}, config);
    EXPECT_NEAR(cut.max_flow, 0.2 / 0.4, 1e-5);
}

TEST(PaperMinCut, NothingIsForegroundWithoutSeedsOrPoints) {
    const PaperMinCut no_seeds = paper_min_cut({{0, 0, 1}, {1, 0, 1}}, {}, {});
    EXPECT_EQ(std::count(no_seeds.foreground.begin(), no_seeds.foreground.end(), true), 0);
    EXPECT_TRUE(paper_min_cut({}, {{0, 0, 1}}, {}).foreground.empty());
}

/// Energy of the same cut by another implementation: eq. (2) between each point and its nearest neighbours, found one
/// by one, eq. (3) to the sink, and OpenCV's maximum flow.
double energy_by_hand(const std::vector<Vector3f>& points, const Vector3f& seed, const PaperMinCutConfig& config) {
    const auto count = static_cast<int>(points.size());
    cv::detail::GCGraph<double> graph;
    graph.create(static_cast<unsigned>(count), static_cast<unsigned>(count * 2 * config.neighbours));
    for (const Vector3f& p : points)
        graph.addTermWeights(graph.addVtx(), config.source_weight, (p - seed).head<2>().norm() / config.radius);
    std::set<std::pair<int, int>> edges;
    for (int i = 0; i < count; ++i) {
        std::vector<std::pair<float, int>> others;
        for (int j = 0; j < count; ++j)
            if (j != i) others.push_back({(points[j] - points[i]).squaredNorm(), j});
        const auto last = others.begin() + config.neighbours - 1;
        std::nth_element(others.begin(), last, others.end());
        for (auto it = others.begin(); it != last; ++it)
            if (edges.insert({std::min(i, it->second), std::max(i, it->second)}).second) {
                const double weight = std::exp(-it->first / (config.sigma * config.sigma));
                graph.addEdges(i, it->second, weight, weight);
            }
    }
    return graph.maxFlow();
}

// The cloud and the numbers of PCL's tutorial: a car seen by a scanner.
TEST(PaperMinCut, TutorialCloudIsCutAtTheEnergyOfEquations2And3) {
    const auto file = shared_data() / "pointclouds" / "min_cut_segmentation_tutorial.pcd";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "shared data absent: " << file;
    const std::vector<Vector3f> points = read_ascii_pcd(file);
    const Vector3f seed(68.97f, -18.55f, 0.57f);
    PaperMinCutConfig config;
    config.sigma = 0.25f;
    config.radius = 3.0433856f;
    const PaperMinCut cut = paper_min_cut(points, {seed}, config);
    EXPECT_EQ(std::count(cut.foreground.begin(), cut.foreground.end(), true), 4343);
    EXPECT_NEAR(cut.max_flow, energy_by_hand(points, seed, config), 1e-3 * cut.max_flow);
}

TEST(PaperMode, CutsAPersonOutOfARoom) {
    const Intrinsics camera = test::camera_of(320, 240);
    const test::Frame frame = test::render({.people = {{0.2f, 3.2f}}}, camera);
    SegmentationConfig config;
    config.mode = SegmentationMode::Paper;
    config.paper_step = 2;
    const Segmentation result = make_segmenter(config, camera, {})
                                    ->segment(frame.color, frame.depth, frame.people, Eigen::Isometry3f::Identity());
    const test::Score score = test::score(result.labels, frame.truth);
    EXPECT_EQ(result.people, 1);
    EXPECT_GT(score.recall, 0.8);
    EXPECT_LT(score.static_lost, 0.05);
}

TEST(Modes, ImageIsBetterThanPaperAndTenTimesFaster) {
#if !defined(NDEBUG) || defined(__SANITIZE_ADDRESS__)
    GTEST_SKIP() << "speed is measured in optimised builds without sanitizers";
#endif
    const Intrinsics camera = test::camera_of(640, 480);
    const test::Frame frame = test::render({.people = {{-0.6f, 3.0f}, {0.5f, 2.6f}}}, camera);
    std::array<double, 2> seconds{}, iou{};
    for (const SegmentationMode mode : {SegmentationMode::Paper, SegmentationMode::Image}) {
        SegmentationConfig config;
        config.mode = mode;
        const auto segmenter = make_segmenter(config, camera, {});
        std::vector<double> times;
        for (int run = 0; run < 3; ++run) {
            const double start = thread_seconds();
            const Segmentation result =
                segmenter->segment(frame.color, frame.depth, frame.people, Eigen::Isometry3f::Identity());
            times.push_back(thread_seconds() - start);
            iou[mode == SegmentationMode::Image] = test::score(result.labels, frame.truth).iou;
        }
        std::sort(times.begin(), times.end());
        seconds[mode == SegmentationMode::Image] = times[1];
    }
    EXPECT_GT(iou[1], iou[0] + 0.05);
    EXPECT_GT(seconds[0] / seconds[1], 10) << seconds[0] << " s and " << seconds[1] << " s";
}

}  // namespace
}  // namespace posefusion
