// A thousand maps of one value each go from a thread that writes to one that draws: none is torn, and none is
// an older one.
#include "app/viewer/picture/lightmap_bridge.h"
#include "assets/generate/generate.h"
#include "bake/show/publisher.h"
#include "renderer/gl/framebuffer.h"
#include "renderer/gl/program.h"
#include "renderer/gl/vertex_array.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gl_environment.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>
#include <glm/gtc/packing.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <thread>

namespace relume {
namespace {

constexpr uint32_t kSwapSize = 128;
constexpr uint32_t kMaps = 1000; // up to 2048 every whole number is a half

/// Stands for the bake thread: it writes and publishes 1, 2, 3 and so on.
class Writer {
public:
    Writer(LightmapExchange& exchange, bool shared)
        : exchange_(exchange), shared_(shared),
          baker_(makeBaker(generateScene("cornell_small"), {.size = kSwapSize})),
          publisher_(testDevice(), baker_->patches(), {}), light_(baker_->patches().scene.patches.size()),
          values_(vk::makeBuffer(testDevice(), light_, "light")) {
        MapOffer offer{.set = 1, .size = kSwapSize, .shared = shared};
        for (uint32_t slot = 0; shared && slot < Publisher::kSlots; ++slot) {
            images_[slot] =
                vk::SharedImage(testDevice(), {.width = kSwapSize, .height = kSwapSize, .name = "swap"});
            offer.fds[slot] = images_[slot].exportFd();
            offer.memorySize = images_[slot].memorySize();
        }
        exchange.offer(offer);
    }

    void run(const std::atomic<bool>& stop) {
        for (uint32_t n = 1; n <= kMaps && !stop;) {
            const auto slot = exchange_.claim();
            if (slot)
                write(*slot, n++);
            else
                std::this_thread::yield();
        }
    }

private:
    void write(uint32_t slot, uint32_t n) {
        std::fill(light_.begin(), light_.end(), glm::vec4(static_cast<float>(n)));
        vk::upload(testDevice(), values_, light_.data(), light_.size() * sizeof(glm::vec4));
        publisher_.update({.values = values_, .chunks = publisher_.allChunks()});
        const auto areas = shared_ ? publisher_.publish(images_[slot], slot)
                                   : publisher_.publish(exchange_.memory(slot), slot);
        RowRange rows;
        for (const TexelArea& area : areas)
            rows.add({area.y, area.y + area.height});
        exchange_.publish({.slot = slot, .set = 1, .bake = n, .changed = rows});
    }

    LightmapExchange& exchange_;
    bool shared_;
    std::unique_ptr<Baker> baker_;
    Publisher publisher_;
    std::vector<glm::vec4> light_;
    vk::Buffer values_;
    std::array<vk::SharedImage, Publisher::kSlots> images_;
};

GLuint compiled(GLenum stage, const char* source) {
    const GLuint shader = glCreateShader(stage);
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    return shader;
}

/// Makes pictures of the map without waiting for the device, as a viewer does, to be looked at later.
class Pictures {
public:
    Pictures() : program_(glCreateProgram()), empty_({.attributes = {}, .name = "pictures"}) {
        for (gl::Framebuffer& picture : pictures_)
            picture = gl::Framebuffer(
                {.width = kSwapSize, .height = kSwapSize, .color = GL_RGBA32F, .name = "seen"});
        const std::array<GLuint, 2> shaders = {
            compiled(GL_VERTEX_SHADER, "#version 450\n"
                                       "void main() {\n"
                                       "    float x = gl_VertexID == 1 ? 3.0 : -1.0;\n"
                                       "    gl_Position = vec4(x, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);\n"
                                       "}\n"),
            compiled(GL_FRAGMENT_SHADER,
                     "#version 450\n"
                     "layout(binding = 0) uniform sampler2D map;\n"
                     "layout(location = 0) out vec4 color;\n"
                     "void main() { color = texelFetch(map, ivec2(gl_FragCoord.xy), 0); }\n")};
        for (const GLuint shader : shaders)
            glAttachShader(program_.get(), shader);
        glLinkProgram(program_.get());
        for (const GLuint shader : shaders)
            glDeleteShader(shader);
    }

    // The framebuffer stays bound: a software device then puts the drawing off until it is asked for it.
    void draw(const LightmapTexture& map, uint64_t n) {
        glBindFramebuffer(GL_FRAMEBUFFER, picture(n).get());
        glViewport(0, 0, kSwapSize, kSwapSize);
        glDisable(GL_DEPTH_TEST);
        glDisable(GL_BLEND);
        glBindTextureUnit(0, map.texture);
        glUseProgram(program_.get());
        glBindVertexArray(empty_.get());
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }

    /// Counts the texels of picture n that are not n.
    uint32_t wrong(uint64_t n) {
        texels_.resize(size_t{kSwapSize} * kSwapSize);
        glGetTextureImage(picture(n).color().get(), 0, GL_RGBA, GL_FLOAT,
                          static_cast<GLsizei>(texels_.size() * sizeof(glm::vec4)), texels_.data());
        const auto want = static_cast<float>(n);
        uint32_t wrong = 0, covered = 0;
        for (const glm::vec4& texel : texels_) {
            // Filled texels are means of equal halves, exact but for the division.
            const float room = texel.a == 1.0f ? 0.0f : texel.a == 0.5f ? 1e-3f * want : 0.0f;
            const glm::vec3 expected = texel.a > 0.0f ? glm::vec3(want) : glm::vec3(0.0f);
            for (int c = 0; c < 3; ++c)
                wrong += !(std::abs(texel[c] - expected[c]) <= room);
            covered += texel.a == 1.0f;
        }
        EXPECT_GT(covered, kSwapSize * kSwapSize / 4);
        return wrong;
    }

private:
    const gl::Framebuffer& picture(uint64_t n) const { return pictures_[n % pictures_.size()]; }

    gl::Handle<gl::deleteProgram> program_;
    gl::VertexArray empty_; // without vertices
    std::array<gl::Framebuffer, 2> pictures_;
    std::vector<glm::vec4> texels_;
};

/// Runs the drawing thread: each picture is looked at when the next map is there already.
void expectNoTear(bool shared) {
    testContext();
    LightmapExchange exchange;
    Writer writer(exchange, shared);
    LightmapBridge bridge(exchange);
    Pictures pictures;
    std::atomic<bool> stop = false;
    std::thread thread([&] { writer.run(stop); });
    uint32_t torn = 0, swaps = 0, outOfOrder = 0;
    uint64_t newest = 0;
    for (const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(4);
         newest < kMaps && std::chrono::steady_clock::now() < end;) {
        if (!bridge.update()) {
            std::this_thread::yield();
            continue;
        }
        outOfOrder += bridge.map()->bake != newest + 1;
        newest = bridge.map()->bake;
        ++swaps;
        // A frame does other things, too. Meanwhile what the last picture reads must not be written: until
        // now nobody but the bridge has asked the driver to draw it.
        if (newest % 4 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(3));
        if (newest > 1) torn += pictures.wrong(newest - 1) > 0;
        pictures.draw(bridge.texture(), newest);
    }
    stop = true;
    thread.join();
    torn += newest > 0 && pictures.wrong(newest) > 0;
    EXPECT_EQ(swaps, kMaps);
    EXPECT_EQ(outOfOrder, 0u);
    EXPECT_EQ(torn, 0u);
}

TEST(DisplaySwap, NoSharedImageIsTornInAThousandSwaps) {
    if (!vk::SharedImage::possible(testDevice(), kSwapSize, kSwapSize))
        GTEST_SKIP() << "images cannot be shared";
    testContext();
    const gl::GlSharing sharing = gl::querySharing();
    const auto& uuids = sharing.deviceUuids;
    if (std::find(uuids.begin(), uuids.end(), testDevice().info().uuid) == uuids.end())
        GTEST_SKIP() << "OpenGL draws on another device";
    expectNoTear(true);
}

TEST(DisplaySwap, NoCopyIsTornInAThousandSwaps) {
    expectNoTear(false);
}

} // namespace
} // namespace relume
