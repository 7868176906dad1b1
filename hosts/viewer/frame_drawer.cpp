#include "hosts/viewer/frame_drawer.hpp"

#include <array>

namespace posefusion {

using vulkan::check;

namespace {

constexpr VkClearColorValue kBackground{{0.09f, 0.10f, 0.12f, 1.0f}};
constexpr std::size_t kBytesPerPixel = 4;

}  // namespace

FrameDrawer::FrameDrawer(vulkan::Context& context, const Window& window)
    : context_(context), swapchain_(context, window), size_(window.size()) {
    const VkDevice device = context.device();
    VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
    pool.queueFamilyIndex = context.queue_family();
    check(vkCreateCommandPool(device, &pool, nullptr, &pool_), "vkCreateCommandPool");
    VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocate.commandPool = pool_;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    check(vkAllocateCommandBuffers(device, &allocate, &commands_), "vkAllocateCommandBuffers");
    VkQueryPoolCreateInfo queries{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
    queries.queryCount = 2;
    check(vkCreateQueryPool(device, &queries, nullptr, &queries_), "vkCreateQueryPool");
    const VkSemaphoreCreateInfo semaphore{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    check(vkCreateSemaphore(device, &semaphore, nullptr, &available_), "vkCreateSemaphore");
    const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    check(vkCreateFence(device, &fence, nullptr, &done_), "vkCreateFence");
}

FrameDrawer::~FrameDrawer() {
    const VkDevice device = context_.device();
    {
        // presentation has no fence
        const std::lock_guard lock(context_.renderer_queue_mutex());
        vkQueueWaitIdle(context_.renderer_queue());
    }
    vkDestroyFence(device, done_, nullptr);
    vkDestroySemaphore(device, available_, nullptr);
    vkDestroyQueryPool(device, queries_, nullptr);
    vkDestroyCommandPool(device, pool_, nullptr);
}

void FrameDrawer::wait() {
    if (!in_flight_) return;
    check(vkWaitForFences(context_.device(), 1, &done_, VK_TRUE, UINT64_MAX), "vkWaitForFences");
    check(vkResetFences(context_.device(), 1, &done_), "vkResetFences");
    in_flight_ = false;
    read_time();
}

void FrameDrawer::read_time() {
    if (context_.timestamp_mask() == 0) return;
    std::array<std::uint64_t, 2> ticks{};
    check(vkGetQueryPoolResults(context_.device(), queries_, 0, 2, sizeof(ticks), ticks.data(), sizeof(ticks[0]),
                                VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
          "vkGetQueryPoolResults");
    const std::uint64_t elapsed = (ticks[1] - ticks[0]) & context_.timestamp_mask();
    device_ms_ = static_cast<double>(elapsed) * context_.timestamp_period_ns() * 1e-6;
}

bool FrameDrawer::draw(WindowSize size, const std::function<void(VkCommandBuffer)>& record, bool with_screenshot) {
    if (size.width <= 0 || size.height <= 0) return false;
    if (swapchain_.outdated() || size != size_) {
        {
            const std::lock_guard lock(context_.renderer_queue_mutex());
            check(vkQueueWaitIdle(context_.renderer_queue()), "vkQueueWaitIdle");
        }
        swapchain_.resize(size);
        size_ = size;
    }
    const std::optional<std::uint32_t> image = swapchain_.acquire(available_);
    if (!image) return false;

    VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    check(vkBeginCommandBuffer(commands_, &begin), "vkBeginCommandBuffer");
    vkCmdResetQueryPool(commands_, queries_, 0, 2);
    // snapshots are written by the engine's copy commands
    VkMemoryBarrier written{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
    written.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    written.dstAccessMask = VK_ACCESS_SHADER_READ_BIT;
    vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_TRANSFER_BIT,
                         VK_PIPELINE_STAGE_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT, 0, 1, &written, 0,
                         nullptr, 0, nullptr);
    vkCmdWriteTimestamp(commands_, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, queries_, 0);
    std::array<VkClearValue, 2> clear{};
    clear[0].color = kBackground;
    clear[1].depthStencil = {0, 0};  // infinitely far
    VkRenderPassBeginInfo pass{VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO};
    pass.renderPass = swapchain_.pass();
    pass.framebuffer = swapchain_.framebuffer(*image);
    pass.renderArea.extent = swapchain_.extent();
    pass.clearValueCount = static_cast<std::uint32_t>(clear.size());
    pass.pClearValues = clear.data();
    vkCmdBeginRenderPass(commands_, &pass, VK_SUBPASS_CONTENTS_INLINE);
    record(commands_);
    vkCmdEndRenderPass(commands_);
    screenshot_size_.reset();
    if (with_screenshot && swapchain_.can_be_copied()) enqueue_screenshot(swapchain_.image(*image));
    vkCmdWriteTimestamp(commands_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_, 1);
    check(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");

    const VkPipelineStageFlags wait_at = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
    const VkSemaphore finished = swapchain_.finished(*image);
    VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
    submit.waitSemaphoreCount = 1;
    submit.pWaitSemaphores = &available_;
    submit.pWaitDstStageMask = &wait_at;
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands_;
    submit.signalSemaphoreCount = 1;
    submit.pSignalSemaphores = &finished;
    {
        const std::lock_guard lock(context_.renderer_queue_mutex());
        check(vkQueueSubmit(context_.renderer_queue(), 1, &submit, done_), "vkQueueSubmit");
    }
    in_flight_ = true;
    swapchain_.present(*image);
    ++frames_;
    return true;
}

void FrameDrawer::enqueue_screenshot(VkImage image) {
    const VkExtent2D size = swapchain_.extent();
    const std::size_t bytes = std::size_t{size.width} * size.height * kBytesPerPixel;
    if (screenshot_.bytes() < bytes) {
        screenshot_ = vulkan::Buffer(context_, bytes, vulkan::MemoryKind::Host, "screenshot");
    }
    VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    barrier.oldLayout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR;
    barrier.newLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    barrier.srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT;
    vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
                         VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, nullptr, 0, nullptr, 1, &barrier);
    VkBufferImageCopy region{};
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageExtent = {size.width, size.height, 1};
    vkCmdCopyImageToBuffer(commands_, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, screenshot_.handle(), 1, &region);
    std::swap(barrier.oldLayout, barrier.newLayout);
    barrier.srcAccessMask = VK_ACCESS_TRANSFER_READ_BIT;
    barrier.dstAccessMask = 0;
    VkMemoryBarrier to_host{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
    to_host.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    to_host.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
    vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_TRANSFER_BIT,
                         VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT | VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &to_host, 0, nullptr,
                         1, &barrier);
    screenshot_size_ = size;
}

std::optional<ColorImage> FrameDrawer::screenshot() {
    if (!screenshot_size_) return std::nullopt;
    wait();
    const int width = static_cast<int>(screenshot_size_->width), height = static_cast<int>(screenshot_size_->height);
    ColorImage image(width, height);
    const auto bytes = screenshot_.host<std::uint8_t>();
    const std::size_t red = swapchain_.blue_first() ? 2 : 0;
    for (std::size_t i = 0; i < image.size(); ++i) {
        const std::uint8_t* pixel = &bytes[kBytesPerPixel * i];
        image[i] = {pixel[red], pixel[1], pixel[2 - red]};
    }
    return image;
}

}  // namespace posefusion
