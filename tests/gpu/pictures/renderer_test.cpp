// These pictures have pixels that are known: they show what the renderer makes of light, materials and
// lightmaps.
#include "assets/base/error.h"
#include "assets/images/metrics.h"
#include "renderer/gl/texture.h"
#include "renderer/picture.h"
#include "shaders/shader_library.h"
#include "tests/gpu/relume_process.h"
#include "tests/gpu/wall_scene.h"
#include "tests/log_capture.h"
#include "tests/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace relume {
namespace {

void expectAll(const Picture& picture, int value) {
    for (uint32_t y = 0; y < picture.image.height; ++y)
        for (uint32_t x = 0; x < picture.image.width; ++x)
            ASSERT_EQ(picture.pixel(x, y), glm::ivec3(value)) << x << " " << y;
}

int background(const DrawSettings& settings) {
    return static_cast<int>(std::lround(255.0f * settings.background.r));
}

TEST(Renderer, ShowsAGreyWallWithItsSrgbValue) {
    const SceneMaker maker = wall(grey(0.5f));
    const FloatImage lightmap = lightmapOf(0.5f);
    for (const LightmapFilter filter :
         {LightmapFilter::Nearest, LightmapFilter::Bilinear, LightmapFilter::Bicubic}) {
        expectAll(drawPicture({maker.scene(), &lightmap, before(), plain(View::Lit, filter)}), encoded(0.25));
        expectAll(drawPicture({maker.scene(), &lightmap, before(), plain(View::Lighting, filter)}),
                  encoded(0.5));
    }
    DrawSettings brighter = plain();
    brighter.exposure = 1.0f;
    expectAll(drawPicture({maker.scene(), &lightmap, before(), brighter}), encoded(0.5));
    expectAll(drawPicture({maker.scene(), &lightmap, before(), plain(View::Albedo)}), encoded(0.5));
}

// A tenth of the way from one step of 8 bits to the next, a tenth of the pixels is the next; a step stays as
// it is, and so do colours that are no light.
TEST(Renderer, DithersLightBetweenStepsOfItsPicture) {
    const SceneMaker maker = wall(grey(0.5f));
    DrawSettings settings = plain(View::Lighting);
    settings.dither = true;
    const auto lit = [&](double step) {
        const FloatImage lightmap = lightmapOf(static_cast<float>(linearFromSrgb(step / 255.0)));
        return drawPicture({maker.scene(), &lightmap, before(), settings, 128, 128});
    };
    const auto shareOf = [](const Picture& picture, int value) {
        size_t count = 0;
        for (uint32_t y = 0; y < picture.image.height; ++y)
            for (uint32_t x = 0; x < picture.image.width; ++x)
                count += picture.pixel(x, y) == glm::ivec3(value);
        return static_cast<double>(count) / (picture.image.width * picture.image.height);
    };
    for (const double share : {0.1, 0.5, 0.9}) {
        const Picture picture = lit(20.0 + share);
        EXPECT_NEAR(shareOf(picture, 21), share, 0.02);
        EXPECT_NEAR(shareOf(picture, 20), 1.0 - share, 0.02);
    }
    expectAll(lit(20.0), 20);
    settings.view = View::Albedo;
    expectAll(lit(20.0), encoded(0.5));
}

TEST(Renderer, AddsEmission) {
    const SceneMaker maker = wall(grey(0.5f, 0.3f));
    const FloatImage lightmap = lightmapOf(0.5f);
    expectAll(drawPicture({maker.scene(), &lightmap, before(), plain()}), encoded(0.55));
    expectAll(drawPicture({maker.scene(), &lightmap, before(), plain(View::Emission)}), encoded(0.3));
}

// It is drawn as the baker reflects it: a smooth metal sends no diffuse light back, a rough one half.
TEST(Renderer, TakesTheBakersAlbedoOfMetals) {
    Material metal = grey(0.8f);
    metal.metallic = 1.0f;
    metal.roughness = 1.0f;
    const FloatImage lightmap = lightmapOf(1.0f);
    const SceneMaker maker = wall(metal);
    expectAll(drawPicture({maker.scene(), &lightmap, before(), plain()}), encoded(0.4));
}

TEST(Renderer, CutsOutTheHolesOfAMask) {
    SceneMaker maker(kWallSize);
    Material masked = grey(1.0f);
    masked.alphaMode = AlphaMode::Mask;
    masked.baseColorTexture.texture = maker.alphaTexture(2, 1, {0, 255});
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(masked), {kWallSize, kWallSize});
    const FloatImage lightmap = lightmapOf(0.5f);
    const DrawSettings settings = plain();
    const Picture picture = drawPicture({maker.scene(), &lightmap, before(), settings});
    EXPECT_EQ(picture.pixel(8, 32).r, background(settings));
    EXPECT_EQ(picture.pixel(56, 32), glm::ivec3(encoded(0.5)));
}

// A valid image may be larger than the driver's: it is made smaller, which one line tells.
TEST(Renderer, MakesAnImageThatIsTooLargeForTheDriverSmaller) {
    testContext();
    const uint32_t most = gl::largestTexture(), width = most + most / 4;
    std::vector<uint8_t> alpha(width);
    std::fill(alpha.begin() + width / 2, alpha.end(), uint8_t{255});
    SceneMaker maker(kWallSize);
    Material masked = grey(1.0f);
    masked.alphaMode = AlphaMode::Mask;
    masked.baseColorTexture.texture = maker.alphaTexture(width, 1, alpha);
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(masked), {kWallSize, kWallSize});
    const FloatImage lightmap = lightmapOf(0.5f);
    const DrawSettings settings = plain();
    const LogCapture log;
    const Picture picture = drawPicture({maker.scene(), &lightmap, before(), settings});
    EXPECT_EQ(picture.pixel(8, 32).r, background(settings));
    EXPECT_EQ(picture.pixel(56, 32), glm::ivec3(encoded(0.5)));
    const std::string text = log.text();
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
    EXPECT_NE(text.find("image 0 'alpha': has " + std::to_string(width) + " x 1 pixels"), std::string::npos)
        << text;
}

TEST(Renderer, ShowsBacksOfDoubleSidedMaterialsOnly) {
    const FloatImage lightmap = lightmapOf(0.5f);
    const DrawSettings settings = plain();
    Material material = grey(0.5f);
    const SceneMaker single = wall(material);
    const Picture nothing = drawPicture({single.scene(), &lightmap, before(-5.0f), settings});
    EXPECT_EQ(nothing.pixel(32, 32).r, background(settings));
    material.doubleSided = true;
    const SceneMaker both = wall(material);
    expectAll(drawPicture({both.scene(), &lightmap, before(-5.0f), settings}),
              encoded(0.25)); // its front's light
}

TEST(Renderer, FiltersTheLightmapAsAsked) {
    const SceneMaker maker = wall(grey(1.0f));
    const FloatImage lightmap = lightmapOf({0.2f, 0.2f, 0.2f, 1}, {0.8f, 0.8f, 0.8f, 1}, 32);
    const auto draw = [&](LightmapFilter filter) {
        return drawPicture({.scene = maker.scene(),
                            .lightmap = &lightmap,
                            .camera = before(),
                            .settings = plain(View::Lit, filter),
                            .width = 256,
                            .height = 256});
    };
    // There are four pixels for each texel: those at the border of the step are 1/8 and 3/8 of a texel away
    // from it.
    const Picture nearest = draw(LightmapFilter::Nearest), bilinear = draw(LightmapFilter::Bilinear),
                  bicubic = draw(LightmapFilter::Bicubic);
    EXPECT_EQ(nearest.pixel(127, 9).r, encoded(0.2));
    EXPECT_EQ(nearest.pixel(128, 9).r, encoded(0.8));
    EXPECT_NEAR(bilinear.pixel(127, 9).r, encoded(0.5 - 0.6 / 8), 1);
    EXPECT_NEAR(bilinear.pixel(129, 9).r, encoded(0.5 + 0.6 * 3 / 8), 1);
    // This is the integral of the cubic B-spline over 1/8 of its unit, from the middle: t (2/3 - t^2 / 3
    // ...), here by its weights.
    const double f = 0.375, w2 = (1 + 3 * f + 3 * f * f - 3 * f * f * f) / 6, w3 = f * f * f / 6;
    EXPECT_NEAR(bicubic.pixel(127, 9).r, encoded(0.2 + 0.6 * (w2 + w3)), 1);
}

// What lies beside a chart must not darken its edge, whatever is there.
TEST(Renderer, LeavesEmptyTexelsOut) {
    const SceneMaker maker = wall(grey(1.0f));
    const FloatImage lightmap = lightmapOf({0.5f, 0.5f, 0.5f, 1}, {9, 9, 9, 0}, 33);
    for (const LightmapFilter filter : {LightmapFilter::Bilinear, LightmapFilter::Bicubic}) {
        const Picture picture = drawPicture({.scene = maker.scene(),
                                             .lightmap = &lightmap,
                                             .camera = before(),
                                             .settings = plain(View::Lit, filter),
                                             .width = 256,
                                             .height = 256});
        for (uint32_t x = 0; x < 132; ++x) // up to the last covered texel's edge
            EXPECT_NEAR(picture.pixel(x, 9).r, encoded(0.5), 1) << x;
    }
}

TEST(Renderer, LightsGeometryWithoutLightmapUvsWithTheMean) {
    SceneMaker maker(kWallSize);
    maker.quad({-1, 5, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(0.5f),
               {kWallSize, kWallSize}); // out of sight
    maker.blocker({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(0.5f));
    const FloatImage lightmap = lightmapOf(0.4f);
    const Picture picture = drawPicture({maker.scene(), &lightmap, before(), plain()});
    EXPECT_NEAR(picture.pixel(32, 32).r, encoded(0.2), 1); // it faces the eye
    const Picture flat = drawPicture({maker.scene(), nullptr, before(), plain()});
    EXPECT_NEAR(flat.pixel(32, 32).r, encoded(0.5), 1); // no light yet: all is lit by 1
}

TEST(Renderer, CullsWhatIsOutOfSight) {
    SceneMaker maker(kWallSize);
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(0.5f), {16, 16});
    maker.quad({9, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(0.5f), {16, 16});
    const FloatImage lightmap = lightmapOf(0.5f);
    const Picture picture = drawPicture({maker.scene(), &lightmap, before(), plain()});
    EXPECT_EQ(picture.counts.drawn, 1u);
    EXPECT_EQ(picture.counts.culled, 1u);
}

TEST(Renderer, SmoothsEdgesByMultisampling) {
    SceneMaker maker(kWallSize);
    maker.quad({-1, -1, 0}, {1.3f, 0.4f, 0}, {-0.4f, 1.3f, 0}, maker.material(1.0f), {16, 16});
    const FloatImage lightmap = lightmapOf(1.0f);
    const auto between = [&](uint32_t samples) {
        DrawSettings settings = plain();
        settings.background = glm::vec3(0.0f);
        const Picture picture = drawPicture({.scene = maker.scene(),
                                             .lightmap = &lightmap,
                                             .camera = before(),
                                             .settings = settings,
                                             .samples = samples});
        int count = 0;
        for (uint32_t y = 0; y < 64; ++y)
            for (uint32_t x = 0; x < 64; ++x)
                count += picture.pixel(x, y).r > 0 && picture.pixel(x, y).r < 255 ? 1 : 0;
        return count;
    };
    EXPECT_EQ(between(0), 0);
    EXPECT_GT(between(4), 60); // along its four sides
}

// From candle light to the sun, with automatic exposure, the picture is the same in any unit.
TEST(Renderer, KnowsNoUnitOfLight) {
    const SceneMaker maker = wall(grey(0.5f));
    DrawSettings settings = plain();
    settings.exposure.reset();
    for (const float unit : {1e-4f, 1.0f, 1e6f}) {
        const LightTexel dim = {0.1f * unit, 0.1f * unit, 0.1f * unit, 1},
                         lit = {0.3f * unit, 0.3f * unit, 0.3f * unit, 1};
        const FloatImage lightmap = lightmapOf(dim, lit, 32);
        const Picture picture = drawPicture({maker.scene(), &lightmap, before(), settings});
        EXPECT_NEAR(picture.pixel(8, 32).r, encoded(0.18 / std::sqrt(3.0)), 1) << unit;
        EXPECT_NEAR(picture.pixel(56, 32).r, encoded(0.18 * std::sqrt(3.0)), 1) << unit;
        EXPECT_NEAR(picture.exposure, std::log2(0.18 / (0.05 * std::sqrt(3.0) * unit)), 0.02) << unit;
    }
}

TEST(Renderer, ShowsNormalsAndCoverage) {
    const SceneMaker maker = wall(grey(0.5f));
    const FloatImage lightmap = lightmapOf({1, 1, 1, 1}, {1, 1, 1, 0.5f}, 32);
    const glm::ivec3 normal =
        drawPicture({maker.scene(), &lightmap, before(), plain(View::Normal)}).pixel(32, 32);
    EXPECT_NEAR(normal.r, 127.5, 0.5); // 0 lies between two values
    EXPECT_NEAR(normal.g, 127.5, 0.5);
    EXPECT_EQ(normal.b, 255);
    const Picture coverage = drawPicture({maker.scene(), &lightmap, before(), plain(View::Coverage)});
    EXPECT_GT(coverage.pixel(8, 32).g, coverage.pixel(8, 32).r);   // a patch: green
    EXPECT_GT(coverage.pixel(56, 32).r, coverage.pixel(56, 32).g); // filled: amber
}

TEST(Renderer, ShowsTexelsAndTheirDensity) {
    SceneMaker maker(kWallSize);
    maker.quad({-1, -1, 0}, {1, 0, 0}, {0, 2, 0}, maker.material(0.5f), {4, 8});
    maker.quad({0, -1, 0}, {1, 0, 0}, {0, 2, 0}, maker.material(0.5f), {16, 32}); // four times as dense
    maker.quad({20, -1, 0}, {9, 0, 0}, {0, 2, 0}, maker.material(0.5f),
               {36, 8}); // out of sight, most of the area
    const FloatImage lightmap = lightmapOf(0.5f);
    const Picture density = drawPicture({maker.scene(), &lightmap, before(), plain(View::Density)});
    EXPECT_GT(density.pixel(48, 32).r, density.pixel(48, 32).b + 60); // denser: red
    EXPECT_NEAR(density.pixel(16, 32).r, density.pixel(16, 32).b, 2); // the median: white
    const Picture checker = drawPicture({maker.scene(), &lightmap, before(), plain(View::Checker)});
    EXPECT_GT(std::abs(checker.pixel(4, 36).g - checker.pixel(12, 36).g), 40); // texels of eight pixels
}

TEST(Renderer, EveryViewIsAnotherPicture) {
    SceneMaker maker(kWallSize);
    const int glowing = maker.material(0.7f, 0.1f);
    maker.quad({-1, -1, 0}, {1, 0, 0.2f}, {0, 1, 0}, glowing, {8, 8});
    maker.quad({-1, 0, 0}, {1, 0, 0.2f}, {0, 1, 0}, glowing, {8, 8});
    maker.quad({0, -1, 0.2f}, {1, 0, -0.2f}, {0, 2, 0}, maker.material(0.2f), {16, 32});
    const FloatImage lightmap = lightmapOf({0.3f, 0.2f, 0.5f, 1}, {0.9f, 0.8f, 0.4f, 1}, 12);
    std::vector<FloatImage> pictures;
    ASSERT_EQ(viewNames().size(), shader::kViewInspectColor); // the others show no lightmap
    for (uint32_t view = 0; view < viewNames().size(); ++view)
        pictures.push_back(
            drawPicture({maker.scene(), &lightmap, before(), plain(static_cast<View>(view))}).image);
    for (size_t a = 0; a < pictures.size(); ++a)
        for (size_t b = 0; b < a; ++b)
            EXPECT_GT(compareImages(pictures[a], "a", pictures[b], "b").dfpr, 0.02)
                << viewNames()[a] << " " << viewNames()[b];
}

TEST(Renderer, RefusesLightmapsThatAreNone) {
    testContext();
    FloatImage wide{8, 4, {}, {}, {}};
    for (const char* channel : {"R", "G", "B"})
        wide.add(channel);
    EXPECT_THROW(LightmapImage(wide, "wide.exr"), Error);
    FloatImage grey8{8, 8, {}, {}, {}};
    grey8.add("R");
    EXPECT_THROW(LightmapImage(grey8, "grey.exr"), Error);
    FloatImage broken = lightmapOf(1.0f);
    broken.planes[1][5] = NAN;
    EXPECT_THROW(LightmapImage(broken, "broken.exr"), Error);
}

TEST(Renderer, NamesFileAndLineOfABrokenShader) {
    testContext();
    TemporaryFolder folder;
    const std::string shaders = folder.path("shaders");
    std::filesystem::copy(std::string(RELUME_SOURCE_DIR) + "/shaders", shaders,
                          std::filesystem::copy_options::recursive);
    const std::string path = shaders + "/lib/tone.glsl";
    std::string text;
    {
        std::ifstream in(path);
        text = {std::istreambuf_iterator<char>(in), {}};
    }
    const size_t lines = static_cast<size_t>(std::count(text.begin(), text.end(), '\n'));
    std::ofstream(path) << text << "float broken() { return nosuchthing; }\n";
    setShaderFolder(shaders);
    try {
        SceneRenderer renderer;
        ADD_FAILURE() << "the shader compiled";
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).rfind("lib/tone.glsl:" + std::to_string(lines + 1) + ": ", 0), 0u)
            << error.what();
    }
    setShaderFolder("");
}

} // namespace
} // namespace relume
