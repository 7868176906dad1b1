#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/vulkan/context.hpp"
#include "hosts/viewer/window.hpp"

namespace posefusion {

/// The images that a window shows in turn, a depth buffer, and the render pass that draws into them: it clears both and
/// leaves the image ready to be presented.
class Swapchain {
public:
    /// Throws Error if the device cannot show images in this window.
    Swapchain(vulkan::Context& context, const Window& window);
    ~Swapchain();  ///< no frame may be in flight
    Swapchain(const Swapchain&) = delete;
    Swapchain& operator=(const Swapchain&) = delete;

    /// Fits the images to the window; no frame may be in flight.
    void resize(WindowSize size);
    /// The next image to draw into, after which `available` is signalled. nullopt: there is none now, because the
    /// window has changed (outdated()) or is covered.
    [[nodiscard]] std::optional<std::uint32_t> acquire(VkSemaphore available);
    /// Presents it after finished(image).
    void present(std::uint32_t image);
    /// resize() before the next acquire().
    [[nodiscard]] bool outdated() const { return outdated_; }

    [[nodiscard]] VkRenderPass pass() const { return pass_; }
    [[nodiscard]] VkFramebuffer framebuffer(std::uint32_t image) const { return targets_[image].framebuffer; }
    [[nodiscard]] VkImage image(std::uint32_t image) const { return targets_[image].image; }
    [[nodiscard]] VkSemaphore finished(std::uint32_t image) const { return targets_[image].finished; }
    [[nodiscard]] VkExtent2D extent() const { return extent_; }
    [[nodiscard]] std::uint32_t images() const { return static_cast<std::uint32_t>(targets_.size()); }
    [[nodiscard]] bool can_be_copied() const { return can_be_copied_; }
    /// Bytes of a pixel: B, G, R, A instead of R, G, B, A.
    [[nodiscard]] bool blue_first() const { return blue_first_; }

private:
    struct Target {
        VkImage image = VK_NULL_HANDLE;
        VkImageView view = VK_NULL_HANDLE;
        VkFramebuffer framebuffer = VK_NULL_HANDLE;
        VkSemaphore finished = VK_NULL_HANDLE;
    };
    void choose_format();
    void make_pass();
    void make_depth();
    void make_targets();
    void destroy_targets();
    void destroy();

    vulkan::Context& context_;
    VkSurfaceKHR surface_ = VK_NULL_HANDLE;
    VkSurfaceFormatKHR format_{};
    VkRenderPass pass_ = VK_NULL_HANDLE;
    VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
    VkExtent2D extent_{};
    VkImage depth_ = VK_NULL_HANDLE;
    VkImageView depth_view_ = VK_NULL_HANDLE;
    VkDeviceMemory depth_memory_ = VK_NULL_HANDLE;
    std::vector<Target> targets_;
    bool can_be_copied_ = false, blue_first_ = false, outdated_ = false;
};

}  // namespace posefusion
