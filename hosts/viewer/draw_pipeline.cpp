#include "hosts/viewer/draw_pipeline.hpp"

#include <algorithm>

namespace posefusion {

using vulkan::check;
using vulkan::Shader;

namespace {

constexpr std::array kStages{VK_SHADER_STAGE_VERTEX_BIT, VK_SHADER_STAGE_FRAGMENT_BIT};

VkShaderModule make_module(VkDevice device, std::span<const std::uint32_t> code) {
    VkShaderModuleCreateInfo create{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    create.codeSize = code.size_bytes();
    create.pCode = code.data();
    VkShaderModule module = VK_NULL_HANDLE;
    check(vkCreateShaderModule(device, &create, nullptr, &module), "vkCreateShaderModule");
    return module;
}

bool declares(const Shader& shader, std::string_view buffer) {
    return std::ranges::find(shader.buffers, buffer, &vulkan::ShaderBuffer::name) != shader.buffers.end();
}

}  // namespace

DrawPipeline::DrawPipeline(vulkan::Context& context, VkRenderPass pass, const DrawKind& kind)
    : context_(context), name_(kind.name), shaders_{kind.vertex_shader, kind.fragment_shader} {
    try {
        create(pass, kind);
    } catch (...) {
        destroy();
        throw;
    }
}

DrawPipeline::~DrawPipeline() { destroy(); }

void DrawPipeline::destroy() {
    const VkDevice device = context_.device();
    vkDestroyPipeline(device, pipeline_, nullptr);
    vkDestroyPipelineLayout(device, layout_, nullptr);
    vkDestroyDescriptorPool(device, pool_, nullptr);
    for (const VkDescriptorSetLayout layout : set_layouts_) vkDestroyDescriptorSetLayout(device, layout, nullptr);
}

void DrawPipeline::create(VkRenderPass pass, const DrawKind& kind) {
    create_layouts();
    allocate_sets();
    create_pipeline(pass, kind);
}

void DrawPipeline::create_layouts() {
    const VkDevice device = context_.device();
    for (std::size_t stage = 0; stage < kStages.size(); ++stage) {
        std::vector<VkDescriptorSetLayoutBinding> bindings;
        for (std::uint32_t i = 0; i < shaders_[stage].buffers.size(); ++i) {
            const auto bits = static_cast<VkShaderStageFlags>(kStages[stage]);
            bindings.push_back({i, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, bits, nullptr});
        }
        VkDescriptorSetLayoutCreateInfo create{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
        create.bindingCount = static_cast<std::uint32_t>(bindings.size());
        create.pBindings = bindings.data();
        check(vkCreateDescriptorSetLayout(device, &create, nullptr, &set_layouts_[stage]),
              "vkCreateDescriptorSetLayout");
    }
    VkPipelineLayoutCreateInfo create{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    create.setLayoutCount = static_cast<std::uint32_t>(set_layouts_.size());
    create.pSetLayouts = set_layouts_.data();
    check(vkCreatePipelineLayout(device, &create, nullptr, &layout_), "vkCreatePipelineLayout");
}

void DrawPipeline::allocate_sets() {
    const VkDevice device = context_.device();
    const std::size_t buffers = shaders_[0].buffers.size() + shaders_[1].buffers.size();
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, static_cast<std::uint32_t>(buffers)};
    VkDescriptorPoolCreateInfo create{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    create.maxSets = static_cast<std::uint32_t>(sets_.size());
    create.poolSizeCount = 1;
    create.pPoolSizes = &size;
    check(vkCreateDescriptorPool(device, &create, nullptr, &pool_), "vkCreateDescriptorPool");
    VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
    allocate.descriptorPool = pool_;
    allocate.descriptorSetCount = static_cast<std::uint32_t>(sets_.size());
    allocate.pSetLayouts = set_layouts_.data();
    check(vkAllocateDescriptorSets(device, &allocate, sets_.data()), "vkAllocateDescriptorSets");
}

void DrawPipeline::create_pipeline(VkRenderPass pass, const DrawKind& kind) {
    const VkDevice device = context_.device();
    std::array<VkPipelineShaderStageCreateInfo, 2> stages{};
    for (std::size_t i = 0; i < stages.size(); ++i) {
        stages[i].sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
        stages[i].stage = kStages[i];
        stages[i].module = make_module(device, shaders_[i].code);
        stages[i].pName = "main";
    }

    const VkPipelineVertexInputStateCreateInfo vertices{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
    assembly.topology = kind.topology;
    VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
    viewport.viewportCount = viewport.scissorCount = 1;
    VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
    raster.cullMode = VK_CULL_MODE_NONE;
    raster.lineWidth = 1;
    VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
    depth.depthTestEnable = depth.depthWriteEnable = kind.depth_test ? VK_TRUE : VK_FALSE;
    depth.depthCompareOp = VK_COMPARE_OP_GREATER;  // depth is near / z
    VkPipelineColorBlendAttachmentState blend{};
    blend.colorWriteMask =
        VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
    VkPipelineColorBlendStateCreateInfo blends{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
    blends.attachmentCount = 1;
    blends.pAttachments = &blend;
    const VkDynamicState dynamic_states[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
    dynamic.dynamicStateCount = 2;
    dynamic.pDynamicStates = dynamic_states;

    VkGraphicsPipelineCreateInfo create{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
    create.stageCount = static_cast<std::uint32_t>(stages.size());
    create.pStages = stages.data();
    create.pVertexInputState = &vertices;
    create.pInputAssemblyState = &assembly;
    create.pViewportState = &viewport;
    create.pRasterizationState = &raster;
    create.pMultisampleState = &samples;
    create.pDepthStencilState = &depth;
    create.pColorBlendState = &blends;
    create.pDynamicState = &dynamic;
    create.layout = layout_;
    create.renderPass = pass;
    const VkResult result = vkCreateGraphicsPipelines(device, VK_NULL_HANDLE, 1, &create, nullptr, &pipeline_);
    for (const auto& stage : stages) vkDestroyShaderModule(device, stage.module, nullptr);
    check(result, "vkCreateGraphicsPipelines");
    context_.name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(pipeline_), name_);
}

void DrawPipeline::bind(const vulkan::NamedBuffers& buffers) {
    for (std::size_t stage = 0; stage < shaders_.size(); ++stage) {
        vulkan::NamedBuffers own;
        for (const vulkan::NamedBuffer& given : buffers) {
            // names unknown to both go to the first shader, which reports the error
            const bool unknown = !declares(shaders_[0], given.name) && !declares(shaders_[1], given.name);
            if (declares(shaders_[stage], given.name) || (unknown && stage == 0)) own.push_back(given);
        }
        vulkan::bind_buffers(context_, sets_[stage], vulkan::in_order(name_, own, shaders_[stage].buffers));
    }
}

void DrawPipeline::draw(VkCommandBuffer commands, std::uint32_t vertices, std::uint32_t instances) const {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_, 0,
                            static_cast<std::uint32_t>(sets_.size()), sets_.data(), 0, nullptr);
    vkCmdDraw(commands, vertices, instances, 0, 0);
}

}  // namespace posefusion
