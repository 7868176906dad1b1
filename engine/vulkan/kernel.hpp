#pragma once
#include <cstdint>
#include <string>

#include "engine/vulkan/kernel_arguments.hpp"

namespace posefusion::vulkan {

/// The number of groups of `size` needed for `items`, rounded up.
[[nodiscard]] constexpr std::uint32_t ceil_div(std::uint32_t items, std::uint32_t size) {
    return (items + size - 1) / size;
}

/// Workgroups of a dispatch.
struct Groups {
    std::uint32_t x, y;
    Groups(std::uint32_t groups_x, std::uint32_t groups_y = 1) : x(groups_x), y(groups_y) {}  // NOLINT: implicit
};

/// A compute pipeline. Its arguments are known from the shader by reflection; see kernel_arguments.hpp for the errors.
class Kernel {
public:
    /// @param shader     name as in shader_named()
    /// @param constants  values of all of the shader's specialisation constants
    Kernel(Context& context, const std::string& shader, const NamedValues& constants = {});
    /// The same for a shader that is not in the table.
    Kernel(Context& context, const std::string& name, const Shader& shader, const NamedValues& constants = {});
    ~Kernel();
    Kernel(const Kernel&) = delete;
    Kernel& operator=(const Kernel&) = delete;

    /// Enough workgroups for this many invocations along x and y.
    [[nodiscard]] Groups groups_for(std::uint32_t x, std::uint32_t y = 1) const;
    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] const Shader& shader() const { return shader_; }
    [[nodiscard]] std::uint32_t push_bytes() const;
    [[nodiscard]] VkPipeline pipeline() const { return pipeline_; }
    [[nodiscard]] VkPipelineLayout layout() const { return layout_; }
    [[nodiscard]] VkDescriptorSetLayout set_layout() const { return set_layout_; }

private:
    void create(const NamedValues& constants);
    void create_layouts();
    void destroy();

    Context& context_;
    std::string name_;
    Shader shader_;
    VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
};

}  // namespace posefusion::vulkan
