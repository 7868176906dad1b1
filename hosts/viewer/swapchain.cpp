#include "hosts/viewer/swapchain.hpp"

#include <algorithm>
#include <array>

#include "engine/core/error.hpp"

namespace posefusion {

using vulkan::check;

namespace {

constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;  // every device has it
constexpr std::uint32_t kWantedImages = 3;               // one shown, one waiting, one being drawn
constexpr std::uint64_t kPatience = 100'000'000;         // nanoseconds; covered windows may get no image

VkImageView make_view(VkDevice device, VkImage image, VkFormat format, VkImageAspectFlags aspect) {
    VkImageViewCreateInfo create{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    create.image = image;
    create.viewType = VK_IMAGE_VIEW_TYPE_2D;
    create.format = format;
    create.subresourceRange = {aspect, 0, 1, 0, 1};
    VkImageView view = VK_NULL_HANDLE;
    check(vkCreateImageView(device, &create, nullptr, &view), "vkCreateImageView");
    return view;
}

/// The first allowed device-local memory type; Vulkan guarantees one for images.
std::uint32_t device_memory_type(VkPhysicalDevice device, std::uint32_t allowed) {
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(device, &memory);
    std::uint32_t type = 0;
    while (type + 1 < memory.memoryTypeCount &&
           ((allowed & (1u << type)) == 0 ||
            (memory.memoryTypes[type].propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) == 0)) {
        ++type;
    }
    return type;
}

}  // namespace

Swapchain::Swapchain(vulkan::Context& context, const Window& window)
    : context_(context), surface_(window.create_surface(context.instance())) {
    try {
        VkBool32 shows = VK_FALSE;
        check(vkGetPhysicalDeviceSurfaceSupportKHR(context.physical_device(), context.queue_family(), surface_, &shows),
              "vkGetPhysicalDeviceSurfaceSupportKHR");
        if (shows != VK_TRUE) {
            throw Error("device '" + context.info().name +
                        "' cannot show images on this display; choose another with --device");
        }
        choose_format();
        make_pass();
        resize(window.size());
    } catch (...) {
        destroy();
        throw;
    }
}

Swapchain::~Swapchain() { destroy(); }

void Swapchain::choose_format() {
    std::uint32_t count = 0;
    check(vkGetPhysicalDeviceSurfaceFormatsKHR(context_.physical_device(), surface_, &count, nullptr),
          "vkGetPhysicalDeviceSurfaceFormatsKHR");
    std::vector<VkSurfaceFormatKHR> formats(count);
    check(vkGetPhysicalDeviceSurfaceFormatsKHR(context_.physical_device(), surface_, &count, formats.data()),
          "vkGetPhysicalDeviceSurfaceFormatsKHR");
    // the map's colours are sRGB bytes and are shown as they are
    for (const VkFormat wanted : {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM}) {
        for (const VkSurfaceFormatKHR& format : formats) {
            if (format.format != wanted) continue;
            format_ = format;
            blue_first_ = wanted == VK_FORMAT_B8G8R8A8_UNORM;
            return;
        }
    }
    throw Error("this display takes no images of 8 bits per channel; use another display or `posefusion run`");
}

void Swapchain::make_pass() {
    std::array<VkAttachmentDescription, 2> attachments{};
    attachments[0].format = format_.format;
    attachments[0].storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    attachments[0].finalLayout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR;
    attachments[1].format = kDepthFormat;
    attachments[1].storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    attachments[1].finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    for (auto& attachment : attachments) {
        attachment.samples = VK_SAMPLE_COUNT_1_BIT;
        attachment.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
        attachment.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
        attachment.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
        attachment.initialLayout = VK_IMAGE_LAYOUT_UNDEFINED;
    }
    const VkAttachmentReference color{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    const VkAttachmentReference depth{1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
    VkSubpassDescription subpass{};
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.colorAttachmentCount = 1;
    subpass.pColorAttachments = &color;
    subpass.pDepthStencilAttachment = &depth;

    // Before: the last frame's use of the depth buffer, and the semaphore of acquire(), which is waited for at colour
    // output. After: the copy of a screenshot.
    constexpr VkPipelineStageFlags kDepthTests =
        VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
    std::array<VkSubpassDependency, 2> dependencies{};
    dependencies[0].srcSubpass = VK_SUBPASS_EXTERNAL;
    dependencies[0].dstSubpass = 0;
    dependencies[0].srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | kDepthTests;
    dependencies[0].dstStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | kDepthTests;
    dependencies[0].srcAccessMask = VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
    dependencies[0].dstAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_COLOR_ATTACHMENT_READ_BIT |
                                    VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
                                    VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
    dependencies[1].srcSubpass = 0;
    dependencies[1].dstSubpass = VK_SUBPASS_EXTERNAL;
    dependencies[1].srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
    dependencies[1].dstStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT;
    dependencies[1].srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
    dependencies[1].dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT;

    VkRenderPassCreateInfo create{VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO};
    create.attachmentCount = static_cast<std::uint32_t>(attachments.size());
    create.pAttachments = attachments.data();
    create.subpassCount = 1;
    create.pSubpasses = &subpass;
    create.dependencyCount = static_cast<std::uint32_t>(dependencies.size());
    create.pDependencies = dependencies.data();
    check(vkCreateRenderPass(context_.device(), &create, nullptr, &pass_), "vkCreateRenderPass");
}

void Swapchain::resize(WindowSize size) {
    VkSurfaceCapabilitiesKHR can;
    check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(context_.physical_device(), surface_, &can),
          "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
    const bool follows_images = can.currentExtent.width == UINT32_MAX;
    const VkExtent2D wanted =
        follows_images ? VkExtent2D{static_cast<std::uint32_t>(size.width), static_cast<std::uint32_t>(size.height)}
                       : can.currentExtent;
    extent_ = {std::clamp(wanted.width, can.minImageExtent.width, can.maxImageExtent.width),
               std::clamp(wanted.height, can.minImageExtent.height, can.maxImageExtent.height)};
    can_be_copied_ = (can.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_SRC_BIT) != 0;

    destroy_targets();
    VkSwapchainCreateInfoKHR create{VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
    create.surface = surface_;
    create.minImageCount = std::max(kWantedImages, can.minImageCount);
    if (can.maxImageCount > 0) create.minImageCount = std::min(create.minImageCount, can.maxImageCount);
    create.imageFormat = format_.format;
    create.imageColorSpace = format_.colorSpace;
    create.imageExtent = extent_;
    create.imageArrayLayers = 1;
    create.imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    if (can_be_copied_) create.imageUsage |= VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    create.imageSharingMode = VK_SHARING_MODE_EXCLUSIVE;
    create.preTransform = can.currentTransform;
    create.compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
    create.presentMode = VK_PRESENT_MODE_FIFO_KHR;  // every display has it; never tears
    create.clipped = VK_TRUE;
    create.oldSwapchain = swapchain_;
    VkSwapchainKHR made = VK_NULL_HANDLE;
    check(vkCreateSwapchainKHR(context_.device(), &create, nullptr, &made), "vkCreateSwapchainKHR");
    if (swapchain_) vkDestroySwapchainKHR(context_.device(), swapchain_, nullptr);
    swapchain_ = made;
    make_depth();
    make_targets();
    outdated_ = false;
}

void Swapchain::make_depth() {
    const VkDevice device = context_.device();
    VkImageCreateInfo create{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    create.imageType = VK_IMAGE_TYPE_2D;
    create.format = kDepthFormat;
    create.extent = {extent_.width, extent_.height, 1};
    create.mipLevels = create.arrayLayers = 1;
    create.samples = VK_SAMPLE_COUNT_1_BIT;
    create.tiling = VK_IMAGE_TILING_OPTIMAL;
    create.usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    check(vkCreateImage(device, &create, nullptr, &depth_), "vkCreateImage");
    VkMemoryRequirements requirements;
    vkGetImageMemoryRequirements(device, depth_, &requirements);
    VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    allocate.allocationSize = requirements.size;
    allocate.memoryTypeIndex = device_memory_type(context_.physical_device(), requirements.memoryTypeBits);
    check(vkAllocateMemory(device, &allocate, nullptr, &depth_memory_), "vkAllocateMemory");
    check(vkBindImageMemory(device, depth_, depth_memory_, 0), "vkBindImageMemory");
    depth_view_ = make_view(device, depth_, kDepthFormat, VK_IMAGE_ASPECT_DEPTH_BIT);
}

void Swapchain::make_targets() {
    const VkDevice device = context_.device();
    std::uint32_t count = 0;
    check(vkGetSwapchainImagesKHR(device, swapchain_, &count, nullptr), "vkGetSwapchainImagesKHR");
    std::vector<VkImage> images(count);
    check(vkGetSwapchainImagesKHR(device, swapchain_, &count, images.data()), "vkGetSwapchainImagesKHR");
    for (const VkImage image : images) {
        Target& target = targets_.emplace_back();
        target.image = image;
        target.view = make_view(device, image, format_.format, VK_IMAGE_ASPECT_COLOR_BIT);
        const VkImageView views[] = {target.view, depth_view_};
        VkFramebufferCreateInfo create{VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO};
        create.renderPass = pass_;
        create.attachmentCount = 2;
        create.pAttachments = views;
        create.width = extent_.width;
        create.height = extent_.height;
        create.layers = 1;
        check(vkCreateFramebuffer(device, &create, nullptr, &target.framebuffer), "vkCreateFramebuffer");
        const VkSemaphoreCreateInfo semaphore{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
        check(vkCreateSemaphore(device, &semaphore, nullptr, &target.finished), "vkCreateSemaphore");
    }
}

void Swapchain::destroy_targets() {
    const VkDevice device = context_.device();
    for (const Target& target : targets_) {
        vkDestroyFramebuffer(device, target.framebuffer, nullptr);
        vkDestroyImageView(device, target.view, nullptr);
        vkDestroySemaphore(device, target.finished, nullptr);
    }
    targets_.clear();
    vkDestroyImageView(device, depth_view_, nullptr);
    vkDestroyImage(device, depth_, nullptr);
    vkFreeMemory(device, depth_memory_, nullptr);
    depth_view_ = VK_NULL_HANDLE;
    depth_ = VK_NULL_HANDLE;
    depth_memory_ = VK_NULL_HANDLE;
}

void Swapchain::destroy() {
    destroy_targets();
    vkDestroySwapchainKHR(context_.device(), swapchain_, nullptr);
    vkDestroyRenderPass(context_.device(), pass_, nullptr);
    vkDestroySurfaceKHR(context_.instance(), surface_, nullptr);
}

std::optional<std::uint32_t> Swapchain::acquire(VkSemaphore available) {
    std::uint32_t image = 0;
    const VkResult result =
        vkAcquireNextImageKHR(context_.device(), swapchain_, kPatience, available, VK_NULL_HANDLE, &image);
    outdated_ = result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR;
    if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_TIMEOUT || result == VK_NOT_READY) return std::nullopt;
    if (result != VK_SUBOPTIMAL_KHR) check(result, "vkAcquireNextImageKHR");
    return image;
}

void Swapchain::present(std::uint32_t image) {
    VkPresentInfoKHR present{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
    present.waitSemaphoreCount = 1;
    present.pWaitSemaphores = &targets_[image].finished;
    present.swapchainCount = 1;
    present.pSwapchains = &swapchain_;
    present.pImageIndices = &image;
    VkResult result = VK_SUCCESS;
    {
        const std::lock_guard lock(context_.renderer_queue_mutex());
        result = vkQueuePresentKHR(context_.renderer_queue(), &present);
    }
    if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR)
        outdated_ = true;
    else
        check(result, "vkQueuePresentKHR");
}

}  // namespace posefusion
