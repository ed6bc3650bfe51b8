// This tests what a viewer asks of the renderer beyond one picture: pictures that are kept, exposure without
// waiting, other materials, samples and shaders at run time, lines and voxels.
#include "assets/base/error.h"
#include "renderer/gl/debug.h"
#include "renderer/picture.h"
#include "shaders/shader_library.h"
#include "tests/gpu/relume_process.h"
#include "tests/gpu/wall_scene.h"
#include "tests/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <cmath>
#include <thread>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

using Metering = SceneRenderer::Metering;

/// Holds a wall with its lightmap, a renderer and a target.
class Viewer {
public:
    explicit Viewer(Metering metering = Metering::Wait, const Material& material = grey(0.5f),
                    const FloatImage& image = lightmapOf(0.5f))
        : scene((testContext(), wall(material).scene())),
          gpu(scene, flatten(scene, buildAtlas(scene, kWallSize))), lightmap(image, "test"),
          renderer(4, metering),
          target({.width = 64, .height = 64, .name = "test"}), frame{.scene = gpu,
                                                                     .lightmap = lightmap.texture(),
                                                                     .camera = before(),
                                                                     .settings = plain()} {}

    SceneRenderer::Target to() const { return {target.get(), target.width(), target.height()}; }
    bool draw() { return renderer.draw(frame, to()); }
    glm::ivec3 pixel(uint32_t x = 32, uint32_t y = 32) const {
        return Picture{readPicture(target), {}, 0}.pixel(x, y);
    }
    /// Draws until the exposure is what the picture asks for.
    void settle() {
        draw();
        for (int i = 0; i < 2000 && renderer.adapting(); ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            draw();
        }
        EXPECT_FALSE(renderer.adapting());
    }

    Scene scene;
    SceneGpu gpu;
    LightmapImage lightmap;
    SceneRenderer renderer;
    gl::Framebuffer target;
    SceneRenderer::Frame frame;
};

TEST(ViewerRenderer, DrawsOnlyWhatChanged) {
    Viewer viewer;
    EXPECT_TRUE(viewer.draw());
    EXPECT_FALSE(viewer.draw());
    viewer.frame.camera = zoom(viewer.frame.camera, 0.5f);
    EXPECT_TRUE(viewer.draw());
    EXPECT_FALSE(viewer.draw());
    viewer.frame.settings.view = View::Normal;
    EXPECT_TRUE(viewer.draw());
    viewer.frame.lightmap.version = newVersion();
    EXPECT_TRUE(viewer.draw());
    EXPECT_FALSE(viewer.draw());
    viewer.frame.lightmap.version = 0; // texels that may have changed
    EXPECT_TRUE(viewer.draw());
    EXPECT_TRUE(viewer.draw());
}

TEST(ViewerRenderer, DrawsInstancesWhereTheyAre) {
    Viewer viewer;
    viewer.draw();
    const glm::ivec3 wall(encoded(0.25));
    EXPECT_EQ(viewer.pixel(), wall);
    std::vector<Placement> placements = editsOf(viewer.scene).placements;
    const auto show = [&](const glm::mat4& placement, bool hidden) {
        placements[0] = {placement * viewer.scene.instances[0].transform, hidden};
        viewer.gpu.updatePlacements(placements);
        EXPECT_TRUE(viewer.draw());
        EXPECT_FALSE(viewer.draw());
        return viewer.pixel();
    };
    const glm::ivec3 nothing = show(glm::mat4(1.0f), true);
    EXPECT_NE(nothing, wall) << "hidden";
    EXPECT_EQ(show(glm::mat4(1.0f), false), wall);
    EXPECT_EQ(show(glm::translate(glm::mat4(1.0f), {50.0f, 0.0f, 0.0f}), false), nothing);
    EXPECT_EQ(show(glm::scale(glm::mat4(1.0f), {-1.0f, 1.0f, 1.0f}), false), wall) << "mirrored";
    EXPECT_EQ(show(glm::scale(glm::mat4(1.0f), {1.0f, 1.0f, -1.0f}), false), nothing) << "seen from behind";
    EXPECT_LT(viewer.gpu.bounds().size().z, 1e-6f);
    // The wall is turned towards +y, and so is its normal.
    viewer.frame.settings.view = View::Normal;
    const glm::mat4 half = glm::rotate(glm::mat4(1.0f), glm::radians(-45.0f), {1.0f, 0.0f, 0.0f});
    const glm::ivec3 tilted = show(half, false);
    EXPECT_NEAR(tilted.y, tilted.z, 1);
    EXPECT_GT(tilted.y, tilted.x);
}

TEST(ViewerRenderer, TakesOtherMaterials) {
    Viewer viewer;
    viewer.draw();
    EXPECT_EQ(viewer.pixel(), glm::ivec3(encoded(0.25)));
    viewer.scene.materials[0].baseColor = glm::vec4(1, 1, 1, 1);
    viewer.scene.materials[0].emission = glm::vec3(0.25f);
    viewer.gpu.updateMaterials(viewer.scene);
    EXPECT_TRUE(viewer.draw());
    EXPECT_EQ(viewer.pixel(), glm::ivec3(encoded(0.75)));
}

TEST(ViewerRenderer, PresentsTheLastPictureInAnySize) {
    Viewer viewer;
    const gl::Framebuffer other({.width = 40, .height = 90, .name = "other"});
    viewer.renderer.present({other.get(), 40, 90}); // nothing yet: leaves it alone
    viewer.draw();
    viewer.renderer.present({other.get(), 40, 90});
    const Picture picture{readPicture(other), {}, 0};
    for (const glm::uvec2 p : {glm::uvec2(0, 0), glm::uvec2(39, 89), glm::uvec2(20, 45)})
        EXPECT_EQ(picture.pixel(p.x, p.y), glm::ivec3(encoded(0.25)));
}

TEST(ViewerRenderer, MeasuresExposureWithoutWaiting) {
    const FloatImage image = lightmapOf({0.1f, 0.1f, 0.1f, 1}, {0.3f, 0.3f, 0.3f, 1}, 32);
    Viewer waiting(Metering::Wait, grey(0.2f), image), async(Metering::Async, grey(0.2f), image);
    waiting.frame.settings.exposure.reset();
    async.frame.settings.exposure.reset();
    waiting.draw();
    EXPECT_FALSE(waiting.renderer.adapting());
    async.settle();
    EXPECT_NEAR(async.renderer.exposure(), waiting.renderer.exposure(), 0.03f);
    EXPECT_NEAR(async.pixel(8, 32).r, waiting.pixel(8, 32).r, 2);
    EXPECT_FALSE(async.draw()); // it has come to rest
    // Twice the light asks for one EV less.
    async.frame.lightmap.unit = 2.0f;
    async.frame.lightmap.ambient *= 2.0f;
    async.settle();
    EXPECT_NEAR(async.renderer.exposure(), waiting.renderer.exposure() - 1.0f, 0.05f);
}

TEST(ViewerRenderer, ExposesTheFirstLightByItsMean) {
    Viewer viewer(Metering::Async, grey(0.2f), lightmapOf(0.3f));
    viewer.frame.settings.exposure.reset();
    const LightmapTexture lit = viewer.frame.lightmap;
    viewer.frame.lightmap = {.version = newVersion()}; // no light yet
    viewer.settle();
    const float grey = viewer.renderer.exposure();
    for (const float unit : {1e5f, 1e-3f, 1e2f}) { // day, night and dusk
        viewer.frame.lightmap = lit;
        viewer.frame.lightmap.unit = unit;
        viewer.frame.lightmap.ambient *= unit;
        viewer.frame.lightmap.version = newVersion();
        viewer.draw();
        const float first = viewer.renderer.exposure();
        viewer.settle();
        EXPECT_NEAR(first, viewer.renderer.exposure(), 1.0f) << unit;
        EXPECT_GT(std::abs(viewer.renderer.exposure() - grey), 2.0f) << unit;
    }
}

TEST(ViewerRenderer, MultipliesTheLightmapByItsUnit) {
    Viewer viewer;
    viewer.frame.lightmap.unit = 0.5f;
    viewer.draw();
    EXPECT_EQ(viewer.pixel(), glm::ivec3(encoded(0.125)));
}

TEST(ViewerRenderer, FiltersFilledLightmapsAlike) {
    FloatImage image = lightmapOf({0.2f, 0.2f, 0.2f, 1}, {0.8f, 0.8f, 0.8f, 0.5f}, 32);
    Viewer viewer(Metering::Wait, grey(1.0f), image);
    ASSERT_TRUE(viewer.frame.lightmap.filled);
    for (const LightmapFilter filter : {LightmapFilter::Bilinear, LightmapFilter::Bicubic}) {
        viewer.frame.settings.filter = filter;
        viewer.frame.lightmap.filled = true;
        viewer.draw();
        const Picture fast{readPicture(viewer.target), {}, 0};
        viewer.frame.lightmap.filled = false;
        viewer.draw();
        for (uint32_t x = 28; x < 36; ++x)
            EXPECT_EQ(fast.pixel(x, 32), viewer.pixel(x, 32)) << x;
    }
    // This is an empty texel that a filter reaches from a patch.
    image.planes[3][20 * kWallSize + 33] = 0.0f;
    EXPECT_FALSE(LightmapImage(image, "hole").texture().filled);
    image.planes[3][20 * kWallSize + 33] = 1.0f;
    image.planes[3][20 * kWallSize + 50] = 0.0f; // among filled ones, far from all patches but that one
    EXPECT_TRUE(LightmapImage(image, "hole").texture().filled);
}

TEST(ViewerRenderer, ChangesItsSamples) {
    Viewer viewer;
    viewer.frame.camera.target.x += 0.33f;
    viewer.frame.camera.eye.x += 0.33f;
    viewer.frame.camera.up = glm::normalize(glm::vec3(0.3f, 1, 0));
    viewer.frame.settings.background = glm::vec3(0.0f);
    for (const uint32_t samples : {0u, 4u, 2u, 8u, 1u}) {
        viewer.renderer.setSamples(samples);
        EXPECT_TRUE(viewer.draw()) << samples;
        int between = 0;
        for (uint32_t y = 0; y < 64; ++y) {
            const Picture picture{readPicture(viewer.target), {}, 0};
            for (uint32_t x = 0; x < 64; ++x)
                between += picture.pixel(x, y).r > 0 && picture.pixel(x, y).r < encoded(0.25) ? 1 : 0;
        }
        EXPECT_EQ(between > 10, samples > 1) << samples;
    }
}

/// Makes a copy of shaders/ that is used while it lives.
class ShaderFolder {
public:
    ShaderFolder() : path_(folder_.path("shaders")) {
        std::filesystem::copy(std::string(RELUME_SOURCE_DIR) + "/shaders", path_,
                              std::filesystem::copy_options::recursive);
        setShaderFolder(path_);
    }
    ~ShaderFolder() { setShaderFolder(""); }
    ShaderFolder(const ShaderFolder&) = delete;
    ShaderFolder& operator=(const ShaderFolder&) = delete;

    std::string read(const std::string& file) const {
        std::ifstream in(path_ + "/" + file);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    void write(const std::string& file, const std::string& text) const {
        std::ofstream(path_ + "/" + file) << text;
    }

private:
    TemporaryFolder folder_;
    std::string path_;
};

TEST(ViewerRenderer, KeepsItsShadersWhenNewOnesAreBroken) {
    const ShaderFolder shaders;
    Viewer viewer;
    viewer.draw();
    const std::string text = shaders.read("gl/scene.frag");
    const auto lines = std::count(text.begin(), text.end(), '\n');
    shaders.write("gl/scene.frag", text + "float broken() { return nosuchthing; }\n");
    try {
        viewer.renderer.reload();
        ADD_FAILURE() << "the shader compiled";
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).rfind("gl/scene.frag:" + std::to_string(lines + 1) + ": ", 0), 0u)
            << error.what();
    }
    viewer.frame.settings.exposure = 1.0f; // drawn anew, by the old shader
    EXPECT_TRUE(viewer.draw());
    EXPECT_EQ(viewer.pixel(), glm::ivec3(encoded(0.5)));
    std::string other = text;
    const std::string line = "    result = PANE != 0 ? vec4(color.rgb, opacity(m, base.a)) : color;\n";
    ASSERT_NE(other.find(line), std::string::npos);
    other.replace(other.find(line), line.size(), "    result = vec4(1.0, 0.0, 0.0, 1.0);\n");
    shaders.write("gl/scene.frag", other);
    viewer.renderer.reload();
    EXPECT_TRUE(viewer.draw());
    EXPECT_EQ(viewer.pixel(), glm::ivec3(255, 0, 0));
}

TEST(ViewerRenderer, TintsTheSelectedInstance) {
    Viewer viewer;
    viewer.frame.settings.selected = 1; // there is none
    viewer.draw();
    EXPECT_EQ(viewer.pixel(), glm::ivec3(encoded(0.25)));
    viewer.frame.settings.selected = 0;
    EXPECT_TRUE(viewer.draw());
    EXPECT_GT(viewer.pixel().r, encoded(0.25) + 20);
    EXPECT_LT(viewer.pixel().b, encoded(0.25));
}

TEST(ViewerRenderer, DrawsLinesOverTheScene) {
    Viewer viewer;
    const std::array<LineDraw::Segment, 2> segments = {{
        {{-1, 0.5078125f, 0.5f}, {1, 0.5078125f, 0.5f}, {0, 1, 0}},     // before the wall
        {{-1, -0.5078125f, -0.5f}, {1, -0.5078125f, -0.5f}, {0, 1, 0}}, // behind it
    }};
    const LineDraw lines(segments);
    viewer.frame.lines = &lines;
    viewer.renderer.setSamples(0);
    viewer.draw();
    int front = 0, hidden = 0; // the greenest of each
    for (uint32_t y = 0; y < 64; ++y) {
        const glm::ivec3 pixel = viewer.pixel(32, y);
        int& side = y < 32 ? front : hidden;
        side = std::max(side, pixel.g - pixel.r);
    }
    EXPECT_EQ(front, 255);
    EXPECT_GT(hidden, 25); // shines through
    EXPECT_LT(hidden, 128);
    const LineDraw none(std::span<const LineDraw::Segment>{});
    viewer.frame.lines = &none;
    EXPECT_TRUE(viewer.draw());
    EXPECT_EQ(viewer.pixel(32, 16), viewer.pixel(32, 17));
}

TEST(ViewerRenderer, DrawsVoxelsInTheScenesPlace) {
    Viewer viewer;
    const std::array<glm::vec3, 2> centres = {glm::vec3(-0.5f, 0, 0), glm::vec3(0.5f, 0, -1)};
    const std::array<glm::vec3, 2> colors = {glm::vec3(1, 0, 0), glm::vec3(0, 0, 1)};
    const VoxelDraw byNormal({.centres = centres, .edge = glm::vec3(1.0f, 0.5f, 0.5f)});
    viewer.frame.voxels = &byNormal;
    viewer.draw();
    const glm::ivec3 front = viewer.pixel(16, 32); // +z: 127.5, 127.5, 255, which GPUs round either way
    EXPECT_LE(std::max(std::abs(2 * front.r - 255), std::abs(2 * front.g - 255)), 1);
    EXPECT_EQ(front.b, 255);
    EXPECT_EQ(viewer.pixel(16, 8).r, std::lround(255 * viewer.frame.settings.background.r));
    const VoxelDraw colored({.centres = centres, .edge = glm::vec3(1.0f), .colors = colors});
    viewer.frame.voxels = &colored;
    viewer.draw();
    EXPECT_EQ(viewer.pixel(16, 32), glm::ivec3(255, 0, 0));
    EXPECT_EQ(viewer.pixel(48, 32), glm::ivec3(0, 0, 255));
    // Seen from behind, the farther one is in front.
    viewer.frame.camera = cameraAt({3, 0.1f, -4}, {0.5f, 0, -1}, viewer.gpu.bounds());
    viewer.draw();
    const glm::ivec3 seen = viewer.pixel();
    EXPECT_GT(seen.b, 100);
    EXPECT_EQ(seen.r, 0);
}

TEST(ViewerRenderer, MeasuresItsPasses) {
    Viewer viewer;
    viewer.draw();
    viewer.renderer.timer().endFrame();
    glFinish();
    viewer.renderer.timer().endFrame();
    std::vector<std::string> names;
    for (const gl::Timer::Pass& pass : viewer.renderer.timer().passes())
        names.push_back(pass.name);
    EXPECT_EQ(names, (std::vector<std::string>{"scene", "resolve", "present"}));
}

} // namespace
} // namespace relume
