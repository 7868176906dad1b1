#pragma once
#include <functional>
#include <optional>

#include "engine/core/image.hpp"
#include "engine/vulkan/buffer.hpp"
#include "hosts/viewer/swapchain.hpp"

namespace posefusion {

/// Draws one frame of the window after the other, at most one in flight.
class FrameDrawer {
public:
    FrameDrawer(vulkan::Context& context, const Window& window);
    ~FrameDrawer();
    FrameDrawer(const FrameDrawer&) = delete;
    FrameDrawer& operator=(const FrameDrawer&) = delete;

    /// Waits until the device has finished the last frame, so that its inputs may be changed.
    void wait();
    /// After wait(): records, submits and presents a frame. @param record  called inside of the render pass
    /// @return false: nothing was drawn because the window changed its size or is minimised; try again
    bool draw(WindowSize size, const std::function<void(VkCommandBuffer)>& record, bool with_screenshot = false);
    /// The screenshot of the last frame, if it was drawn with one; waits for it. nullopt: this display does not allow
    /// reading its images.
    [[nodiscard]] std::optional<ColorImage> screenshot();

    [[nodiscard]] VkRenderPass pass() const { return swapchain_.pass(); }
    [[nodiscard]] std::uint32_t images() const { return swapchain_.images(); }
    [[nodiscard]] std::uint64_t frames() const { return frames_; }  ///< drawn so far
    /// Device time of the last frame that is known to be finished, milliseconds.
    [[nodiscard]] double device_ms() const { return device_ms_; }

private:
    void enqueue_screenshot(VkImage image);
    void read_time();

    vulkan::Context& context_;
    Swapchain swapchain_;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
    VkQueryPool queries_ = VK_NULL_HANDLE;
    VkSemaphore available_ = VK_NULL_HANDLE;
    VkFence done_ = VK_NULL_HANDLE;
    bool in_flight_ = false;
    WindowSize size_;
    std::uint64_t frames_ = 0;
    double device_ms_ = 0;
    vulkan::Buffer screenshot_;
    std::optional<VkExtent2D> screenshot_size_;
};

}  // namespace posefusion
