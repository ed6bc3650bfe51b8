#pragma once

#include <cstdint>
#include <vector>

#include "bake/vk/buffer.h"
#include "bake/vk/commands.h"
#include "bake/vk/shared_image.h"
#include "tests/gpu/gpu_environment.h"

namespace relume {

/// Reads the four halves of each texel of a shared image that nobody else uses now.
inline std::vector<uint64_t> readImage(const vk::SharedImage& image) {
    const size_t count = size_t{image.width()} * image.height();
    const vk::Buffer texels(
        testDevice(), {.size = count * sizeof(uint64_t), .memory = vk::Memory::Host, .name = "read back"});
    vk::Commands commands(testDevice());
    VkCommandBuffer cmd = commands.begin();
    const auto change = [&](VkImageLayout from, VkImageLayout to) {
        VkImageMemoryBarrier barrier{};
        barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER;
        barrier.srcAccessMask = barrier.dstAccessMask =
            VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
        barrier.oldLayout = from;
        barrier.newLayout = to;
        barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
        barrier.image = image.handle();
        barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
        vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0,
                             nullptr, 0, nullptr, 1, &barrier);
    };
    image.acquire(cmd);
    change(VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    VkBufferImageCopy copy{};
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.imageExtent = {image.width(), image.height(), 1};
    vkCmdCopyImageToBuffer(cmd, image.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, texels.handle(), 1,
                           &copy);
    change(VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    image.release(cmd);
    vk::hostBarrier(cmd);
    commands.run();
    const auto* values = texels.as<uint64_t>();
    return {values, values + count};
}

} // namespace relume
