#include "bake/vk/image.h"

#include "bake/vk/commands.h"
#include "bake/vk/memory.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace relume::vk {

namespace {

VkImageMemoryBarrier layoutChange(const Image2D& image, uint32_t firstMip, uint32_t mipCount,
                                  VkImageLayout from, VkImageLayout to) {
    VkImageMemoryBarrier change{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
    change.srcAccessMask =
        from == VK_IMAGE_LAYOUT_UNDEFINED ? 0 : VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
    change.dstAccessMask = to == VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL
                               ? VkAccessFlags{VK_ACCESS_SHADER_READ_BIT}
                               : VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
    change.oldLayout = from;
    change.newLayout = to;
    change.srcQueueFamilyIndex = change.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    change.image = image.handle();
    change.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, firstMip, mipCount, 0, 1};
    return change;
}

void changeLayout(VkCommandBuffer cmd, const VkImageMemoryBarrier& change) {
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0,
                         nullptr, 0, nullptr, 1, &change);
}

// Blits each mip from the one above, at half its size; leaves every mip in TRANSFER_SRC_OPTIMAL.
void recordMips(VkCommandBuffer cmd, const Device& device, const Image2D& image) {
    VkFormatProperties format;
    vkGetPhysicalDeviceFormatProperties(device.physical(), image.format(), &format);
    const bool linear =
        (format.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT) != 0;
    auto width = static_cast<int32_t>(image.width()), height = static_cast<int32_t>(image.height());
    for (uint32_t mip = 0; mip < image.mips(); ++mip) {
        changeLayout(cmd, layoutChange(image, mip, 1, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                       VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL));
        if (mip + 1 == image.mips()) break;
        const int32_t nextWidth = std::max(1, width / 2), nextHeight = std::max(1, height / 2);
        VkImageBlit blit{};
        blit.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, mip, 0, 1};
        blit.srcOffsets[1] = {width, height, 1};
        blit.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, mip + 1, 0, 1};
        blit.dstOffsets[1] = {nextWidth, nextHeight, 1};
        vkCmdBlitImage(cmd, image.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, image.handle(),
                       VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit,
                       linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST);
        width = nextWidth;
        height = nextHeight;
    }
}

} // namespace

Image2D::Image2D(const Device& device, const Desc& desc)
    : device_(&device), width_(desc.width), height_(desc.height), mips_(desc.mips), format_(desc.format) {
    ASSERT(desc.width > 0 && desc.height > 0 && desc.mips > 0);
    try {
        create(desc);
    } catch (...) {
        release();
        throw;
    }
}

void Image2D::create(const Desc& desc) {
    const std::string what = std::string("image '") + desc.name + "' of " + std::to_string(desc.width) +
                             " x " + std::to_string(desc.height);
    const uint32_t limit = device_->limits().maxImageDimension2D;
    if (desc.width > limit || desc.height > limit)
        throw Error(device_->info().name + ": " + what + " is too large: at most " + std::to_string(limit) +
                    " texels a side");
    VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = desc.format;
    info.extent = {desc.width, desc.height, 1};
    info.mipLevels = desc.mips;
    info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.tiling = VK_IMAGE_TILING_OPTIMAL;
    info.usage = desc.usage | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    checkMemory(*device_, vkCreateImage(device_->handle(), &info, nullptr, &image_), "vkCreateImage", what);

    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(device_->handle(), image_, &needs);
    memory_ = allocateMemory(*device_, {.size = needs.size,
                                        .type = device_->deviceMemoryType(needs.memoryTypeBits),
                                        .name = desc.name,
                                        .what = what});
    VK_CHECK(vkBindImageMemory(device_->handle(), image_, memory_.handle(), 0));
    device_->setName(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<uint64_t>(image_), desc.name);

    constexpr VkImageUsageFlags viewed = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT |
                                         VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                                         VK_IMAGE_USAGE_INPUT_ATTACHMENT_BIT;
    if ((desc.usage & viewed) == 0) return; // a view of a mere copy target is not allowed
    VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    view.image = image_;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = desc.format;
    view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, desc.mips, 0, 1};
    VK_CHECK(vkCreateImageView(device_->handle(), &view, nullptr, &view_));
}

Image2D::~Image2D() {
    release();
}

Image2D::Image2D(Image2D&& other) noexcept {
    *this = std::move(other);
}

Image2D& Image2D::operator=(Image2D&& other) noexcept {
    if (this == &other) return *this;
    release();
    device_ = std::exchange(other.device_, nullptr);
    image_ = std::exchange(other.image_, VK_NULL_HANDLE);
    memory_ = std::move(other.memory_);
    view_ = std::exchange(other.view_, VK_NULL_HANDLE);
    width_ = std::exchange(other.width_, 0);
    height_ = std::exchange(other.height_, 0);
    mips_ = std::exchange(other.mips_, 0);
    format_ = std::exchange(other.format_, VK_FORMAT_UNDEFINED);
    return *this;
}

void Image2D::release() {
    if (device_ == nullptr) return;
    vkDestroyImageView(device_->handle(), view_, nullptr);
    vkDestroyImage(device_->handle(), image_, nullptr);
    memory_.release();
}

void uploadPixels(const Device& device, const Image2D& image, const void* pixels, VkDeviceSize size) {
    const Buffer staging(device, {.size = size, .memory = Memory::Host, .name = "pixels"});
    std::memcpy(staging.mapped(), pixels, size);
    Commands commands(device);
    VkCommandBuffer cmd = commands.begin();
    changeLayout(cmd, layoutChange(image, 0, image.mips(), VK_IMAGE_LAYOUT_UNDEFINED,
                                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL));
    VkBufferImageCopy region{};
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageExtent = {image.width(), image.height(), 1};
    vkCmdCopyBufferToImage(cmd, staging.handle(), image.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                           &region);
    recordMips(cmd, device, image);
    changeLayout(cmd, layoutChange(image, 0, image.mips(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                   VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL));
    commands.run();
}

} // namespace relume::vk
