#pragma once

#include <span>

#include <glm/glm.hpp>

#include "bake/vk/buffer.h"

namespace relume::vk {

/// A bottom and a top level acceleration structure over world-space triangles: geometry 0 holds the opaque
/// ones, geometry 1 the alpha-masked ones (left out where there are none). Both are built for fast tracing
/// and compacted; building waits for the device.
class Accel {
public:
    Accel() = default;
    /// Builds it from positions [m], 3 per triangle, of which the first opaqueCount triangles are opaque.
    /// Throws Error.
    Accel(const Device& device, std::span<const glm::vec3> positions, uint32_t opaqueCount);
    ~Accel();
    Accel(Accel&& other) noexcept;
    Accel& operator=(Accel&& other) noexcept;

    /// Returns the top level's address, for accelerationStructureEXT(address) in a shader.
    VkDeviceAddress address() const { return topAddress_; }
    uint64_t bytes() const { return bytes_; }

private:
    void buildBottom(std::span<const glm::vec3> positions, uint32_t opaqueCount);
    void compactBottom(VkDeviceSize size);
    void buildTop();
    void release();
    const Device* device_ = nullptr;
    Buffer bottomBuffer_, topBuffer_;
    VkAccelerationStructureKHR bottom_ = VK_NULL_HANDLE, top_ = VK_NULL_HANDLE;
    VkDeviceAddress topAddress_ = 0;
    uint64_t bytes_ = 0;
};

} // namespace relume::vk
