#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "engine/preprocess/undistortion.hpp"
#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"
#include "tests/engine/support/synthetic_room.hpp"

// Same input, same bytes: run after run, with both depth tests, with any number of threads.
namespace posefusion::test {
namespace {

std::vector<Isometry3d> short_path() { return path_to(motion({0.06, -0.03, 0.05}, {1, 2, -1}, 8), 5); }

class Determinism : public SlamTest {};

TEST_F(Determinism, TwoRunsAreEqualByteByByte) {
    EXPECT_EQ(run_slam(kSmall, test_config(), short_path()).bytes(),
              run_slam(kSmall, test_config(), short_path()).bytes());
}

TEST_F(Determinism, BothDepthTestsGiveTheSameTrajectoryAndMap) {
    SlamConfig narrow = test_config();
    narrow.int64_atomics = false;
    const Recording wide = run_slam(kSmall, test_config(), short_path()),
                    two_passes = run_slam(kSmall, narrow, short_path());
    EXPECT_EQ(wide.bytes(), two_passes.bytes());
}

TEST_F(Determinism, RenderingBetweenFramesChangesNothing) {
    const auto path = short_path();
    Slam slam(kSmall, test_config(), test_device());
    Recording watched;
    for (const auto& pose : path) {
        const Frame frame = render_room(kSmall, pose);
        watched.results.push_back(slam.process(frame.color, frame.depth));
        (void)slam.render(pose);
        (void)slam.surfels();
    }
    watched.surfels = slam.surfels(false);
    EXPECT_EQ(watched.bytes(), run_slam(kSmall, test_config(), path).bytes());
}

TEST_F(Determinism, UndistortingTheNextFramesMeanwhileChangesNothing) {
    const auto path = short_path();
    Slam slam(kSmall, test_config(), test_device());
    LensMap lens(kSmall.width, kSmall.height);  // mirrors left and right: the result is easily told
    for (int v = 0; v < lens.height(); ++v)
        for (int u = 0; u < lens.width(); ++u)
            lens(u, v) = {static_cast<float>(lens.width() - 1 - u), static_cast<float>(v)};
    const Undistortion undistortion(slam.context(), lens);
    const Frame distorted = render_room(kSmall, path[0]);
    std::atomic<bool> done = false;
    std::atomic<int> rounds = 0, wrong = 0;
    std::thread reader([&] {
        do {
            ColorImage color = distorted.color;
            DepthImage depth = distorted.depth;
            (void)undistortion.apply(color, depth);
            for (int v = 0; v < lens.height(); ++v)
                for (int u = 0; u < lens.width(); ++u) {
                    const int mirrored = lens.width() - 1 - u;
                    wrong += color(u, v) != distorted.color(mirrored, v) || depth(u, v) != distorted.depth(mirrored, v);
                }
            ++rounds;
        } while (!done);
    });
    Recording busy;
    for (const auto& pose : path) {
        const Frame frame = render_room(kSmall, pose);
        busy.results.push_back(slam.process(frame.color, frame.depth));
    }
    done = true;
    reader.join();
    busy.surfels = slam.surfels(false);
    EXPECT_EQ(busy.bytes(), run_slam(kSmall, test_config(), path).bytes());
    EXPECT_GE(rounds.load(), 2);
    EXPECT_EQ(wrong.load(), 0);
    EXPECT_EQ(slam.validation_messages(), 0u);
}

/// FNV-1a of a run's bytes.
std::string digest(const Recording& run) {
    std::uint64_t hash = 14695981039346656037u;
    for (const unsigned char byte : run.bytes()) hash = (hash ^ byte) * 1099511628211u;
    return std::to_string(hash);
}

// Not a test of its own: Determinism.ThreadsDoNotMatter runs it in processes with another number of threads each.
TEST(Digest, DISABLED_Print) {
    std::printf("digest %s\n", digest(run_slam(kSmall, SlamConfig{}, short_path())).c_str());
}

std::string digest_with_threads(int threads) {
    const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
    const std::string command = "LP_NUM_THREADS=" + std::to_string(threads) + " '" + program +
                                "' --gtest_also_run_disabled_tests --gtest_filter=Digest.DISABLED_Print 2>&1";
    FILE* pipe = popen(command.c_str(), "r");
    if (!pipe) return "cannot start " + program;
    std::string output;
    char line[512];
    while (std::fgets(line, sizeof(line), pipe)) output += line;
    pclose(pipe);
    const auto at = output.find("digest ");
    return at == std::string::npos ? output : output.substr(at, output.find('\n', at) - at);
}

TEST_F(Determinism, ThreadsDoNotMatter) {
    const std::string one = digest_with_threads(1);
    ASSERT_EQ(one.substr(0, 7), "digest ") << one;
    EXPECT_EQ(digest_with_threads(2), one);
    EXPECT_EQ(digest_with_threads(3), one);
}

}  // namespace
}  // namespace posefusion::test
