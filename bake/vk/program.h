#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bake/vk/buffer.h"
#include "bake/vk/image.h"

namespace relume::vk {

/// Values of specialization constants 0, 1, 2, ... (bool as 0 or 1). Constant 100 tells every shader whether
/// it runs on a software device.
using Constants = std::vector<uint32_t>;

class ComputePipeline;

/// A compute shader. Everything it reads comes by address in its push constants (at most 128 bytes).
class ComputeProgram {
public:
    ComputeProgram() = default;
    /// Takes a shader of the library, whose pipeline all its programs on this device share. Throws Error.
    ComputeProgram(const Device& device, const std::string& shader, const Constants& constants = {});
    /// Takes a shader of the library, which is built when it is dispatched first: for what many bakes have no
    /// use of, as a software device takes a third of a second for the largest. dispatch() throws Error then.
    static ComputeProgram builtAtFirstUse(const Device& device, const std::string& shader,
                                          const Constants& constants = {});
    /// Makes the program from SPIR-V; `name` is for messages.
    ComputeProgram(const Device& device, std::span<const uint32_t> code, const std::string& name,
                   const Constants& constants = {});

    /// Binds, pushes and dispatches. The caller writes the barriers.
    template<typename Push>
    void dispatch(VkCommandBuffer cmd, const Push& push, uint32_t x, uint32_t y = 1, uint32_t z = 1) const {
        static_assert(sizeof(Push) <= 128 && sizeof(Push) % 4 == 0);
        dispatchBytes(cmd, &push, sizeof(Push), x, y, z);
    }

private:
    void dispatchBytes(VkCommandBuffer cmd, const void* push, uint32_t size, uint32_t x, uint32_t y,
                       uint32_t z) const;
    const Device* device_ = nullptr;
    std::string shader_; // of builtAtFirstUse, else ""
    Constants constants_;
    mutable std::shared_ptr<const ComputePipeline> pipeline_;
};

/// A ray tracing pipeline: one raygen, one miss, one hit group (closest hit and any hit, either may be "").
class RayProgram {
public:
    struct Desc {
        std::string raygen, miss, closestHit, anyHit; // shader names
        Constants constants = {};                     // of the raygen shader
    };
    RayProgram() = default;
    RayProgram(const Device& device, const Desc& desc); // throws Error
    ~RayProgram();
    RayProgram(RayProgram&& other) noexcept;
    RayProgram& operator=(RayProgram&& other) noexcept;

    template<typename Push>
    void trace(VkCommandBuffer cmd, const Push& push, uint32_t width, uint32_t height) const {
        static_assert(sizeof(Push) <= 128 && sizeof(Push) % 4 == 0);
        traceBytes(cmd, &push, sizeof(Push), width, height);
    }

private:
    void traceBytes(VkCommandBuffer cmd, const void* push, uint32_t size, uint32_t width,
                    uint32_t height) const;
    void create(const Desc& desc);
    void createTable();
    void release();
    const Device* device_ = nullptr;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
    Buffer table_;
    VkStridedDeviceAddressRegionKHR raygenRegion_{}, missRegion_{}, hitRegion_{};
};

/// A vertex and a fragment shader drawing triangles into colour images of one size: no depth, no culling, no
/// blending, no vertex input (vertices are pulled by address). Textures are an array of combined image
/// samplers at set 0, binding 0.
class RasterProgram {
public:
    struct Desc {
        std::string vertex, fragment;  // shader names
        std::vector<VkFormat> formats; // of the colour attachments, at most 8; none: fragments write buffers
        uint32_t textureCount = 0;
        Constants constants = {}; // of both shaders
    };
    struct BoundTexture {
        VkImageView view = VK_NULL_HANDLE;
        VkSampler sampler = VK_NULL_HANDLE;
    };
    RasterProgram(const Device& device, const Desc& desc,
                  std::span<const BoundTexture> textures); // throws Error
    ~RasterProgram();
    RasterProgram(const RasterProgram&) = delete;
    RasterProgram& operator=(const RasterProgram&) = delete;

    /// The pixels in `area` of an image of the viewport's size are drawn; targets need not reach further.
    struct Window {
        VkExtent2D viewport{};
        VkRect2D area{};
    };
    /// Clears the area of all targets to zero, draws `vertexCount` vertices and leaves the targets in
    /// TRANSFER_SRC_OPTIMAL. Targets may be in any layout, their content is lost. Framebuffers live until the
    /// next draw or the destructor.
    template<typename Push>
    void draw(VkCommandBuffer cmd, const Push& push, std::span<const Image2D* const> targets,
              uint32_t vertexCount, const Window& window) {
        static_assert(sizeof(Push) <= 128 && sizeof(Push) % 4 == 0);
        ASSERT(!targets.empty());
        drawBytes(cmd, {&push, sizeof(Push)}, targets, window, vertexCount);
    }
    /// Draws over the whole of the targets.
    template<typename Push>
    void draw(VkCommandBuffer cmd, const Push& push, std::span<const Image2D* const> targets,
              uint32_t vertexCount) {
        ASSERT(!targets.empty());
        const VkExtent2D whole{targets[0]->width(), targets[0]->height()};
        draw(cmd, push, targets, vertexCount, {.viewport = whole, .area = {{0, 0}, whole}});
    }
    /// Draws without colour attachments over extent.width x extent.height pixels: the fragments write into
    /// buffers. The caller writes the barrier behind it.
    template<typename Push>
    void draw(VkCommandBuffer cmd, const Push& push, VkExtent2D extent, uint32_t vertexCount) {
        static_assert(sizeof(Push) <= 128 && sizeof(Push) % 4 == 0);
        drawBytes(cmd, {&push, sizeof(Push)}, {}, {.viewport = extent, .area = {{0, 0}, extent}},
                  vertexCount);
    }

private:
    struct Bytes {
        const void* data = nullptr;
        uint32_t size = 0;
    };
    void drawBytes(VkCommandBuffer cmd, Bytes push, std::span<const Image2D* const> targets,
                   const Window& window, uint32_t vertexCount);
    void createDescriptors(uint32_t count, std::span<const BoundTexture> textures);
    void createRenderPass(std::span<const VkFormat> formats);
    void createPipeline(const Desc& desc);
    void release();
    const Device& device_;
    VkRenderPass renderPass_ = VK_NULL_HANDLE;
    VkDescriptorSetLayout setLayout_ = VK_NULL_HANDLE;
    VkDescriptorPool pool_ = VK_NULL_HANDLE;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
    VkFramebuffer framebuffer_ = VK_NULL_HANDLE;
};

/// Owns a VkSampler; move-only.
class Sampler {
public:
    Sampler() = default;
    Sampler(const Device& device, VkFilter filter, VkSamplerAddressMode u, VkSamplerAddressMode v,
            float maxAnisotropy);
    ~Sampler();
    Sampler(Sampler&& other) noexcept;
    Sampler& operator=(Sampler&& other) noexcept;
    VkSampler handle() const { return sampler_; }

private:
    void release();
    const Device* device_ = nullptr;
    VkSampler sampler_ = VK_NULL_HANDLE;
};

} // namespace relume::vk
