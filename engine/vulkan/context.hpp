#pragma once
#include <vulkan/vulkan.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "engine/vulkan/device_info.hpp"
#include "engine/vulkan/device_sharing.hpp"

/// The Vulkan runtime in four nouns: Context (device and its memory), Buffer (memory), Kernel (compute pipeline),
/// Sequence (recorded commands). No code above this folder sees a descriptor set, a barrier or a memory type.
namespace posefusion::vulkan {

/// Throws posefusion::Error naming the call unless result is VK_SUCCESS.
void check(VkResult result, const char* call);

struct ContextOptions {
    std::string device;               ///< part of the name (any case) or index; empty = the best usable one
    bool validation = false;          ///< core and synchronization validation; messages are counted and printed
    bool allow_int64_atomics = true;  ///< false: the two-pass 32-bit depth test even where 64-bit atomics exist
    DeviceSharing sharing;            ///< requirements of a renderer that shares this device
};

/// A piece of device memory inside a larger block.
struct Allocation {
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkDeviceSize offset = 0, size = 0;
    std::byte* mapped = nullptr;  ///< host-visible memory only
    std::uint32_t block = 0;
};

enum class MemoryKind { Device, Host };

class Context {
public:
    explicit Context(const ContextOptions& options = {});
    ~Context();
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    [[nodiscard]] VkInstance instance() const { return instance_; }
    [[nodiscard]] VkPhysicalDevice physical_device() const { return physical_; }
    [[nodiscard]] VkDevice device() const { return device_; }
    [[nodiscard]] VkQueue queue() const { return queue_; }
    /// Must be held while submitting to queue().
    [[nodiscard]] std::mutex& queue_mutex() const { return queue_mutex_; }
    /// For a renderer (ContextOptions::sharing): a second queue of the same family, so that neither waits for the
    /// other. A device with only one queue shares it (renderer_shares_queue()), with the same mutex.
    [[nodiscard]] VkQueue renderer_queue() const { return renderer_queue_; }
    [[nodiscard]] std::mutex& renderer_queue_mutex() const {
        return renderer_shares_queue() ? queue_mutex_ : renderer_queue_mutex_;
    }
    [[nodiscard]] bool renderer_shares_queue() const { return renderer_queue_ == queue_; }
    [[nodiscard]] std::uint32_t queue_family() const { return queue_family_; }
    [[nodiscard]] const DeviceInfo& info() const { return info_; }
    [[nodiscard]] bool int64_atomics() const { return int64_atomics_; }
    [[nodiscard]] double timestamp_period_ns() const { return timestamp_period_ns_; }
    [[nodiscard]] std::uint64_t timestamp_mask() const { return timestamp_mask_; }
    [[nodiscard]] std::uint32_t validation_messages() const { return validation_messages_; }
    [[nodiscard]] std::uint64_t allocated_bytes() const { return allocated_bytes_; }
    /// Largest storage buffer one kernel can see, bytes.
    [[nodiscard]] std::uint64_t max_buffer_bytes() const { return max_buffer_bytes_; }

    /// Sub-allocates; may be called, as release(), by several threads. Throws Error with sizes if the device has no
    /// memory left.
    Allocation allocate(const VkMemoryRequirements& requirements, MemoryKind kind);
    void release(const Allocation& allocation);
    void name(VkObjectType type, std::uint64_t handle, const std::string& name) const;

private:
    struct Range {
        VkDeviceSize offset, size;
    };
    struct Block {
        VkDeviceMemory memory = VK_NULL_HANDLE;
        VkDeviceSize size = 0, used = 0;
        std::uint32_t type = 0;
        std::byte* mapped = nullptr;
        bool shared = false;      ///< holds small buffers: kept when empty
        std::vector<Range> free;  ///< sorted by offset, never adjacent
    };
    static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                     VkDebugUtilsMessageTypeFlagsEXT type,
                                                     const VkDebugUtilsMessengerCallbackDataEXT* data, void* self);
    void create_instance(const ContextOptions& options);
    void create_device(const ContextOptions& options);
    void destroy();
    [[nodiscard]] std::uint32_t memory_type(std::uint32_t allowed, MemoryKind kind) const;
    void check_file_limit(VkDeviceSize size) const;
    Block& add_block(VkDeviceSize size, std::uint32_t type, MemoryKind kind);

    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE, renderer_queue_ = VK_NULL_HANDLE;
    mutable std::mutex queue_mutex_, renderer_queue_mutex_;
    std::uint32_t queue_family_ = 0;
    DeviceInfo info_;
    VkPhysicalDeviceMemoryProperties memory_properties_{};
    bool int64_atomics_ = false;
    double timestamp_period_ns_ = 1;
    std::uint64_t timestamp_mask_ = 0;
    std::uint64_t max_buffer_bytes_ = 0;
    std::atomic<std::uint64_t> allocated_bytes_ = 0;
    std::atomic<std::uint32_t> validation_messages_ = 0;
    std::mutex memory_mutex_;  ///< guards blocks_
    std::vector<Block> blocks_;
    PFN_vkSetDebugUtilsObjectNameEXT set_name_ = nullptr;
};

}  // namespace posefusion::vulkan
