#include "bake/vk/shader_stage.h"
#include "shaders/shader_library.h"

#include <algorithm>

namespace relume::vk {

namespace {

constexpr VkShaderStageFlags kRasterStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

} // namespace

RasterProgram::RasterProgram(const Device& device, const Desc& desc, std::span<const BoundTexture> textures)
    : device_(device) {
    ASSERT(textures.size() == desc.textureCount);
    if (desc.formats.size() > device.limits().maxColorAttachments)
        throw Error("device '" + device.info().name + "' draws into " +
                    std::to_string(device.limits().maxColorAttachments) + " images at once, " +
                    std::to_string(desc.formats.size()) + " are needed: try another --device");
    const uint32_t textureLimit = std::min({device.limits().maxPerStageDescriptorSamplers,
                                            device.limits().maxPerStageDescriptorSampledImages,
                                            device.limits().maxPerStageResources - 8});
    if (desc.textureCount > textureLimit)
        throw Error("device '" + device.info().name + "' binds at most " + std::to_string(textureLimit) +
                    " textures, the scene has " + std::to_string(desc.textureCount) +
                    ": try another --device");
    try {
        createDescriptors(std::max(1u, desc.textureCount), textures);
        createRenderPass(desc.formats);
        layout_ = createLayout(device, kRasterStages, setLayout_);
        createPipeline(desc);
    } catch (...) {
        release();
        throw;
    }
}

// The array is bound partially: without textures the shader still declares it.
void RasterProgram::createDescriptors(uint32_t count, std::span<const BoundTexture> textures) {
    const VkDescriptorBindingFlags flag = VK_DESCRIPTOR_BINDING_PARTIALLY_BOUND_BIT;
    VkDescriptorSetLayoutBindingFlagsCreateInfo flags{
        VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_BINDING_FLAGS_CREATE_INFO};
    flags.bindingCount = 1;
    flags.pBindingFlags = &flag;
    const VkDescriptorSetLayoutBinding binding{0, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, count,
                                               kRasterStages, nullptr};
    VkDescriptorSetLayoutCreateInfo layout{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, &flags};
    layout.bindingCount = 1;
    layout.pBindings = &binding;
    VK_CHECK(vkCreateDescriptorSetLayout(device_.handle(), &layout, nullptr, &setLayout_));

    const VkDescriptorPoolSize poolSize{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, count};
    VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    pool.maxSets = 1;
    pool.poolSizeCount = 1;
    pool.pPoolSizes = &poolSize;
    VK_CHECK(vkCreateDescriptorPool(device_.handle(), &pool, nullptr, &pool_));
    VkDescriptorSetAllocateInfo allocation{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
    allocation.descriptorPool = pool_;
    allocation.descriptorSetCount = 1;
    allocation.pSetLayouts = &setLayout_;
    VK_CHECK(vkAllocateDescriptorSets(device_.handle(), &allocation, &set_));
    if (textures.empty()) return;

    std::vector<VkDescriptorImageInfo> images;
    for (const BoundTexture& texture : textures)
        images.push_back({texture.sampler, texture.view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL});
    VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    write.dstSet = set_;
    write.descriptorCount = static_cast<uint32_t>(images.size());
    write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    write.pImageInfo = images.data();
    vkUpdateDescriptorSets(device_.handle(), 1, &write, 0, nullptr);
}

void RasterProgram::createRenderPass(std::span<const VkFormat> formats) {
    std::vector<VkAttachmentDescription> attachments;
    std::vector<VkAttachmentReference> references;
    for (VkFormat format : formats) {
        VkAttachmentDescription attachment{};
        attachment.format = format;
        attachment.samples = VK_SAMPLE_COUNT_1_BIT;
        attachment.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
        attachment.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
        attachment.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
        attachment.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
        attachment.initialLayout = VK_IMAGE_LAYOUT_UNDEFINED;
        attachment.finalLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
        references.push_back(
            {static_cast<uint32_t>(attachments.size()), VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL});
        attachments.push_back(attachment);
    }
    VkSubpassDescription subpass{};
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.colorAttachmentCount = static_cast<uint32_t>(references.size());
    subpass.pColorAttachments = references.data();
    // The draw waits for whatever read or wrote the targets before; whatever copies or reads them afterwards
    // waits for the draw.
    const VkSubpassDependency dependencies[2] = {
        {VK_SUBPASS_EXTERNAL, 0, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
         VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, VK_ACCESS_MEMORY_WRITE_BIT,
         VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT, 0},
        {0, VK_SUBPASS_EXTERNAL, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
         VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT, 0}};
    VkRenderPassCreateInfo info{VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO};
    info.attachmentCount = static_cast<uint32_t>(attachments.size());
    info.pAttachments = attachments.data();
    info.subpassCount = 1;
    info.pSubpasses = &subpass;
    info.dependencyCount = 2;
    info.pDependencies = dependencies;
    VK_CHECK(vkCreateRenderPass(device_.handle(), &info, nullptr, &renderPass_));
}

void RasterProgram::createPipeline(const Desc& desc) {
    const ShaderStage vertex(device_, shaderCode(desc.vertex), VK_SHADER_STAGE_VERTEX_BIT, desc.constants);
    const ShaderStage fragment(device_, shaderCode(desc.fragment), VK_SHADER_STAGE_FRAGMENT_BIT,
                               desc.constants);
    const VkPipelineShaderStageCreateInfo stages[2] = {vertex.info(), fragment.info()};
    const VkPipelineVertexInputStateCreateInfo vertexInput{
        VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    VkPipelineInputAssemblyStateCreateInfo assembly{
        VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
    viewport.viewportCount = viewport.scissorCount = 1;
    VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
    raster.polygonMode = VK_POLYGON_MODE_FILL;
    raster.cullMode = VK_CULL_MODE_NONE;
    raster.lineWidth = 1.0f;
    VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    VkPipelineColorBlendAttachmentState write{};
    write.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT |
                           VK_COLOR_COMPONENT_A_BIT;
    const std::vector<VkPipelineColorBlendAttachmentState> writes(desc.formats.size(), write);
    VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
    blend.attachmentCount = static_cast<uint32_t>(writes.size());
    blend.pAttachments = writes.data();
    const VkDynamicState dynamic[2] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineDynamicStateCreateInfo dynamics{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
    dynamics.dynamicStateCount = 2;
    dynamics.pDynamicStates = dynamic;

    VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
    info.stageCount = 2;
    info.pStages = stages;
    info.pVertexInputState = &vertexInput;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewport;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &samples;
    info.pColorBlendState = &blend;
    info.pDynamicState = &dynamics;
    info.layout = layout_;
    info.renderPass = renderPass_;
    VK_CHECK(
        vkCreateGraphicsPipelines(device_.handle(), device_.pipelineCache(), 1, &info, nullptr, &pipeline_));
    device_.setName(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<uint64_t>(pipeline_), desc.vertex.c_str());
}

void RasterProgram::drawBytes(VkCommandBuffer cmd, Bytes push, std::span<const Image2D* const> targets,
                              const Window& window, uint32_t vertexCount) {
    std::vector<VkImageView> views;
    for (const Image2D* target : targets)
        views.push_back(target->view());
    VkFramebufferCreateInfo info{VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO};
    info.renderPass = renderPass_;
    info.attachmentCount = static_cast<uint32_t>(views.size());
    info.pAttachments = views.data();
    info.width = static_cast<uint32_t>(window.area.offset.x) + window.area.extent.width;
    info.height = static_cast<uint32_t>(window.area.offset.y) + window.area.extent.height;
    info.layers = 1;
    vkDestroyFramebuffer(device_.handle(), framebuffer_, nullptr);
    framebuffer_ = VK_NULL_HANDLE;
    VK_CHECK(vkCreateFramebuffer(device_.handle(), &info, nullptr, &framebuffer_));

    const std::vector<VkClearValue> zeros(views.size());
    VkRenderPassBeginInfo begin{VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO};
    begin.renderPass = renderPass_;
    begin.framebuffer = framebuffer_;
    begin.renderArea = window.area;
    begin.clearValueCount = static_cast<uint32_t>(zeros.size());
    begin.pClearValues = zeros.data();
    vkCmdBeginRenderPass(cmd, &begin, VK_SUBPASS_CONTENTS_INLINE);
    const VkViewport viewport{
        0.0f, 0.0f, static_cast<float>(window.viewport.width), static_cast<float>(window.viewport.height),
        0.0f, 1.0f};
    vkCmdSetViewport(cmd, 0, 1, &viewport);
    vkCmdSetScissor(cmd, 0, 1, &begin.renderArea);
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_);
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_, 0, 1, &set_, 0, nullptr);
    vkCmdPushConstants(cmd, layout_, kRasterStages, 0, push.size, push.data);
    vkCmdDraw(cmd, vertexCount, 1, 0, 0);
    vkCmdEndRenderPass(cmd);
}

RasterProgram::~RasterProgram() {
    release();
}

void RasterProgram::release() {
    vkDestroyFramebuffer(device_.handle(), framebuffer_, nullptr);
    vkDestroyPipeline(device_.handle(), pipeline_, nullptr);
    vkDestroyPipelineLayout(device_.handle(), layout_, nullptr);
    vkDestroyRenderPass(device_.handle(), renderPass_, nullptr);
    vkDestroyDescriptorPool(device_.handle(), pool_, nullptr);
    vkDestroyDescriptorSetLayout(device_.handle(), setLayout_, nullptr);
}

} // namespace relume::vk
