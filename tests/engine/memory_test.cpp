#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"

// Device memory: many buffers share a block, freed ranges merge, large buffers go back to the device.
namespace posefusion::test {
namespace {

using namespace vulkan;

constexpr VkDeviceSize kMiB = VkDeviceSize{1} << 20;

class Memory : public testing::Test {
protected:
    Memory() {
        ContextOptions options;
        options.device = test_device();
        context = std::make_unique<Context>(options);
    }
    [[nodiscard]] Allocation allocate(VkDeviceSize size, VkDeviceSize alignment = 64,
                                      MemoryKind kind = MemoryKind::Device) const {
        return context->allocate({size, alignment, ~0u}, kind);
    }
    std::unique_ptr<Context> context;
};

TEST_F(Memory, SmallAllocationsShareABlock) {
    const auto first = allocate(1000);
    const auto bytes = context->allocated_bytes();
    std::vector<Allocation> others;
    for (int i = 0; i < 100; ++i) others.push_back(allocate(5000));
    EXPECT_EQ(context->allocated_bytes(), bytes);
    for (const auto& a : others) {
        EXPECT_EQ(a.memory, first.memory);
        context->release(a);
    }
    context->release(first);
}

TEST_F(Memory, AllocationsNeverOverlapAndAreAligned) {
    Random random(1);
    std::vector<Allocation> live;
    for (int step = 0; step < 2000; ++step) {
        if (!live.empty() && random.chance(0.48)) {
            const auto i = random.below(static_cast<std::uint32_t>(live.size()));
            context->release(live[i]);
            live.erase(live.begin() + static_cast<std::ptrdiff_t>(i));
        } else {
            const VkDeviceSize alignment = VkDeviceSize{1} << (4 + random.below(9));
            const VkDeviceSize size = 1 + random.below(random.chance(0.1) ? 3u << 20 : 60000u);
            live.push_back(allocate(size, alignment));
            ASSERT_EQ(live.back().offset % alignment, 0u);
            ASSERT_EQ(live.back().size, size);
        }
    }
    std::map<VkDeviceMemory, std::vector<std::pair<VkDeviceSize, VkDeviceSize>>> ranges;
    for (const auto& a : live) ranges[a.memory].push_back({a.offset, a.offset + a.size});
    for (auto& [memory, list] : ranges) {
        std::sort(list.begin(), list.end());
        for (std::size_t i = 1; i < list.size(); ++i) ASSERT_GE(list[i].first, list[i - 1].second);
    }
    for (const auto& a : live) context->release(a);
}

TEST_F(Memory, FreedNeighboursMergeIntoOneRange) {
    // fill a block with pieces, free them in an order that exercises merging on both sides, ask for the whole again
    std::vector<Allocation> pieces;
    for (int i = 0; i < 16; ++i) pieces.push_back(allocate(2 * kMiB));
    const auto bytes = context->allocated_bytes();
    for (const int i : {1, 3, 5, 7, 9, 11, 13, 15, 14, 2, 4, 0, 10, 8, 6, 12})
        context->release(pieces[static_cast<std::size_t>(i)]);
    const auto whole = allocate(32 * kMiB);
    EXPECT_EQ(context->allocated_bytes(), bytes) << "the freed pieces were not reused as one";
    context->release(whole);
}

TEST_F(Memory, LargeBuffersAreGivenBack) {
    const auto before = context->allocated_bytes();
    // 32 MiB is the size of a shared block as well: the stream of two million surfels must not stay either
    for (const VkDeviceSize size : {16 * kMiB, 32 * kMiB, 64 * kMiB, 100 * kMiB + 64}) {
        const auto large = allocate(size);
        EXPECT_EQ(context->allocated_bytes(), before + size);
        context->release(large);
        EXPECT_EQ(context->allocated_bytes(), before) << size / kMiB << " MiB were kept";
    }
}

TEST_F(Memory, HostMemoryIsMappedAndApartFromDeviceMemory) {
    const auto host = allocate(1000, 64, MemoryKind::Host);
    const auto device = allocate(1000, 64, MemoryKind::Device);
    ASSERT_NE(host.mapped, nullptr);
    EXPECT_EQ(device.mapped, nullptr);
    EXPECT_NE(host.memory, device.memory);
    host.mapped[999] = std::byte{7};
    context->release(host);
    context->release(device);
}

TEST_F(Memory, BuffersMoveAndGiveTheirMemoryBack) {
    const auto before = context->allocated_bytes();
    {
        Buffer a(*context, 40 * kMiB, MemoryKind::Device, "a");
        Buffer b(std::move(a));
        EXPECT_EQ(b.bytes(), 40 * kMiB);
        a = Buffer(*context, 48 * kMiB, MemoryKind::Device, "another");
        b = std::move(a);
        EXPECT_EQ(b.bytes(), 48 * kMiB);
    }
    EXPECT_EQ(context->allocated_bytes(), before);
}

TEST_F(Memory, ExhaustionIsAnErrorInOneLineAndLeavesTheContextUsable) {
    try {
        const auto impossible = allocate(VkDeviceSize{1} << 50);
        context->release(impossible);
        FAIL() << "a petabyte was granted";
    } catch (const Error& error) {
        const std::string message = error.what();
        EXPECT_EQ(message.find('\n'), std::string::npos);
        EXPECT_NE(message.find("out of memory"), std::string::npos) << message;
        EXPECT_NE(message.find("MiB"), std::string::npos) << message;
    }
    context->release(allocate(kMiB));
}

}  // namespace
}  // namespace posefusion::test
