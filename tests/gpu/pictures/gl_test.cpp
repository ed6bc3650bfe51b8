// This tests the owners of OpenGL's objects that a viewer needs: fences, mapped buffers, readbacks, timers.
#include "renderer/gl/fence.h"
#include "renderer/gl/pixel_buffer.h"
#include "renderer/gl/readback.h"
#include "renderer/gl/shared_texture.h"
#include "renderer/gl/timer.h"
#include "tests/gpu/gl_environment.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>
#include <vector>

#include <glm/gtc/packing.hpp>

namespace relume {
namespace {

gl::Framebuffer cleared(uint32_t size, const glm::vec4& color) {
    gl::Framebuffer framebuffer({.width = size, .height = size, .color = GL_RGBA32F, .name = "test"});
    glClearNamedFramebufferfv(framebuffer.get(), GL_COLOR, 0, &color.x);
    return framebuffer;
}

TEST(Gl, FencesTellWhenCommandsAreDone) {
    testContext();
    gl::Fence none;
    EXPECT_TRUE(none.signalled());
    const gl::Framebuffer target = cleared(64, glm::vec4(1));
    gl::Fence fence = gl::Fence::insert();
    fence.wait();
    EXPECT_TRUE(fence.signalled());
    gl::Fence other = gl::Fence::insert();
    fence = std::move(other);
    EXPECT_TRUE(other.signalled()); // NOLINT(bugprone-use-after-move): counts as none
    glFinish();
    EXPECT_TRUE(fence.signalled());
}

/// Returns the texels of a texture of half floats, as numbers.
std::vector<glm::vec4> texelsOf(const gl::Texture& texture) {
    std::vector<glm::vec4> texels(size_t{texture.width()} * texture.height());
    glGetTextureImage(texture.get(), 0, GL_RGBA, GL_FLOAT,
                      static_cast<GLsizei>(texels.size() * sizeof(texels[0])), texels.data());
    return texels;
}

TEST(Gl, PixelBuffersUploadWhatIsAskedFor) {
    testContext();
    constexpr uint32_t kSize = 16;
    const gl::PixelBuffer buffer({.width = kSize, .height = kSize, .name = "test"});
    gl::Texture texture({.width = kSize, .height = kSize, .format = GL_RGBA16F, .name = "test"});
    const std::vector<glm::vec4> zeros(size_t{kSize} * kSize, glm::vec4(0));
    texture.upload(GL_RGBA, GL_FLOAT, zeros.data());
    ASSERT_EQ(buffer.bytes().size(), gl::PixelBuffer::kTexelBytes * kSize * kSize);
    // Another thread writes them, as a baker does.
    std::thread([bytes = buffer.bytes()] {
        for (uint32_t i = 0; i < kSize * kSize; ++i) {
            const uint64_t texel = glm::packHalf4x16(glm::vec4(static_cast<float>(i), 1, 2, 1));
            std::memcpy(bytes.data() + 8 * i, &texel, sizeof(texel));
        }
    }).join();
    buffer.uploadRows(texture.get(), 3, 2);
    buffer.upload(texture.get(), {.x = 5, .y = 9, .width = 4, .height = 3});
    buffer.upload(texture.get(), {.x = 5, .y = 9, .width = 0, .height = 3});
    const std::vector<glm::vec4> texels = texelsOf(texture);
    for (uint32_t y = 0; y < kSize; ++y) {
        for (uint32_t x = 0; x < kSize; ++x) {
            const bool asked = (y >= 3 && y < 5) || (x >= 5 && x < 9 && y >= 9 && y < 12);
            const auto i = static_cast<float>(y * kSize + x);
            EXPECT_EQ(texels[y * kSize + x], asked ? glm::vec4(i, 1, 2, 1) : glm::vec4(0)) << x << " " << y;
        }
    }
}

TEST(Gl, ReadbacksArriveOnce) {
    testContext();
    gl::Readback readback({.size = 16 * 8 * 8, .name = "test"});
    EXPECT_FALSE(readback.poll());
    const glm::vec4 first(1, 2, 3, 4), second(5, 6, 7, 8);
    readback.request(cleared(8, first), GL_RGBA, GL_FLOAT);
    readback.request(cleared(8, second), GL_RGBA, GL_FLOAT); // in the first one's place
    EXPECT_TRUE(readback.pending());
    std::optional<std::span<const std::byte>> bytes;
    for (int i = 0; i < 2000 && !bytes; ++i) {
        bytes = readback.poll();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ASSERT_TRUE(bytes);
    std::array<glm::vec4, 64> pixels{};
    ASSERT_EQ(bytes->size(), sizeof(pixels));
    std::memcpy(pixels.data(), bytes->data(), sizeof(pixels));
    for (const glm::vec4& pixel : pixels)
        EXPECT_EQ(pixel, second);
    EXPECT_FALSE(readback.poll());
    readback.request(cleared(8, first), GL_RGBA, GL_FLOAT);
    std::memcpy(pixels.data(), readback.wait().data(), sizeof(pixels));
    EXPECT_EQ(pixels.back(), first);
    EXPECT_FALSE(readback.pending());
}

TEST(Gl, TimersKnowPassesFramesLater) {
    testContext();
    gl::Timer timer;
    const gl::Framebuffer target = cleared(512, glm::vec4(0));
    const auto frame = [&] {
        {
            const gl::Timer::Scope outer(timer, "outer");
            const gl::Timer::Scope inner(timer, "inner");
            const glm::vec4 color(1);
            glClearNamedFramebufferfv(target.get(), GL_COLOR, 0, &color.x);
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        timer.endFrame();
    };
    for (int i = 0; i < 20; ++i) // more than it keeps: a device that is behind is not waited for
        frame();
    glFinish();
    timer.endFrame();
    ASSERT_EQ(timer.passes().size(), 2u);
    EXPECT_EQ(timer.passes()[0].name, "outer");
    EXPECT_EQ(timer.passes()[1].name, "inner");
    for (const gl::Timer::Pass& pass : timer.passes()) {
        EXPECT_GE(pass.cpuMs, 2.0);
        EXPECT_GE(pass.gpuMs, 0.0);
        EXPECT_LT(pass.gpuMs, 5000.0);
    }
    EXPECT_GE(timer.passes()[0].cpuMs, timer.passes()[1].cpuMs);
}

TEST(Gl, TimersOfFramesThatNobodyEndsStaySmall) {
    testContext();
    gl::Timer timer;
    for (size_t i = 0; i < 2 * gl::Timer::kMostPasses; ++i)
        const gl::Timer::Scope pass(timer, "pass");
    timer.endFrame();
    glFinish();
    timer.endFrame();
    EXPECT_EQ(timer.passes().size(), gl::Timer::kMostPasses);
}

TEST(Gl, KnowsWhichDevicesItCanShareWith) {
    testContext();
    const gl::GlSharing sharing = gl::querySharing();
    if (!sharing.memoryObject) GTEST_SKIP() << "no GL_EXT_memory_object_fd";
    ASSERT_FALSE(sharing.deviceUuids.empty());
    EXPECT_NE(sharing.deviceUuids[0], (std::array<uint8_t, 16>{}));
}

} // namespace
} // namespace relume
