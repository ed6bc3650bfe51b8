#include "tests/gpu/gl_environment.h"

#include "renderer/gl/debug.h"
#include "renderer/picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

namespace relume {
namespace {

std::unique_ptr<gl::HeadlessContext>& context() {
    static std::unique_ptr<gl::HeadlessContext> instance;
    return instance;
}

class ContextLifetime final : public testing::Environment {
public:
    void TearDown() override { context().reset(); }
};

class MessageListener final : public testing::EmptyTestEventListener {
    void OnTestStart(const testing::TestInfo&) override { seen_ = gl::debugMessageCount(); }
    void OnTestEnd(const testing::TestInfo&) override {
        EXPECT_EQ(gl::debugMessageCount(), seen_) << "OpenGL debug messages, see the log above";
    }
    uint32_t seen_ = 0;
};

[[maybe_unused]] const bool glRegistered = [] {
    testing::AddGlobalTestEnvironment(new ContextLifetime);
    testing::UnitTest::GetInstance()->listeners().Append(new MessageListener);
    return true;
}();

} // namespace

const gl::HeadlessContext& testContext() {
    if (!context())
        context() = std::make_unique<gl::HeadlessContext>(gl::HeadlessContext::Desc{.debug = true});
    return *context();
}

glm::ivec3 Picture::pixel(uint32_t x, uint32_t y) const {
    glm::ivec3 rgb;
    for (int c = 0; c < 3; ++c) {
        const float linear = image.planes[static_cast<size_t>(c)][size_t{y} * image.width + x];
        rgb[c] = static_cast<int>(std::lround(255.0 * srgbFromLinear(linear)));
    }
    return rgb;
}

Picture drawPicture(const PictureDesc& desc) {
    testContext();
    const WorldMesh mesh =
        flatten(desc.scene, buildAtlas(desc.scene, desc.lightmap ? desc.lightmap->width : 64));
    const SceneGpu scene(desc.scene, mesh);
    std::unique_ptr<LightmapImage> lightmap;
    if (desc.lightmap != nullptr) lightmap = std::make_unique<LightmapImage>(*desc.lightmap, "test lightmap");
    SceneRenderer renderer(desc.samples);
    const gl::Framebuffer target({.width = desc.width, .height = desc.height, .name = "test"});
    renderer.draw({.scene = scene,
                   .lightmap = lightmap ? lightmap->texture() : LightmapTexture{.size = 64},
                   .camera = desc.camera,
                   .settings = desc.settings},
                  {.framebuffer = target.get(), .width = desc.width, .height = desc.height});
    return {readPicture(target), renderer.counts(), renderer.exposure()};
}

} // namespace relume
