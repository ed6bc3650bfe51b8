#pragma once

#include "bake/vk/buffer.h"

namespace relume::vk {

/// Owns a 2D VkImage, its memory and a view of all its mips; move-only. It is always usable as transfer
/// source and target.
class Image2D {
public:
    struct Desc {
        uint32_t width = 0, height = 0; // > 0
        uint32_t mips = 1;
        VkFormat format = VK_FORMAT_R8G8B8A8_UNORM;
        VkImageUsageFlags usage = 0;
        const char* name = "";
    };
    Image2D() = default;
    Image2D(const Device& device, const Desc& desc); // throws Error
    ~Image2D();
    Image2D(Image2D&& other) noexcept;
    Image2D& operator=(Image2D&& other) noexcept;

    VkImage handle() const { return image_; }
    VkImageView view() const { return view_; }
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    uint32_t mips() const { return mips_; }
    VkFormat format() const { return format_; }

private:
    void create(const Desc& desc);
    void release();
    const Device* device_ = nullptr;
    VkImage image_ = VK_NULL_HANDLE;
    MemoryBlock memory_;
    VkImageView view_ = VK_NULL_HANDLE;
    uint32_t width_ = 0, height_ = 0, mips_ = 0;
    VkFormat format_ = VK_FORMAT_UNDEFINED;
};

/// Uploads tightly packed pixels to mip 0, blits the other mips and leaves the image in
/// SHADER_READ_ONLY_OPTIMAL. Waits for the device.
void uploadPixels(const Device& device, const Image2D& image, const void* pixels, VkDeviceSize size);

} // namespace relume::vk
