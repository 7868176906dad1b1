#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "engine/vulkan/kernel_arguments.hpp"

namespace posefusion {

/// The fixed state of a graphics pipeline.
struct DrawKind {
    std::string name;  ///< for errors and debuggers
    vulkan::Shader vertex_shader, fragment_shader;
    VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    bool depth_test = true;
};

/// A graphics pipeline whose input comes from storage buffers, as with the engine's kernels. Its arguments are known
/// from its shaders; see engine/vulkan/kernel_arguments.hpp for the errors.
class DrawPipeline {
public:
    DrawPipeline(vulkan::Context& context, VkRenderPass pass, const DrawKind& kind);
    ~DrawPipeline();
    DrawPipeline(const DrawPipeline&) = delete;
    DrawPipeline& operator=(const DrawPipeline&) = delete;

    /// Sets the buffers for the following draws, by their names in the shaders: all buffers of both shaders, each once.
    /// No draw with the previous ones may be in flight.
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
    std::array<vulkan::Shader, 2> shaders_;               ///< vertex, fragment; each has its own descriptor set
    std::array<VkDescriptorSetLayout, 2> set_layouts_{};  ///< of these
    std::array<VkDescriptorSet, 2> sets_{};
    VkDescriptorPool pool_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
};

}  // namespace posefusion
