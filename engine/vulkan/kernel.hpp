#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/vulkan/context.hpp"

namespace posefusion::vulkan {

/// SPIR-V of every shader, embedded at build time. Name: folder and file without ending, e.g. "map/index_map"; shaders
/// with a depth test exist a second time with the suffix ".int64".
[[nodiscard]] std::span<const std::uint32_t> shader_code(const std::string& name);

/// A compute pipeline whose bindings 0..n-1 are all storage buffers.
class Kernel {
public:
    /// @param specialisation  values of constant_id 0, 1, ... (int or uint)
    Kernel(Context& context, const std::string& shader, std::uint32_t bindings, std::uint32_t push_bytes = 0,
           const std::vector<std::uint32_t>& specialisation = {});
    ~Kernel();
    Kernel(const Kernel&) = delete;
    Kernel& operator=(const Kernel&) = delete;

    [[nodiscard]] VkPipeline pipeline() const { return pipeline_; }
    [[nodiscard]] VkPipelineLayout layout() const { return layout_; }
    [[nodiscard]] VkDescriptorSetLayout set_layout() const { return set_layout_; }
    [[nodiscard]] std::uint32_t bindings() const { return bindings_; }
    [[nodiscard]] std::uint32_t push_bytes() const { return push_bytes_; }
    [[nodiscard]] const std::string& name() const { return name_; }

private:
    void create(const std::vector<std::uint32_t>& specialisation);
    void destroy();

    Context& context_;
    std::string name_;
    std::uint32_t bindings_, push_bytes_;
    VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
};

}  // namespace posefusion::vulkan
