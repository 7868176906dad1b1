#include "engine/vulkan/available_memory.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/vulkan/device_info.hpp"
#include "tests/engine/support/kernel_harness.hpp"

namespace posefusion::test {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

/// A machine's files about memory, in a folder.
class MemoryFiles : public testing::Test {
protected:
    void SetUp() override {
        write("proc/meminfo", "MemTotal: 9000000 kB\nMemAvailable:    2048000 kB\nSwapFree: 1024000 kB\n");
    }
    void TearDown() override { fs::remove_all(root_); }
    void write(const std::string& name, const std::string& text) const {
        fs::create_directories((root_ / name).parent_path());
        std::ofstream(root_ / name) << text;
    }
    const fs::path root_ = fs::path(testing::TempDir()) /
                           (std::string("memory-") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(MemoryFiles, OfTheMachineWithSwap) {
    EXPECT_EQ(available_memory(root_).bytes, std::uint64_t{3000} * kMiB);
    EXPECT_EQ(available_memory(root_).limit, "the memory of this machine");
}

TEST_F(MemoryFiles, OfTheTightestControlGroup) {
    write("proc/self/cgroup", "0::/user/job\n");
    write("sys/fs/cgroup/user/job/memory.max", "max\n");
    write("sys/fs/cgroup/user/job/memory.current", "1000\n");
    EXPECT_EQ(available_memory(root_).bytes, std::uint64_t{3000} * kMiB) << "no limit";
    write("sys/fs/cgroup/user/memory.max", std::to_string(500 * kMiB));
    write("sys/fs/cgroup/user/memory.current", std::to_string(300 * kMiB));
    write("sys/fs/cgroup/user/memory.stat", "anon 5\ninactive_file " + std::to_string(100 * kMiB) + "\n");
    EXPECT_EQ(available_memory(root_).bytes, 300 * kMiB) << "of the group around it, page cache does not count";
    EXPECT_EQ(available_memory(root_).limit, "the memory of its control group");
}

TEST_F(MemoryFiles, OfAControlGroupOfVersionOne) {
    write("proc/self/cgroup", "9:name=systemd:/\n4:memory:/job\n0::/\n");
    write("sys/fs/cgroup/memory/job/memory.limit_in_bytes", std::to_string(400 * kMiB));
    write("sys/fs/cgroup/memory/job/memory.usage_in_bytes", std::to_string(450 * kMiB));
    write("sys/fs/cgroup/memory/job/memory.stat", "total_inactive_file 0\n");
    EXPECT_EQ(available_memory(root_).bytes, 0u) << "more than it may is used";
}

TEST_F(MemoryFiles, WhereNothingIsKnownNothingIsRefused) {
    EXPECT_GT(available_memory(root_ / "nothing").bytes, std::uint64_t{1} << 60);
}

/// What becomes of a device in a process that may take `more` address space. Exits with 0: works, 42: told in a line.
[[noreturn]] void open_device_with(std::uint64_t more) {
    std::ifstream statm("/proc/self/statm");
    std::uint64_t pages = 0;
    statm >> pages;
    const rlimit limit{pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) + more, RLIM_INFINITY};
    setrlimit(RLIMIT_AS, &limit);
    try {
        vulkan::ContextOptions options;
        options.device = test_device();
        const vulkan::Context context(options);
        _exit(0);
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        _exit(42);
    }
}

TEST(AvailableMemoryDeathTest, TooLittleAddressSpaceIsToldBeforeASoftwareDriverCrashes) {
    const std::vector<DeviceInfo> devices = list_devices();
    if (devices[choose_device(devices, test_device()).index].kind != "cpu")
        GTEST_SKIP() << "a GPU has memory of its own";
    testing::FLAGS_gtest_death_test_style = "threadsafe";  // in a process of its own, without a driver so far
    for (const std::uint64_t more : {50, 150, 250, 400, 600, 750}) {
        EXPECT_EXIT(open_device_with(more * kMiB), testing::ExitedWithCode(42),
                    "too little memory.* MiB are needed, and the limit on address space \\(ulimit -v\\) leaves")
            << more;
    }
}

}  // namespace
}  // namespace posefusion::test
