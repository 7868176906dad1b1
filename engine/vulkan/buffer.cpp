#include "engine/vulkan/buffer.hpp"

#include <utility>
#include <vector>

namespace posefusion::vulkan {

Buffer::Buffer(Context& context, std::size_t bytes, MemoryKind kind, const std::string& name)
    : context_(&context), bytes_(bytes) {
    VkBufferCreateInfo create{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    create.size = bytes;
    create.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                   VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT;
    create.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
    check(vkCreateBuffer(context.device(), &create, nullptr, &buffer_), "vkCreateBuffer");
    try {
        VkMemoryRequirements requirements;
        vkGetBufferMemoryRequirements(context.device(), buffer_, &requirements);
        allocation_ = context.allocate(requirements, kind);
    } catch (...) {
        vkDestroyBuffer(context.device(), buffer_, nullptr);
        throw;
    }
    check(vkBindBufferMemory(context.device(), buffer_, allocation_.memory, allocation_.offset), "vkBindBufferMemory");
    context.name(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<std::uint64_t>(buffer_), name);
}

Buffer::~Buffer() {
    if (!buffer_) return;
    vkDestroyBuffer(context_->device(), buffer_, nullptr);
    context_->release(allocation_);
}

Buffer::Buffer(Buffer&& other) noexcept
    : context_(other.context_),
      buffer_(std::exchange(other.buffer_, VK_NULL_HANDLE)),
      allocation_(other.allocation_),
      bytes_(std::exchange(other.bytes_, 0)) {}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
    std::swap(context_, other.context_);
    std::swap(buffer_, other.buffer_);
    std::swap(allocation_, other.allocation_);
    std::swap(bytes_, other.bytes_);
    return *this;
}

void bind_buffers(const Context& context, VkDescriptorSet set, std::span<const Buffer* const> buffers) {
    std::vector<VkDescriptorBufferInfo> infos;
    for (const Buffer* buffer : buffers) infos.push_back({buffer->handle(), 0, VK_WHOLE_SIZE});
    std::vector<VkWriteDescriptorSet> writes(buffers.size(), {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET});
    for (std::uint32_t i = 0; i < writes.size(); ++i) {
        writes[i].dstSet = set;
        writes[i].dstBinding = i;
        writes[i].descriptorCount = 1;
        writes[i].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        writes[i].pBufferInfo = &infos[i];
    }
    vkUpdateDescriptorSets(context.device(), static_cast<std::uint32_t>(writes.size()), writes.data(), 0, nullptr);
}

}  // namespace posefusion::vulkan
