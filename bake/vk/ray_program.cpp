#include "bake/vk/shader_stage.h"
#include "shaders/shader_library.h"

#include <cstring>
#include <memory>
#include <utility>

namespace relume::vk {

namespace {

constexpr VkShaderStageFlags kRayStages = VK_SHADER_STAGE_RAYGEN_BIT_KHR | VK_SHADER_STAGE_MISS_BIT_KHR |
                                          VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR |
                                          VK_SHADER_STAGE_ANY_HIT_BIT_KHR;
constexpr uint32_t kGroups = 3; // raygen, miss, hit

VkRayTracingShaderGroupCreateInfoKHR makeGroup(VkRayTracingShaderGroupTypeKHR type) {
    VkRayTracingShaderGroupCreateInfoKHR group{VK_STRUCTURE_TYPE_RAY_TRACING_SHADER_GROUP_CREATE_INFO_KHR};
    group.type = type;
    group.generalShader = group.closestHitShader = group.anyHitShader = group.intersectionShader =
        VK_SHADER_UNUSED_KHR;
    return group;
}

VkDeviceSize aligned(VkDeviceSize value, VkDeviceSize alignment) {
    return (value + alignment - 1) / alignment * alignment;
}

} // namespace

RayProgram::RayProgram(const Device& device, const Desc& desc) : device_(&device) {
    if (!device.info().rayTracingPipeline)
        throw Error("device '" + device.info().name +
                    "' has no VK_KHR_ray_tracing_pipeline: use --tracer bvh or embree");
    try {
        create(desc);
        createTable();
    } catch (...) {
        release();
        throw;
    }
}

void RayProgram::create(const Desc& desc) {
    layout_ = createLayout(*device_, kRayStages);
    std::vector<std::unique_ptr<ShaderStage>> stages;
    std::vector<VkPipelineShaderStageCreateInfo> infos;
    const auto add = [&](const std::string& shader, VkShaderStageFlagBits stage, const Constants& constants) {
        if (shader.empty()) return uint32_t{VK_SHADER_UNUSED_KHR};
        stages.push_back(std::make_unique<ShaderStage>(*device_, shaderCode(shader), stage, constants));
        infos.push_back(stages.back()->info());
        return static_cast<uint32_t>(infos.size() - 1);
    };
    VkRayTracingShaderGroupCreateInfoKHR groups[kGroups] = {
        makeGroup(VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR),
        makeGroup(VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR),
        makeGroup(VK_RAY_TRACING_SHADER_GROUP_TYPE_TRIANGLES_HIT_GROUP_KHR)};
    groups[0].generalShader = add(desc.raygen, VK_SHADER_STAGE_RAYGEN_BIT_KHR, desc.constants);
    groups[1].generalShader = add(desc.miss, VK_SHADER_STAGE_MISS_BIT_KHR, {});
    groups[2].closestHitShader = add(desc.closestHit, VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, {});
    groups[2].anyHitShader = add(desc.anyHit, VK_SHADER_STAGE_ANY_HIT_BIT_KHR, {});

    VkRayTracingPipelineCreateInfoKHR info{VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_CREATE_INFO_KHR};
    info.stageCount = static_cast<uint32_t>(infos.size());
    info.pStages = infos.data();
    info.groupCount = kGroups;
    info.pGroups = groups;
    info.maxPipelineRayRecursionDepth = 1;
    info.layout = layout_;
    const VkResult result = vkCreateRayTracingPipelinesKHR(
        device_->handle(), VK_NULL_HANDLE, device_->pipelineCache(), 1, &info, nullptr, &pipeline_);
    if (result < 0)
        throw Error("shader '" + desc.raygen + "': " + device_->info().name + " cannot build it (" +
                    resultName(result) + "): use --tracer bvh or embree");
    device_->setName(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<uint64_t>(pipeline_), desc.raygen.c_str());
}

// Makes the shader binding table: one record per group, each at a multiple of the base alignment.
void RayProgram::createTable() {
    const VkDeviceSize handleSize = device_->rayTracing().shaderGroupHandleSize;
    const VkDeviceSize base = device_->rayTracing().shaderGroupBaseAlignment;
    const VkDeviceSize stride = aligned(handleSize, base);
    std::vector<uint8_t> handles(kGroups * handleSize);
    VK_CHECK(vkGetRayTracingShaderGroupHandlesKHR(device_->handle(), pipeline_, 0, kGroups, handles.size(),
                                                  handles.data()));
    table_ =
        Buffer(*device_, {.size = (kGroups + 1) * stride, // one more: the buffer itself need not be aligned
                          .extraUsage = VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR,
                          .name = "shader binding table"});
    const VkDeviceAddress first = aligned(table_.address(), base);
    std::vector<uint8_t> records(kGroups * stride);
    for (uint32_t i = 0; i < kGroups; ++i)
        std::memcpy(&records[i * stride], &handles[i * handleSize], handleSize);
    upload(*device_, table_, records.data(), records.size(), first - table_.address());
    raygenRegion_ = {first, stride, stride};
    missRegion_ = {first + stride, stride, stride};
    hitRegion_ = {first + 2 * stride, stride, stride};
}

RayProgram::~RayProgram() {
    release();
}

RayProgram::RayProgram(RayProgram&& other) noexcept {
    *this = std::move(other);
}

RayProgram& RayProgram::operator=(RayProgram&& other) noexcept {
    if (this == &other) return *this;
    release();
    device_ = std::exchange(other.device_, nullptr);
    layout_ = std::exchange(other.layout_, VK_NULL_HANDLE);
    pipeline_ = std::exchange(other.pipeline_, VK_NULL_HANDLE);
    table_ = std::move(other.table_);
    raygenRegion_ = other.raygenRegion_;
    missRegion_ = other.missRegion_;
    hitRegion_ = other.hitRegion_;
    return *this;
}

void RayProgram::traceBytes(VkCommandBuffer cmd, const void* push, uint32_t size, uint32_t width,
                            uint32_t height) const {
    ASSERT(pipeline_ != VK_NULL_HANDLE);
    ASSERT(uint64_t{width} * height <= device_->rayTracing().maxRayDispatchInvocationCount);
    const VkStridedDeviceAddressRegionKHR callable{};
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, pipeline_);
    vkCmdPushConstants(cmd, layout_, kRayStages, 0, size, push);
    vkCmdTraceRaysKHR(cmd, &raygenRegion_, &missRegion_, &hitRegion_, &callable, width, height, 1);
}

void RayProgram::release() {
    if (device_ == nullptr) return;
    vkDestroyPipeline(device_->handle(), pipeline_, nullptr);
    vkDestroyPipelineLayout(device_->handle(), layout_, nullptr);
}

} // namespace relume::vk
