#pragma once

#include "bake/vk/program.h"

namespace relume::vk {

/// Owns a VkShaderModule and the specialization of one pipeline stage; lives until the pipeline is created.
class ShaderStage {
public:
    ShaderStage(const Device& device, std::span<const uint32_t> code, VkShaderStageFlagBits stage,
                const Constants& constants);
    ~ShaderStage();
    ShaderStage(const ShaderStage&) = delete;
    ShaderStage& operator=(const ShaderStage&) = delete;

    /// Returns the stage's create info, which points into this object.
    VkPipelineShaderStageCreateInfo info() const;

private:
    const Device& device_;
    VkShaderModule module_ = VK_NULL_HANDLE;
    VkShaderStageFlagBits stage_;
    Constants constants_;
    std::vector<VkSpecializationMapEntry> entries_;
    VkSpecializationInfo specialization_{};
};

/// Makes a layout with 128 bytes of push constants for `stages` and one descriptor set, if there is one.
VkPipelineLayout createLayout(const Device& device, VkShaderStageFlags stages,
                              VkDescriptorSetLayout setLayout = VK_NULL_HANDLE);

} // namespace relume::vk
