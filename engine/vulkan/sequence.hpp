#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "engine/vulkan/kernel.hpp"

namespace posefusion::vulkan {

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
    /// Buffers and push constants are given by the names they have in the shader (kernel_arguments.hpp); whether it
    /// reads or writes a buffer, which decides about barriers, is known from the shader.
    void dispatch(const Kernel& kernel, const NamedBuffers& buffers, const NamedValues& push_constants, Groups groups);
    void dispatch(const Kernel& kernel, const NamedBuffers& buffers, Groups groups) {
        dispatch(kernel, buffers, NamedValues{}, groups);
    }
    /// Group counts are read from DispatchArguments number `slot` of `arguments`, written by an earlier kernel.
    void dispatch_indirect(const Kernel& kernel, const NamedBuffers& buffers, const NamedValues& push_constants,
                           const Buffer& arguments, std::uint32_t slot);
    void dispatch_indirect(const Kernel& kernel, const NamedBuffers& buffers, const Buffer& arguments,
                           std::uint32_t slot) {
        dispatch_indirect(kernel, buffers, NamedValues{}, arguments, slot);
    }
    void copy(const Buffer& from, const Buffer& to, std::size_t bytes, std::size_t from_offset = 0,
              std::size_t to_offset = 0);
    void fill(const Buffer& buffer, std::uint32_t value, std::size_t bytes);

    /// Ends recording; nothing can be added afterwards.
    void finish();
    /// Runs the sequence and waits for it. May be repeated.
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
    /// How a command uses a buffer.
    struct Use {
        const Buffer* buffer;
        bool reads, writes;
    };
    /// Everything that precedes a dispatch command. @param arguments  of an indirect dispatch, or nullptr
    void prepare(const Kernel& kernel, const NamedBuffers& buffers, const NamedValues& push_constants,
                 const Buffer* arguments);
    [[nodiscard]] VkDescriptorSet descriptor_set(const Kernel& kernel, std::span<const Buffer* const> buffers);
    void order(std::span<const Use> uses);
    void write_timestamp();
    void copy_timestamps();

    Context& context_;
    VkCommandPool command_pool_ = VK_NULL_HANDLE;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
    std::vector<VkDescriptorPool> descriptor_pools_;
    std::uint32_t sets_left_ = 0, descriptors_left_ = 0;  ///< in the last pool
    VkQueryPool queries_ = VK_NULL_HANDLE;
    Buffer ticks_;  ///< results of the queries: on some drivers, reading a query directly waits for the work of all
                    ///< threads
    VkFence fence_ = VK_NULL_HANDLE;
    std::vector<std::string> stages_;
    struct Access {
        bool read = false, written = false;
    };
    std::unordered_map<VkBuffer, Access> accesses_;  ///< since the last barrier
    bool finished_ = false;
};

}  // namespace posefusion::vulkan
