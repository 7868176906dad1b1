#pragma once
#include <span>
#include <string>

#include "engine/vulkan/context.hpp"

namespace posefusion::vulkan {

/// Storage memory, owned. Device buffers are for kernels and copies; host buffers can also be read and written here.
class Buffer {
public:
    Buffer() = default;
    Buffer(Context& context, std::size_t bytes, MemoryKind kind, const std::string& name);
    ~Buffer();
    Buffer(Buffer&& other) noexcept;
    Buffer& operator=(Buffer&& other) noexcept;

    [[nodiscard]] VkBuffer handle() const { return buffer_; }
    [[nodiscard]] std::size_t bytes() const { return bytes_; }
    /// Host buffers only: the memory as an array of T.
    template <class T>
    [[nodiscard]] std::span<T> host() const {
        return {reinterpret_cast<T*>(allocation_.mapped), bytes_ / sizeof(T)};
    }

private:
    Context* context_ = nullptr;
    VkBuffer buffer_ = VK_NULL_HANDLE;
    Allocation allocation_;
    std::size_t bytes_ = 0;
};

/// Writes whole buffers to bindings 0, 1, ... of a descriptor set.
void bind_buffers(const Context& context, VkDescriptorSet set, std::span<const Buffer* const> buffers);

template <class T>
Buffer device_buffer(Context& context, std::size_t count, const std::string& name) {
    return Buffer(context, count * sizeof(T), MemoryKind::Device, name);
}
template <class T>
Buffer host_buffer(Context& context, std::size_t count, const std::string& name) {
    return Buffer(context, count * sizeof(T), MemoryKind::Host, name);
}

}  // namespace posefusion::vulkan
