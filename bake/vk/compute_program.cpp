#include "bake/vk/compute_pipelines.h"

namespace relume::vk {

ComputeProgram::ComputeProgram(const Device& device, const std::string& shader, const Constants& constants)
    : device_(&device), pipeline_(device.computePipelines().get(device, shader, constants)) {}

ComputeProgram::ComputeProgram(const Device& device, std::span<const uint32_t> code, const std::string& name,
                               const Constants& constants)
    : device_(&device), pipeline_(std::make_shared<const ComputePipeline>(device, code, name, constants)) {}

ComputeProgram ComputeProgram::builtAtFirstUse(const Device& device, const std::string& shader,
                                               const Constants& constants) {
    ComputeProgram program;
    program.device_ = &device;
    program.shader_ = shader;
    program.constants_ = constants;
    return program;
}

void ComputeProgram::dispatchBytes(VkCommandBuffer cmd, const void* push, uint32_t size, uint32_t x,
                                   uint32_t y, uint32_t z) const {
    ASSERT(device_ != nullptr);
    if (!pipeline_) pipeline_ = device_->computePipelines().get(*device_, shader_, constants_);
    const uint32_t* limit = device_->limits().maxComputeWorkGroupCount;
    ASSERT(x <= limit[0] && y <= limit[1] && z <= limit[2]);
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_->handle());
    vkCmdPushConstants(cmd, pipeline_->layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0, size, push);
    vkCmdDispatch(cmd, x, y, z);
}

} // namespace relume::vk
