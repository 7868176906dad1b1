#pragma once
#include "engine/vulkan/context.hpp"
#include "hosts/viewer/window.hpp"

namespace posefusion {

/// Dear ImGui in a window, from construction to destruction. One at a time.
class Gui {
public:
    /// @param images  of the swapchain
    Gui(vulkan::Context& context, const Window& window, VkRenderPass pass, std::uint32_t images);
    ~Gui();  ///< no frame may be in flight
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    /// Calls of ImGui between the two define the panels.
    void begin();
    void end();
    /// Called inside of the render pass.
    void enqueue(VkCommandBuffer commands);

private:
    vulkan::Context& context_;
    VkDescriptorPool pool_ = VK_NULL_HANDLE;
};

}  // namespace posefusion
