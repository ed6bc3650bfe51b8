#include "bake/vk/compute_pipelines.h"
#include "bake/vk/shader_stage.h"
#include "shaders/shader_library.h"

namespace relume::vk {

ComputePipeline::ComputePipeline(const Device& device, std::span<const uint32_t> code,
                                 const std::string& name, const Constants& constants)
    : device_(device) {
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

ComputePipeline::~ComputePipeline() {
    release();
}

void ComputePipeline::release() {
    vkDestroyPipeline(device_.handle(), pipeline_, nullptr);
    vkDestroyPipelineLayout(device_.handle(), layout_, nullptr);
}

std::shared_ptr<const ComputePipeline> ComputePipelines::get(const Device& device, const std::string& shader,
                                                             const Constants& constants) {
    const std::lock_guard lock(mutex_);
    std::shared_ptr<const ComputePipeline>& pipeline = made_[{shader, constants}];
    if (!pipeline)
        pipeline = std::make_shared<const ComputePipeline>(device, shaderCode(shader), shader, constants);
    return pipeline;
}

} // namespace relume::vk
