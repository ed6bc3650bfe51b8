#include "bake/vk/shared_image.h"

#include "bake/vk/commands.h"
#include "bake/vk/memory.h"

#include <utility>

namespace relume::vk {

namespace {

constexpr VkExternalMemoryHandleTypeFlagBits kHandleType = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT;
// An importer assumes every use that the format allows, not just those made of it here.
constexpr VkImageUsageFlags kUsage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                                     VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT;
constexpr VkImageSubresourceRange kWhole = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};

VkImageMemoryBarrier barrierOf(VkImage image, VkImageLayout from, VkImageLayout to) {
    VkImageMemoryBarrier change{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
    change.oldLayout = from;
    change.newLayout = to;
    change.srcQueueFamilyIndex = change.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    change.image = image;
    change.subresourceRange = kWhole;
    return change;
}

} // namespace

bool SharedImage::possible(const Device& device, uint32_t width, uint32_t height) {
    if (!device.info().externalMemory) return false;
    VkPhysicalDeviceExternalImageFormatInfo external{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_EXTERNAL_IMAGE_FORMAT_INFO};
    external.handleType = kHandleType;
    VkPhysicalDeviceImageFormatInfo2 format{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_IMAGE_FORMAT_INFO_2, &external};
    format.format = kFormat;
    format.type = VK_IMAGE_TYPE_2D;
    format.tiling = VK_IMAGE_TILING_OPTIMAL;
    format.usage = kUsage;
    VkExternalImageFormatProperties sharing{VK_STRUCTURE_TYPE_EXTERNAL_IMAGE_FORMAT_PROPERTIES};
    VkImageFormatProperties2 properties{VK_STRUCTURE_TYPE_IMAGE_FORMAT_PROPERTIES_2, &sharing};
    if (vkGetPhysicalDeviceImageFormatProperties2(device.physical(), &format, &properties) != VK_SUCCESS)
        return false;
    const VkExtent3D largest = properties.imageFormatProperties.maxExtent;
    return width <= largest.width && height <= largest.height &&
           (sharing.externalMemoryProperties.externalMemoryFeatures &
            VK_EXTERNAL_MEMORY_FEATURE_EXPORTABLE_BIT) != 0;
}

SharedImage::SharedImage(const Device& device, const Desc& desc)
    : device_(&device), width_(desc.width), height_(desc.height) {
    ASSERT(desc.width > 0 && desc.height > 0);
    if (!possible(device, width_, height_)) {
        throw Error(device.info().name + ": cannot share images of " + std::to_string(width_) + " x " +
                    std::to_string(height_) + " with OpenGL: pass --display copied");
    }
    try {
        create(desc);
        clear();
    } catch (...) {
        destroy();
        throw;
    }
}

void SharedImage::create(const Desc& desc) {
    const std::string what = std::string("shared image '") + desc.name + "' of " +
                             std::to_string(desc.width) + " x " + std::to_string(desc.height);
    VkExternalMemoryImageCreateInfo external{VK_STRUCTURE_TYPE_EXTERNAL_MEMORY_IMAGE_CREATE_INFO};
    external.handleTypes = kHandleType;
    VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, &external};
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = kFormat;
    info.extent = {desc.width, desc.height, 1};
    info.mipLevels = 1;
    info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.tiling = VK_IMAGE_TILING_OPTIMAL;
    info.usage = kUsage;
    checkMemory(*device_, vkCreateImage(device_->handle(), &info, nullptr, &image_), "vkCreateImage", what);

    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(device_->handle(), image_, &needs);
    memorySize_ = needs.size;
    VkMemoryDedicatedAllocateInfo dedicated{VK_STRUCTURE_TYPE_MEMORY_DEDICATED_ALLOCATE_INFO};
    dedicated.image = image_;
    VkExportMemoryAllocateInfo exported{VK_STRUCTURE_TYPE_EXPORT_MEMORY_ALLOCATE_INFO, &dedicated};
    exported.handleTypes = kHandleType;
    memory_ = allocateMemory(*device_, {.size = needs.size,
                                        .type = device_->deviceMemoryType(needs.memoryTypeBits),
                                        .chain = &exported,
                                        .name = desc.name,
                                        .what = what});
    VK_CHECK(vkBindImageMemory(device_->handle(), image_, memory_.handle(), 0));
    device_->setName(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<uint64_t>(image_), desc.name);
}

void SharedImage::clear() {
    Commands commands(*device_);
    VkCommandBuffer cmd = commands.begin();
    VkImageMemoryBarrier start =
        barrierOf(image_, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    start.dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0,
                         nullptr, 0, nullptr, 1, &start);
    const VkClearColorValue black{};
    vkCmdClearColorImage(cmd, image_, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &black, 1, &kWhole);
    release(cmd);
    commands.run();
}

void SharedImage::acquire(VkCommandBuffer cmd) const {
    VkImageMemoryBarrier change =
        barrierOf(image_, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    change.dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
    change.srcQueueFamilyIndex = VK_QUEUE_FAMILY_EXTERNAL;
    change.dstQueueFamilyIndex = device_->queueFamily();
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, nullptr,
                         0, nullptr, 1, &change);
}

void SharedImage::release(VkCommandBuffer cmd) const {
    VkImageMemoryBarrier change =
        barrierOf(image_, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_GENERAL);
    change.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    change.srcQueueFamilyIndex = device_->queueFamily();
    change.dstQueueFamilyIndex = VK_QUEUE_FAMILY_EXTERNAL;
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, 0, 0,
                         nullptr, 0, nullptr, 1, &change);
}

int SharedImage::exportFd() const {
    VkMemoryGetFdInfoKHR info{VK_STRUCTURE_TYPE_MEMORY_GET_FD_INFO_KHR};
    info.memory = memory_.handle();
    info.handleType = kHandleType;
    int fd = -1;
    VK_CHECK(vkGetMemoryFdKHR(device_->handle(), &info, &fd));
    return fd;
}

SharedImage::~SharedImage() {
    destroy();
}

SharedImage::SharedImage(SharedImage&& other) noexcept {
    *this = std::move(other);
}

SharedImage& SharedImage::operator=(SharedImage&& other) noexcept {
    if (this == &other) return *this;
    destroy();
    device_ = std::exchange(other.device_, nullptr);
    image_ = std::exchange(other.image_, VK_NULL_HANDLE);
    memory_ = std::move(other.memory_);
    memorySize_ = std::exchange(other.memorySize_, 0);
    width_ = std::exchange(other.width_, 0);
    height_ = std::exchange(other.height_, 0);
    return *this;
}

void SharedImage::destroy() {
    if (device_ == nullptr) return;
    vkDestroyImage(device_->handle(), image_, nullptr);
    memory_.release();
}

} // namespace relume::vk
