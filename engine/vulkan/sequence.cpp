#include "engine/vulkan/sequence.hpp"

#include <algorithm>
#include <cassert>

#include "engine/vulkan/shared_types.hpp"

namespace posefusion::vulkan {
namespace {

constexpr std::uint32_t kMaxStages = 64;
constexpr std::uint32_t kSetsPerPool = 64;
constexpr std::uint32_t kDescriptorsPerPool = 16 * kSetsPerPool;

// Vulkan 1.3, or VK_KHR_synchronization2 on 1.2 devices, where the loader exports no symbol.
PFN_vkCmdPipelineBarrier2 pipeline_barrier2(VkDevice device) {
    auto function = vkGetDeviceProcAddr(device, "vkCmdPipelineBarrier2");
    if (!function) function = vkGetDeviceProcAddr(device, "vkCmdPipelineBarrier2KHR");
    return reinterpret_cast<PFN_vkCmdPipelineBarrier2>(function);
}

void full_barrier(VkDevice device, VkCommandBuffer commands, VkPipelineStageFlags2 to_stages,
                  VkAccessFlags2 to_access) {
    VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    barrier.srcStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT |
                           VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT;
    barrier.dstStageMask = to_stages;
    barrier.dstAccessMask = to_access;
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &barrier;
    pipeline_barrier2(device)(commands, &dependency);
}

}  // namespace

Sequence::Sequence(Context& context) : context_(context) {
    try {
        create();
    } catch (...) {
        destroy();
        throw;
    }
}

Sequence::~Sequence() { destroy(); }

void Sequence::create() {
    const VkDevice device = context_.device();
    VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool.queueFamilyIndex = context_.queue_family();
    check(vkCreateCommandPool(device, &pool, nullptr, &command_pool_), "vkCreateCommandPool");
    VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocate.commandPool = command_pool_;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    check(vkAllocateCommandBuffers(device, &allocate, &commands_), "vkAllocateCommandBuffers");
    VkQueryPoolCreateInfo queries{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
    queries.queryCount = kMaxStages + 1;
    check(vkCreateQueryPool(device, &queries, nullptr, &queries_), "vkCreateQueryPool");
    VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    check(vkCreateFence(device, &fence, nullptr, &fence_), "vkCreateFence");
    VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    check(vkBeginCommandBuffer(commands_, &begin), "vkBeginCommandBuffer");
    vkCmdResetQueryPool(commands_, queries_, 0, kMaxStages + 1);
}

void Sequence::destroy() {
    const VkDevice device = context_.device();
    for (const auto pool : descriptor_pools_) vkDestroyDescriptorPool(device, pool, nullptr);
    vkDestroyFence(device, fence_, nullptr);
    vkDestroyQueryPool(device, queries_, nullptr);
    vkDestroyCommandPool(device, command_pool_, nullptr);
}

void Sequence::stage(const std::string& name) {
    assert(stages_.size() < kMaxStages);
    // a stage has ended when all its commands have: a barrier keeps the times of stages apart
    full_barrier(context_.device(), commands_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                 VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT);
    accesses_.clear();
    write_timestamp();
    stages_.push_back(name);
}

void Sequence::write_timestamp() {
    if (context_.timestamp_mask() == 0) return;  // this queue has no clock
    vkCmdWriteTimestamp(commands_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_,
                        static_cast<std::uint32_t>(stages_.size()));
}

void Sequence::copy_timestamps() {
    if (stages_.empty() || context_.timestamp_mask() == 0) return;
    const std::size_t count = stages_.size() + 1;
    ticks_ = host_buffer<std::uint64_t>(context_, count, "times");
    vkCmdCopyQueryPoolResults(commands_, queries_, 0, static_cast<std::uint32_t>(count), ticks_.handle(), 0,
                              sizeof(std::uint64_t), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
    full_barrier(context_.device(), commands_, VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
}

void Sequence::order(std::span<const Use> uses) {
    bool conflict = false;
    for (const Use& use : uses) {
        const auto found = accesses_.find(use.buffer->handle());
        if (found == accesses_.end()) continue;
        conflict = conflict || found->second.written || (found->second.read && use.writes);
    }
    if (conflict) {
        full_barrier(context_.device(), commands_,
                     VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT |
                         VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
                     VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT |
                         VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT |
                         VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT);
        accesses_.clear();
    }
    for (const Use& use : uses) {
        Access& access = accesses_[use.buffer->handle()];
        access.read = access.read || use.reads;
        access.written = access.written || use.writes;
    }
}

VkDescriptorSet Sequence::descriptor_set(const Kernel& kernel, std::span<const Buffer* const> buffers) {
    const VkDevice device = context_.device();
    const auto count = static_cast<std::uint32_t>(buffers.size());
    if (sets_left_ == 0 || descriptors_left_ < count) {
        sets_left_ = kSetsPerPool;
        descriptors_left_ = std::max(kDescriptorsPerPool, count);
        const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, descriptors_left_};
        VkDescriptorPoolCreateInfo create{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
        create.maxSets = sets_left_;
        create.poolSizeCount = 1;
        create.pPoolSizes = &size;
        VkDescriptorPool pool = VK_NULL_HANDLE;
        check(vkCreateDescriptorPool(device, &create, nullptr, &pool), "vkCreateDescriptorPool");
        descriptor_pools_.push_back(pool);
    }
    --sets_left_;
    descriptors_left_ -= count;
    const VkDescriptorSetLayout layout = kernel.set_layout();
    VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
    allocate.descriptorPool = descriptor_pools_.back();
    allocate.descriptorSetCount = 1;
    allocate.pSetLayouts = &layout;
    VkDescriptorSet set = VK_NULL_HANDLE;
    check(vkAllocateDescriptorSets(device, &allocate, &set), "vkAllocateDescriptorSets");
    bind_buffers(context_, set, buffers);
    return set;
}

void Sequence::prepare(const Kernel& kernel, const NamedBuffers& buffers, const NamedValues& push_constants,
                       const Buffer* arguments) {
    assert(!finished_);
    const Shader& shader = kernel.shader();
    const auto bound = in_order(kernel.name(), buffers, shader.buffers);
    const auto values = in_order(kernel.name(), "push constant", push_constants, shader.push_constants);
    std::vector<Use> uses;
    for (std::size_t i = 0; i < bound.size(); ++i) {
        uses.push_back({bound[i], shader.buffers[i].reads, shader.buffers[i].writes});
    }
    if (arguments) uses.push_back({arguments, true, false});
    order(uses);
    vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.pipeline());
    const VkDescriptorSet set = descriptor_set(kernel, bound);
    vkCmdBindDescriptorSets(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.layout(), 0, 1, &set, 0, nullptr);
    for (std::size_t i = 0; i < values.size(); ++i) {
        vkCmdPushConstants(commands_, kernel.layout(), VK_SHADER_STAGE_COMPUTE_BIT, shader.push_constants[i].place,
                           sizeof(std::uint32_t), &values[i]);
    }
}

void Sequence::dispatch(const Kernel& kernel, const NamedBuffers& buffers, const NamedValues& push_constants,
                        Groups groups) {
    prepare(kernel, buffers, push_constants, nullptr);
    vkCmdDispatch(commands_, groups.x, groups.y, 1);
}

void Sequence::dispatch_indirect(const Kernel& kernel, const NamedBuffers& buffers, const NamedValues& push_constants,
                                 const Buffer& arguments, std::uint32_t slot) {
    prepare(kernel, buffers, push_constants, &arguments);
    vkCmdDispatchIndirect(commands_, arguments.handle(), slot * sizeof(gpu::DispatchArguments));
}

void Sequence::copy(const Buffer& from, const Buffer& to, std::size_t bytes, std::size_t from_offset,
                    std::size_t to_offset) {
    const Use uses[] = {{&from, true, false}, {&to, false, true}};
    order(uses);
    const VkBufferCopy region{from_offset, to_offset, bytes};
    vkCmdCopyBuffer(commands_, from.handle(), to.handle(), 1, &region);
}

void Sequence::fill(const Buffer& buffer, std::uint32_t value, std::size_t bytes) {
    const Use uses[] = {{&buffer, false, true}};
    order(uses);
    vkCmdFillBuffer(commands_, buffer.handle(), 0, bytes, value);
}

void Sequence::finish() {
    // results are read by the host after the fence
    full_barrier(context_.device(), commands_, VK_PIPELINE_STAGE_2_HOST_BIT | VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                 VK_ACCESS_2_HOST_READ_BIT | VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT);
    write_timestamp();
    copy_timestamps();
    check(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
    finished_ = true;
}

void Sequence::run() {
    assert(finished_);
    VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands_;
    {
        const std::lock_guard lock(context_.queue_mutex());
        check(vkQueueSubmit(context_.queue(), 1, &submit, fence_), "vkQueueSubmit");
    }
    check(vkWaitForFences(context_.device(), 1, &fence_, VK_TRUE, UINT64_MAX), "vkWaitForFences");
    check(vkResetFences(context_.device(), 1, &fence_), "vkResetFences");
}

std::vector<Sequence::Time> Sequence::times() const {
    if (ticks_.bytes() == 0) return {};
    const auto ticks = ticks_.host<std::uint64_t>();
    std::vector<Time> times;
    for (std::size_t i = 0; i < stages_.size(); ++i) {
        const std::uint64_t elapsed = (ticks[i + 1] - ticks[i]) & context_.timestamp_mask();
        times.push_back({stages_[i], static_cast<double>(elapsed) * context_.timestamp_period_ns() * 1e-6});
    }
    return times;
}

}  // namespace posefusion::vulkan
