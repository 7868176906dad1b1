#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "engine/vulkan/kernel_arguments.hpp"

namespace posefusion {

/// How a pipeline draws.
struct DrawKind {
    std::string name;  ///< for errors and debuggers
    vulkan::Shader vertex_shader, fragment_shader;
    VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    bool depth_test = true;
};

/// A graphics pipeline that takes everything from storage buffers, as the engine's kernels do. What it takes is known
/// from its shaders; see engine/vulkan/kernel_arguments.hpp for the errors.
class DrawPipeline {
public:
    DrawPipeline(vulkan::Context& context, VkRenderPass pass, const DrawKind& kind);
    ~DrawPipeline();
    DrawPipeline(const DrawPipeline&) = delete;
    DrawPipeline& operator=(const DrawPipeline&) = delete;

    /// The buffers of what is recorded from now on, under the names they have in the shaders: all that the two have,
    /// once even where both have it. No draw with the former ones may be in flight.
    void bind(const vulkan::NamedBuffers& buffers);
    void draw(VkCommandBuffer commands, std::uint32_t vertices, std::uint32_t instances = 1) const;

private:
    void create(VkRenderPass pass, const DrawKind& kind);
    void create_layouts();
    void allocate_sets();
    void create_pipeline(VkRenderPass pass, const DrawKind& kind);
    void destroy();

    vulkan::Context& context_;
    std::string name_;
    std::array<vulkan::Shader, 2> shaders_;               ///< vertex, fragment; each has a set of its own
    std::array<VkDescriptorSetLayout, 2> set_layouts_{};  ///< of these
    std::array<VkDescriptorSet, 2> sets_{};
    VkDescriptorPool pool_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
};

}  // namespace posefusion
