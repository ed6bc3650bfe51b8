#include "bake/vk/shader_stage.h"
#include "shaders/shader_library.h"

#include <utility>

namespace relume::vk {

ComputeProgram::ComputeProgram(const Device& device, const std::string& shader, const Constants& constants)
    : ComputeProgram(device, shaderCode(shader), shader, constants) {}

ComputeProgram::ComputeProgram(const Device& device, std::span<const uint32_t> code, const std::string& name,
                               const Constants& constants)
    : device_(&device) {
    try {
        layout_ = createLayout(device, VK_SHADER_STAGE_COMPUTE_BIT);
        const ShaderStage stage(device, code, VK_SHADER_STAGE_COMPUTE_BIT, constants);
        VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
        info.stage = stage.info();
        info.layout = layout_;
        const VkResult result =
            vkCreateComputePipelines(device.handle(), device.pipelineCache(), 1, &info, nullptr, &pipeline_);
        if (result < 0)
            throw Error("shader '" + name + "': " + device.info().name + " cannot build it (" +
                        resultName(result) + "): update its driver or try another --device");
        device.setName(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<uint64_t>(pipeline_), name.c_str());
    } catch (...) {
        release();
        throw;
    }
}

ComputeProgram::~ComputeProgram() {
    release();
}

ComputeProgram::ComputeProgram(ComputeProgram&& other) noexcept {
    *this = std::move(other);
}

ComputeProgram& ComputeProgram::operator=(ComputeProgram&& other) noexcept {
    if (this == &other) return *this;
    release();
    device_ = std::exchange(other.device_, nullptr);
    layout_ = std::exchange(other.layout_, VK_NULL_HANDLE);
    pipeline_ = std::exchange(other.pipeline_, VK_NULL_HANDLE);
    return *this;
}

void ComputeProgram::dispatchBytes(VkCommandBuffer cmd, const void* push, uint32_t size, uint32_t x,
                                   uint32_t y, uint32_t z) const {
    ASSERT(pipeline_ != VK_NULL_HANDLE);
    const uint32_t* limit = device_->limits().maxComputeWorkGroupCount;
    ASSERT(x <= limit[0] && y <= limit[1] && z <= limit[2]);
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_);
    vkCmdPushConstants(cmd, layout_, VK_SHADER_STAGE_COMPUTE_BIT, 0, size, push);
    vkCmdDispatch(cmd, x, y, z);
}

void ComputeProgram::release() {
    if (device_ == nullptr) return;
    vkDestroyPipeline(device_->handle(), pipeline_, nullptr);
    vkDestroyPipelineLayout(device_->handle(), layout_, nullptr);
}

} // namespace relume::vk
