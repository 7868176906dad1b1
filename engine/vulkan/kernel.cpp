#include "engine/vulkan/kernel.hpp"

#include "engine/core/error.hpp"

namespace posefusion::vulkan {

Kernel::Kernel(Context& context, const std::string& shader, std::uint32_t bindings, std::uint32_t push_bytes,
               const std::vector<std::uint32_t>& specialisation)
    : context_(context), name_(shader), bindings_(bindings), push_bytes_(push_bytes) {
    try {
        create(specialisation);
    } catch (...) {
        destroy();
        throw;
    }
}

void Kernel::create(const std::vector<std::uint32_t>& specialisation) {
    const VkDevice device = context_.device();
    std::vector<VkDescriptorSetLayoutBinding> layout_bindings(bindings_);
    for (std::uint32_t i = 0; i < bindings_; ++i) {
        layout_bindings[i] = {i, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
    }
    VkDescriptorSetLayoutCreateInfo set_create{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    set_create.bindingCount = bindings_;
    set_create.pBindings = layout_bindings.data();
    check(vkCreateDescriptorSetLayout(device, &set_create, nullptr, &set_layout_), "vkCreateDescriptorSetLayout");

    const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes_};
    VkPipelineLayoutCreateInfo layout_create{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    layout_create.setLayoutCount = 1;
    layout_create.pSetLayouts = &set_layout_;
    layout_create.pushConstantRangeCount = push_bytes_ ? 1 : 0;
    layout_create.pPushConstantRanges = &push;
    check(vkCreatePipelineLayout(device, &layout_create, nullptr, &layout_), "vkCreatePipelineLayout");

    const auto code = shader_code(name_);
    VkShaderModuleCreateInfo module_create{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    module_create.codeSize = code.size_bytes();
    module_create.pCode = code.data();
    VkShaderModule module = VK_NULL_HANDLE;
    check(vkCreateShaderModule(device, &module_create, nullptr, &module), "vkCreateShaderModule");

    std::vector<VkSpecializationMapEntry> entries;
    for (std::uint32_t i = 0; i < specialisation.size(); ++i) entries.push_back({i, i * 4, 4});
    const VkSpecializationInfo special{static_cast<std::uint32_t>(entries.size()), entries.data(),
                                       specialisation.size() * 4, specialisation.data()};
    VkComputePipelineCreateInfo create{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    create.layout = layout_;
    create.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    create.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    create.stage.module = module;
    create.stage.pName = "main";
    create.stage.pSpecializationInfo = entries.empty() ? nullptr : &special;
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

}  // namespace posefusion::vulkan
