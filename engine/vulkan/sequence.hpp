#pragma once
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "engine/vulkan/kernel.hpp"

namespace posefusion::vulkan {

// Until map/ and loops/ use names: buffers in the order of the shader's declarations.
struct Access {
    const Buffer* buffer;
};
inline Access in(const Buffer& b) { return {&b}; }
inline Access out(const Buffer& b) { return {&b}; }
inline Access inout(const Buffer& b) { return {&b}; }
struct Bindings {
    std::vector<Access> list;
    Bindings(std::initializer_list<Access> buffers) : list(buffers) {}   // NOLINT: implicit by design
    Bindings(std::vector<Access> buffers) : list(std::move(buffers)) {}  // NOLINT
    [[nodiscard]] NamedBuffers named(const Shader& shader) const {
        NamedBuffers result;
        for (std::size_t i = 0; i < list.size(); ++i)
            result.emplace_back(i < shader.buffers.size() ? shader.buffers[i].name.data() : "more", *list[i].buffer);
        return result;
    }
};
template <class Push>
NamedValues named_push(const Shader& shader, const Push& push) {
    NamedValues values;
    for (const ShaderValue& value : shader.push_constants) {
        values.emplace_back(value.name.data(), 0);
        values.back().kind = value.kind;
        std::memcpy(&values.back().bits, reinterpret_cast<const std::byte*>(&push) + value.place, 4);
    }
    return values;
}

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
    /// Group counts come from DispatchArguments number `slot` of `arguments`, written by an earlier kernel.
    void dispatch_indirect(const Kernel& kernel, const NamedBuffers& buffers, const NamedValues& push_constants,
                           const Buffer& arguments, std::uint32_t slot);
    void dispatch_indirect(const Kernel& kernel, const NamedBuffers& buffers, const Buffer& arguments,
                           std::uint32_t slot) {
        dispatch_indirect(kernel, buffers, NamedValues{}, arguments, slot);
    }
    template <class Push>
    void dispatch(const Kernel& kernel, const Bindings& buffers, const Push& push, Groups groups) {
        dispatch(kernel, buffers.named(kernel.shader()), named_push(kernel.shader(), push), groups);
    }
    void dispatch(const Kernel& kernel, const Bindings& buffers, Groups groups) {
        dispatch(kernel, buffers.named(kernel.shader()), NamedValues{}, groups);
    }
    template <class Push>
    void dispatch_indirect(const Kernel& kernel, const Bindings& buffers, const Push& push, const Buffer& arguments,
                           std::uint32_t slot) {
        dispatch_indirect(kernel, buffers.named(kernel.shader()), named_push(kernel.shader(), push), arguments, slot);
    }
    void dispatch_indirect(const Kernel& kernel, const Bindings& buffers, const Buffer& arguments, std::uint32_t slot) {
        dispatch_indirect(kernel, buffers.named(kernel.shader()), NamedValues{}, arguments, slot);
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
    /// How a command uses a buffer.
    struct Use {
        const Buffer* buffer;
        bool reads, writes;
    };
    /// All that a dispatch needs but the dispatch itself. @param arguments  of an indirect one, or nullptr
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
    Buffer ticks_;  ///< what the queries gave; some drivers wait for all work of all threads when asked for a query
    VkFence fence_ = VK_NULL_HANDLE;
    std::vector<std::string> stages_;
    struct Access {
        bool read = false, written = false;
    };
    std::unordered_map<VkBuffer, Access> accesses_;  ///< since the last barrier
    bool finished_ = false;
};

}  // namespace posefusion::vulkan
