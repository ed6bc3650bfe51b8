#include "bake/vk/shader_stage.h"

namespace relume::vk {

namespace {

constexpr uint32_t kPushBytes = 128; // what every Vulkan device has
constexpr uint32_t kSoftwareDevice =
    100; // the constant of all shaders that says so (shaders/lib/buffers.glsl)

} // namespace

ShaderStage::ShaderStage(const Device& device, std::span<const uint32_t> code, VkShaderStageFlagBits stage,
                         const Constants& constants)
    : device_(device), stage_(stage), constants_(constants) {
    constants_.push_back(device.info().software() ? 1 : 0);
    for (uint32_t i = 0; i < constants_.size(); ++i)
        entries_.push_back({i + 1 < constants_.size() ? i : kSoftwareDevice, i * 4, 4});
    specialization_ = {static_cast<uint32_t>(entries_.size()), entries_.data(), constants_.size() * 4,
                       constants_.data()};
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = code.size_bytes();
    info.pCode = code.data();
    VK_CHECK(vkCreateShaderModule(device.handle(), &info, nullptr, &module_));
}

ShaderStage::~ShaderStage() {
    vkDestroyShaderModule(device_.handle(), module_, nullptr);
}

VkPipelineShaderStageCreateInfo ShaderStage::info() const {
    VkPipelineShaderStageCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
    info.stage = stage_;
    info.module = module_;
    info.pName = "main";
    info.pSpecializationInfo = entries_.empty() ? nullptr : &specialization_;
    return info;
}

VkPipelineLayout createLayout(const Device& device, VkShaderStageFlags stages,
                              VkDescriptorSetLayout setLayout) {
    const VkPushConstantRange range{stages, 0, kPushBytes};
    VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    info.setLayoutCount = setLayout != VK_NULL_HANDLE ? 1 : 0;
    info.pSetLayouts = &setLayout;
    info.pushConstantRangeCount = 1;
    info.pPushConstantRanges = &range;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    VK_CHECK(vkCreatePipelineLayout(device.handle(), &info, nullptr, &layout));
    return layout;
}

} // namespace relume::vk
