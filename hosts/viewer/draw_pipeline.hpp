#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/vulkan/buffer.hpp"

namespace posefusion {

/// How a pipeline draws.
struct DrawKind {
    std::span<const std::uint32_t> vertex_shader, fragment_shader;  ///< SPIR-V
    VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    bool depth_test = true;
    std::uint32_t buffers = 0;     ///< bindings 0..n-1 of set 0, all storage buffers
    std::uint32_t push_bytes = 0;  ///< for both shaders
    std::string name;
};

/// A graphics pipeline that takes everything from storage buffers, as the engine's kernels do, and its bindings.
class DrawPipeline {
public:
    DrawPipeline(vulkan::Context& context, VkRenderPass pass, const DrawKind& kind);
    ~DrawPipeline();
    DrawPipeline(const DrawPipeline&) = delete;
    DrawPipeline& operator=(const DrawPipeline&) = delete;

    /// The buffers of what is recorded from now on; no draw with the former ones may be in flight.
    void bind(const std::vector<const vulkan::Buffer*>& buffers);
    void draw(VkCommandBuffer commands, std::uint32_t vertices, std::span<const std::byte> push = {}) const;

private:
    void make_layouts(const DrawKind& kind);
    void make_pipeline(VkRenderPass pass, const DrawKind& kind);

    vulkan::Context& context_;
    VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
    VkDescriptorPool pool_ = VK_NULL_HANDLE;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
};

}  // namespace posefusion
