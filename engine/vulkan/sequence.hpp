#pragma once
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "engine/vulkan/buffer.hpp"
#include "engine/vulkan/kernel.hpp"

namespace posefusion::vulkan {

/// How a dispatch uses a buffer; the sequence places barriers from it.
struct Access {
    const Buffer* buffer;
    bool reads, writes;
};
inline Access in(const Buffer& b) { return {&b, true, false}; }
inline Access out(const Buffer& b) { return {&b, false, true}; }
inline Access inout(const Buffer& b) { return {&b, true, true}; }

/// The buffers of a dispatch, in the order of the kernel's bindings: a braced list or a vector.
struct Bindings {
    std::vector<Access> list;
    Bindings(std::initializer_list<Access> buffers) : list(buffers) {}   // NOLINT: implicit by design
    Bindings(std::vector<Access> buffers) : list(std::move(buffers)) {}  // NOLINT
};

/// Workgroups of a dispatch.
struct Groups {
    std::uint32_t x, y;
    Groups(std::uint32_t groups_x, std::uint32_t groups_y = 1)
        : x(groups_x), y(groups_y) {}  // NOLINT: implicit by design
    /// Enough groups of `size` for `items`.
    static Groups covering(std::uint32_t items, std::uint32_t size) { return {(items + size - 1) / size}; }
};

/// Commands recorded once and submitted many times. A barrier is recorded exactly where a command needs the result of
/// an earlier one (or would overwrite what an earlier one still reads); commands without such a conflict may overlap.
class Sequence {
public:
    explicit Sequence(Context& context);
    ~Sequence();
    Sequence(const Sequence&) = delete;
    Sequence& operator=(const Sequence&) = delete;

    /// Begins a timed stage; it ends where the next one begins.
    void stage(const std::string& name);
    template <class Push>
    void dispatch(const Kernel& kernel, const Bindings& buffers, const Push& push, Groups groups) {
        static_assert(std::is_trivially_copyable_v<Push>);
        dispatch_bytes(kernel, buffers.list, std::as_bytes(std::span(&push, 1)), groups, nullptr, 0);
    }
    void dispatch(const Kernel& kernel, const Bindings& buffers, Groups groups) {
        dispatch_bytes(kernel, buffers.list, {}, groups, nullptr, 0);
    }
    /// Group counts come from DispatchArguments number `slot` of `arguments`, written by an earlier kernel.
    template <class Push>
    void dispatch_indirect(const Kernel& kernel, const Bindings& buffers, const Push& push, const Buffer& arguments,
                           std::uint32_t slot) {
        dispatch_bytes(kernel, buffers.list, std::as_bytes(std::span(&push, 1)), 0, &arguments, slot);
    }
    void dispatch_indirect(const Kernel& kernel, const Bindings& buffers, const Buffer& arguments, std::uint32_t slot) {
        dispatch_bytes(kernel, buffers.list, {}, 0, &arguments, slot);
    }
    void copy(const Buffer& from, const Buffer& to, std::size_t bytes, std::size_t from_offset = 0,
              std::size_t to_offset = 0);
    void fill(const Buffer& buffer, std::uint32_t value, std::size_t bytes);

    /// Ends recording; nothing can be added afterwards.
    void finish();
    /// Runs everything and waits. May be repeated.
    void run();

    struct Time {
        std::string stage;
        double milliseconds;
    };
    /// Device time of each stage of the last run.
    [[nodiscard]] std::vector<Time> times() const;

private:
    void create();
    void destroy();
    void dispatch_bytes(const Kernel& kernel, std::span<const Access> buffers, std::span<const std::byte> push,
                        Groups groups, const Buffer* arguments, std::uint32_t slot);
    void write_timestamp();
    void copy_timestamps();
    void order(std::span<const Access> accesses);
    [[nodiscard]] VkDescriptorSet descriptor_set(const Kernel& kernel, std::span<const Access> buffers);

    Context& context_;
    VkCommandPool command_pool_ = VK_NULL_HANDLE;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
    std::vector<VkDescriptorPool> descriptor_pools_;
    std::uint32_t sets_left_ = 0;
    VkQueryPool queries_ = VK_NULL_HANDLE;
    Buffer ticks_;  ///< what the queries gave; some drivers wait for all work of all threads when asked for a query
    VkFence fence_ = VK_NULL_HANDLE;
    std::vector<std::string> stages_;
    struct Use {
        bool read = false, written = false;
    };
    std::unordered_map<VkBuffer, Use> uses_;  ///< since the last barrier
    bool finished_ = false;
};

}  // namespace posefusion::vulkan
