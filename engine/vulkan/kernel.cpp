#include "engine/vulkan/kernel.hpp"

#include <algorithm>

namespace posefusion::vulkan {

Kernel::Kernel(Context& context, const std::string& shader, const NamedValues& constants)
    : Kernel(context, shader, shader_named(shader), constants) {}

Kernel::Kernel(Context& context, const std::string& name, const Shader& shader, const NamedValues& constants)
    : context_(context), name_(name), shader_(shader) {
    try {
        create(constants);
    } catch (...) {
        destroy();
        throw;
    }
}

void Kernel::create_layouts() {
    const VkDevice device = context_.device();
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (std::uint32_t i = 0; i < shader_.buffers.size(); ++i)
        bindings.push_back({i, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
    VkDescriptorSetLayoutCreateInfo set_create{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    set_create.bindingCount = static_cast<std::uint32_t>(bindings.size());
    set_create.pBindings = bindings.data();
    check(vkCreateDescriptorSetLayout(device, &set_create, nullptr, &set_layout_), "vkCreateDescriptorSetLayout");

    const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes()};
    VkPipelineLayoutCreateInfo layout_create{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    layout_create.setLayoutCount = 1;
    layout_create.pSetLayouts = &set_layout_;
    layout_create.pushConstantRangeCount = push.size > 0 ? 1 : 0;
    layout_create.pPushConstantRanges = &push;
    check(vkCreatePipelineLayout(device, &layout_create, nullptr, &layout_), "vkCreatePipelineLayout");
}

void Kernel::create(const NamedValues& constants) {
    const auto values = in_order(name_, "specialisation constant", constants, shader_.constants);
    std::vector<VkSpecializationMapEntry> entries;
    for (std::uint32_t i = 0; i < values.size(); ++i) entries.push_back({shader_.constants[i].place, i * 4, 4});
    const VkSpecializationInfo special{static_cast<std::uint32_t>(entries.size()), entries.data(), values.size() * 4,
                                       values.data()};
    create_layouts();

    const VkDevice device = context_.device();
    VkShaderModuleCreateInfo module_create{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    module_create.codeSize = shader_.code.size_bytes();
    module_create.pCode = shader_.code.data();
    VkShaderModule module = VK_NULL_HANDLE;
    check(vkCreateShaderModule(device, &module_create, nullptr, &module), "vkCreateShaderModule");

    VkComputePipelineCreateInfo create{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    create.layout = layout_;
    create.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    create.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    create.stage.module = module;
    create.stage.pName = "main";
    create.stage.pSpecializationInfo = &special;
    const VkResult result = vkCreateComputePipelines(device, VK_NULL_HANDLE, 1, &create, nullptr, &pipeline_);
    vkDestroyShaderModule(device, module, nullptr);
    check(result, "vkCreateComputePipelines");
    context_.name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(pipeline_), name_);
}

Kernel::~Kernel() { destroy(); }

void Kernel::destroy() {
    vkDestroyPipeline(context_.device(), pipeline_, nullptr);
    vkDestroyPipelineLayout(context_.device(), layout_, nullptr);
    vkDestroyDescriptorSetLayout(context_.device(), set_layout_, nullptr);
}

std::uint32_t Kernel::push_bytes() const {
    std::uint32_t bytes = 0;
    for (const ShaderValue& value : shader_.push_constants) bytes = std::max(bytes, value.place + 4);
    return bytes;
}

Groups Kernel::groups_for(std::uint32_t x, std::uint32_t y) const {
    return {ceil_div(x, shader_.group_size[0]), ceil_div(y, shader_.group_size[1])};
}

}  // namespace posefusion::vulkan
