// This tests the sky behind a scene: its radiance as displayed, its picture where it belongs.
#include "renderer/gl/texture.h"
#include "renderer/picture.h"
#include "renderer/scene_renderer.h"
#include "tests/gpu/relume_process.h"
#include "tests/gpu/wall_scene.h"
#include "tests/log_capture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace relume {
namespace {

constexpr float kRight = 0.5f * std::numbers::pi_v<float>;

/// Sets up a wall far to the side, before a sky.
class SkyRenderer : public testing::Test {
protected:
    SkyRenderer() : scene_((testContext(), wall(grey(0.5f)).scene())), lightmap_(lightmapOf(0.5f), "test") {}

    /// Returns what is seen in the middle of a picture from a place above the wall.
    glm::ivec3 seen(const glm::vec3& direction, const DrawSettings& settings = plain()) {
        ViewCamera camera;
        camera.eye = {0.0f, 50.0f, 0.0f};
        camera.target = camera.eye + direction;
        return look(camera, settings, {16, 16});
    }
    glm::ivec3 look(const ViewCamera& camera, const DrawSettings& settings, glm::uvec2 pixel) {
        if (!gpu_) gpu_.emplace(scene_, flatten(scene_, buildAtlas(scene_, kWallSize)));
        renderer_.draw(
            {.scene = *gpu_, .lightmap = lightmap_.texture(), .camera = camera, .settings = settings},
            {target_.get(), target_.width(), target_.height()});
        return Picture{readPicture(target_), {}, 0}.pixel(pixel.x, pixel.y);
    }
    /// Paints four columns from -x over -z and x to z, the upper half of each red, the lower blue.
    void paint() {
        Sky& sky = scene_.sky;
        sky.file = "painted.exr";
        sky.radiance = glm::vec3(1.0f);
        sky.width = 8;
        sky.height = 4;
        for (uint32_t y = 0; y < sky.height; ++y)
            for (uint32_t x = 0; x < sky.width; ++x) {
                const float green = 0.2f * static_cast<float>(x / 2);
                sky.pixels.emplace_back(y < 2 ? 0.8f : 0.0f, green, y < 2 ? 0.0f : 0.8f);
            }
    }

    Scene scene_;
    LightmapImage lightmap_;
    SceneRenderer renderer_{4};
    gl::Framebuffer target_{{.width = 33, .height = 33, .name = "test"}};
    std::optional<SceneGpu> gpu_;
};

TEST_F(SkyRenderer, ShowsItsRadianceExposedAsTheScene) {
    scene_.sky.radiance = {0.1f, 0.2f, 0.4f};
    EXPECT_EQ(seen({0, 0.3f, 1}), glm::ivec3(encoded(0.1), encoded(0.2), encoded(0.4)));
    DrawSettings brighter = plain();
    brighter.exposure = 1.0f;
    EXPECT_EQ(seen({0, 0.3f, 1}, brighter), glm::ivec3(encoded(0.2), encoded(0.4), encoded(0.8)));
    // In front of the wall the wall is seen, behind it the sky.
    const ViewCamera camera = before();
    EXPECT_EQ(look(camera, plain(), {16, 16}), glm::ivec3(encoded(0.25)));
    ViewCamera wide = camera;
    wide.halfHeight = 2.0f;
    EXPECT_EQ(look(wide, plain(), {2, 2}), glm::ivec3(encoded(0.1), encoded(0.2), encoded(0.4)));
}

TEST_F(SkyRenderer, WithoutOneAndInOtherViewsThereIsTheBackground) {
    const glm::vec3 background = DrawSettings().background;
    const auto expected = glm::ivec3(glm::round(255.0f * background));
    EXPECT_EQ(seen({0, 0.3f, 1}), expected);
    gpu_.reset();
    scene_.sky.radiance = glm::vec3(0.5f);
    EXPECT_EQ(seen({0, 0.3f, 1}, plain(View::Normal)), expected);
    EXPECT_EQ(seen({0, 0.3f, 1}), glm::ivec3(encoded(0.5)));
    gpu_->updateSky({});
    EXPECT_EQ(seen({0, 0.3f, 1}), expected) << "switched off";
}

TEST_F(SkyRenderer, APictureLiesWhereTheBakeTakesItFrom) {
    paint();
    const auto colour = [](double red, double green, double blue) {
        return glm::ivec3(encoded(red), encoded(green), encoded(blue));
    };
    // These are middles of columns: the picture's middle is -z, and +x is to the right of it.
    const float c = std::cos(0.5f * kRight), s = std::sin(0.5f * kRight);
    const auto near = [&](const glm::ivec3& a, const glm::ivec3& b) {
        const glm::ivec3 off = glm::abs(a - b);
        EXPECT_LE(std::max({off.x, off.y, off.z}), 2) << a.x << " " << a.y << " " << a.z;
    };
    near(seen({s, 1.0f, -c}), colour(0.8, 0.4, 0.0));
    near(seen({-s, 1.0f, -c}), colour(0.8, 0.2, 0.0));
    near(seen({s, -1.0f, c}), colour(0.0, 0.6, 0.8));
    // The sky is turned by a quarter counter-clockwise from above: what was to the right is ahead to the
    // left.
    SkySettings turned = scene_.sky;
    turned.rotation = kRight;
    gpu_->updateSky(turned);
    near(seen({-s, 1.0f, -c}), colour(0.8, 0.4, 0.0));
    turned.radiance = glm::vec3(0.5f);
    gpu_->updateSky(turned);
    near(seen({-s, 1.0f, -c}), colour(0.4, 0.2, 0.0));
    turned.file = "another.exr";
    gpu_->updateSky(turned);
    near(seen({-s, 1.0f, -c}), colour(0.5, 0.5, 0.5));
}

TEST_F(SkyRenderer, APictureThatIsTooLargeForTheDriverIsMadeSmaller) {
    const uint32_t most = gl::largestTexture();
    Sky& sky = scene_.sky;
    sky.file = "wide.exr";
    sky.radiance = glm::vec3(1.0f);
    sky.width = most + most / 4;
    sky.height = 1;
    for (uint32_t x = 0; x < sky.width; ++x) // what lies to the left is red, what lies to the right is blue
        sky.pixels.push_back(2 * x < sky.width ? glm::vec3(0.8f, 0.0f, 0.0f) : glm::vec3(0.0f, 0.0f, 0.8f));
    const LogCapture log;
    EXPECT_EQ(seen({-1.0f, 0.3f, -0.1f}), glm::ivec3(encoded(0.8), 0, 0));
    EXPECT_EQ(seen({1.0f, 0.3f, -0.1f}), glm::ivec3(0, 0, encoded(0.8)));
    const std::string text = log.text();
    EXPECT_NE(text.find("sky 'wide.exr': has " + std::to_string(sky.width) + " x 1 pixels"),
              std::string::npos)
        << text;
    gpu_->updateSkyPicture(sky); // as an edit does
    EXPECT_EQ(seen({1.0f, 0.3f, -0.1f}), glm::ivec3(0, 0, encoded(0.8)));
}

TEST_F(SkyRenderer, DoesNotChangeTheExposure) {
    DrawSettings automatic = plain();
    automatic.exposure.reset();
    ViewCamera wide = before();
    wide.halfHeight = 2.0f;
    look(wide, automatic, {16, 16});
    const float without = renderer_.exposure();
    gpu_->updateSky({.radiance = glm::vec3(100.0f), .file = {}});
    look(wide, automatic, {16, 16});
    EXPECT_NEAR(renderer_.exposure(), without, 0.1f);
}

} // namespace
} // namespace relume
