#pragma once
#include "engine/vulkan/context.hpp"
#include "hosts/viewer/window.hpp"

namespace posefusion {

/// Dear ImGui in a window, from construction to destruction. One at a time.
class Gui {
public:
    /// @param images  of the swapchain
    Gui(vulkan::Context& context, const Window& window, VkRenderPass pass, std::uint32_t images);
    ~Gui();  ///< nothing may be in flight
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    /// Between the two, ImGui's calls say what is shown.
    void begin();
    void end();
    /// Inside of the pass.
    void enqueue(VkCommandBuffer commands);

private:
    vulkan::Context& context_;
    VkDescriptorPool pool_ = VK_NULL_HANDLE;
};

}  // namespace posefusion
