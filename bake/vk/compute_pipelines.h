#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "bake/vk/device.h"
#include "bake/vk/program.h"

namespace relume::vk {

/// Owns a compute pipeline and its layout. It never changes, so any number of programs may share it.
class ComputePipeline {
public:
    /// Compiles SPIR-V; `name` is for messages. Throws Error where the driver cannot.
    ComputePipeline(const Device& device, std::span<const uint32_t> code, const std::string& name,
                    const Constants& constants);
    ~ComputePipeline();
    ComputePipeline(const ComputePipeline&) = delete;
    ComputePipeline& operator=(const ComputePipeline&) = delete;

    VkPipelineLayout layout() const { return layout_; }
    VkPipeline handle() const { return pipeline_; }

private:
    void release();
    const Device& device_;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
};

/// Holds the compute pipelines that were made of the shader library on one device, until the device ends. A
/// second bake on the device then starts without compiling, which a software device takes a second or more
/// for.
class ComputePipelines {
public:
    /// Returns the pipeline of a shader of the library, and compiles it at the first call. Any thread may
    /// call this; a second one that asks for the same waits for the first. Throws Error.
    std::shared_ptr<const ComputePipeline> get(const Device& device, const std::string& shader,
                                               const Constants& constants);

private:
    std::mutex mutex_;
    std::map<std::pair<std::string, Constants>, std::shared_ptr<const ComputePipeline>> made_;
};

} // namespace relume::vk
