#pragma once

#include "bake/vk/memory_block.h"

namespace relume::vk {

/// An RGBA16F image in memory of its own that another API (OpenGL) can import by a file descriptor: optimal
/// tiling, one mip, for the other API always in layout GENERAL. Owns image and memory; move-only. It starts
/// black and belongs to the other API unless it is between acquire() and release(); host-side
/// synchronisation is enough for both.
class SharedImage {
public:
    struct Desc {
        uint32_t width = 0, height = 0; // > 0
        const char* name = "";
    };
    static constexpr VkFormat kFormat = VK_FORMAT_R16G16B16A16_SFLOAT;

    /// Tells whether this device can share images of this size at all.
    [[nodiscard]] static bool possible(const Device& device, uint32_t width, uint32_t height);

    SharedImage() = default;
    SharedImage(const Device& device, const Desc& desc); // throws Error; waits
    ~SharedImage();
    SharedImage(SharedImage&& other) noexcept;
    SharedImage& operator=(SharedImage&& other) noexcept;

    /// Returns a new descriptor of the memory, which is the caller's to close; a successful import takes it.
    /// Throws Error.
    int exportFd() const;
    /// Returns the size [bytes] that the importer must name for the memory.
    VkDeviceSize memorySize() const { return memorySize_; }
    VkImage handle() const { return image_; }
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }

    /// Takes the image over, in layout TRANSFER_DST_OPTIMAL; its content stays.
    void acquire(VkCommandBuffer cmd) const;
    /// Gives it back, from that layout: transfers recorded before are visible to the other API once the
    /// submission is waited for.
    void release(VkCommandBuffer cmd) const;

private:
    void create(const Desc& desc);
    void clear();
    void destroy();

    const Device* device_ = nullptr;
    VkImage image_ = VK_NULL_HANDLE;
    MemoryBlock memory_;
    VkDeviceSize memorySize_ = 0;
    uint32_t width_ = 0, height_ = 0;
};

} // namespace relume::vk
