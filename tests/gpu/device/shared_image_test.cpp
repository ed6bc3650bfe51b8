#include "bake/vk/commands.h"
#include "bake/vk/shared_image.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/gpu/read_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include <sys/stat.h>
#include <unistd.h>

namespace relume {
namespace {

void writeRed(const vk::SharedImage& image, float red) {
    vk::Commands commands(testDevice());
    VkCommandBuffer cmd = commands.begin();
    image.acquire(cmd);
    const VkClearColorValue color{.float32 = {red, 0, 0, 1}};
    const VkImageSubresourceRange whole = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(cmd, image.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &color, 1, &whole);
    image.release(cmd);
    commands.run();
}

TEST(SharedImage, StartsBlackAndKeepsWhatIsWritten) {
    if (!vk::SharedImage::possible(testDevice(), 40, 24)) GTEST_SKIP() << "images cannot be shared";
    const vk::SharedImage image(testDevice(), {.width = 40, .height = 24, .name = "shared"});
    EXPECT_GE(image.memorySize(), 40u * 24 * 8);
    EXPECT_EQ(readImage(image), std::vector<uint64_t>(40 * 24, 0));
    writeRed(image, 0.5f);
    const uint64_t halves = 0x3c00'0000'0000'3800u; // 1, 0, 0, 0.5
    EXPECT_EQ(readImage(image), std::vector<uint64_t>(40 * 24, halves));
    EXPECT_EQ(readImage(image), std::vector<uint64_t>(40 * 24, halves)); // reading changes nothing
}

TEST(SharedImage, ExportsADescriptorEachTime) {
    if (!vk::SharedImage::possible(testDevice(), 16, 16)) GTEST_SKIP() << "images cannot be shared";
    vk::SharedImage image(testDevice(), {.width = 16, .height = 16, .name = "shared"});
    const vk::SharedImage moved = std::move(image);
    const int first = moved.exportFd(), second = moved.exportFd();
    struct stat status {};
    EXPECT_NE(first, second);
    for (int fd : {first, second}) {
        EXPECT_EQ(fstat(fd, &status), 0);
        EXPECT_EQ(close(fd), 0);
    }
    EXPECT_EQ(readImage(moved).size(), 256u);
}

TEST(SharedImage, RefusesWhatTheDeviceCannotShare) {
    EXPECT_FALSE(vk::SharedImage::possible(testDevice(), 1u << 20, 16));
    try {
        const vk::SharedImage image(testDevice(), {.width = 1u << 20, .height = 16, .name = "huge"});
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("--display copied"), std::string::npos) << error.what();
    }
}

} // namespace
} // namespace relume
