// These tests open exported levels in the engines that run in a browser and hold their pictures against those
// of `relume shot`.
#include "assets/base/file_write.h"
#include "assets/images/image_file.h"
#include "renderer/draw_settings.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/unit/glb_builder.h"
#include "tests/web/web_page.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

namespace relume {
namespace {

constexpr uint32_t kWidth = 800, kHeight = 450; // of the compared pictures [pixels]
// Pictures are drawn with so many times the pixels per edge, and averaged: Chromium's software device and
// Mesa's choose other levels and samples of the same texture.
constexpr uint32_t kFiner = 2;

FloatImage averaged(const FloatImage& fine) {
    FloatImage out{kWidth, kHeight, {}, {}, {}};
    for (const std::string& name : fine.channels)
        out.add(name).assign(size_t{kWidth} * kHeight, 0.0f);
    for (size_t c = 0; c < fine.planes.size(); ++c)
        for (uint32_t y = 0; y < kFiner * kHeight; ++y)
            for (uint32_t x = 0; x < kFiner * kWidth; ++x)
                out.planes[c][size_t{y / kFiner} * kWidth + x / kFiner] +=
                    fine.planes[c][size_t{y} * fine.width + x] / float(kFiner * kFiner);
    return out;
}

std::string scenePath(const std::string& name) {
    return std::string(RELUME_SOURCE_DIR) + "/assets/scenes/" + name + ".glb";
}

void relume(const std::vector<std::string>& arguments) {
    std::vector<std::string> quiet = {"-q"};
    quiet.insert(quiet.end(), arguments.begin(), arguments.end());
    const ProcessResult run = runRelume(quiet);
    ASSERT_EQ(run.status, 0) << run.err;
}

// A level, its lightmap and the picture that it should have. They are made once for all engines: what is
// compared does not depend on how clean the light is.
class LitLevel {
public:
    LitLevel(const std::string& name, const std::string& exposure) : scene_(scenePath(name)) {
        relume({"bake", scene_, "-o", lightmap(), "--size", "512", "--samples", "16"});
        picture_ = averaged(shot({"--tone", "none", "--exposure", exposure}));
        const FloatImage normals = shot({"--view", "normal"}), objects = shot({"--view", "instance"}),
                         materials = shot({"--view", "material"});
        inside_.assign(size_t{kWidth} * kHeight, true);
        for (uint32_t y = 0; y < normals.height; ++y)
            for (uint32_t x = 0; x < normals.width; ++x)
                if (isBehind(normals, x, y) || !isSmooth(normals, x, y) || !isSmooth(objects, x, y) ||
                    !isSmooth(materials, x, y))
                    inside_[size_t{y / kFiner} * kWidth + x / kFiner] = false;
    }

    const std::string& scene() const { return scene_; }
    std::string lightmap() const { return folder_.path("lightmap.exr"); }
    const FloatImage& picture() const { return picture_; }
    /// Tells of each pixel whether it lies inside of a surface, so that both pictures show the same one
    /// there.
    const std::vector<bool>& inside() const { return inside_; }

private:
    FloatImage shot(std::vector<std::string> options) const {
        options.insert(options.begin(),
                       {"shot", scene_, "-o", folder_.path("shot.png"), "--size",
                        fmt::format("{}x{}", kFiner * kWidth, kFiner * kHeight), "--lightmap", lightmap()});
        relume(options);
        return readImage(folder_.path("shot.png"));
    }
    // Tells of a pixel of the view "normal" whether it shows what is behind the level.
    static bool isBehind(const FloatImage& image, uint32_t x, uint32_t y) {
        const size_t i = size_t{y} * image.width + x;
        const glm::vec3 color(image.planes[0][i], image.planes[1][i], image.planes[2][i]);
        const glm::vec3 none = DrawSettings{}.background; // as displayed
        bool same = true;
        for (int c = 0; c < 3; ++c)
            same &= std::abs(srgbFromLinear(double(color[c])) - double(none[c])) < 0.5 / 255;
        return same;
    }
    static bool isSmooth(const FloatImage& image, uint32_t x, uint32_t y) {
        constexpr float kStep = 0.06f; // a curved surface turns less from one pixel to the next
        for (size_t c = 0; c < 3; ++c) {
            const auto at = [&](uint32_t column, uint32_t row) {
                return image.planes[c][size_t{row} * image.width + column];
            };
            for (uint32_t row = y > 0 ? y - 1 : 0; row < std::min(y + 2, image.height); ++row)
                for (uint32_t column = x > 0 ? x - 1 : 0; column < std::min(x + 2, image.width); ++column)
                    if (std::abs(at(column, row) - at(x, y)) > kStep) return false;
        }
        return true;
    }

    TemporaryFolder folder_;
    std::string scene_;
    FloatImage picture_;
    std::vector<bool> inside_;
};

// How far a picture is off inside of surfaces.
struct Difference {
    double mean = 0, p99 = 0; // of the channels as displayed (sRGB), full scale 1
    double light = 0;         // of the linear light's mean, relative: steps of 8 bits average out
    double counted = 0;       // share of the pixels
};

Difference differenceOf(const FloatImage& picture, const LitLevel& level) {
    const FloatImage& right = level.picture();
    std::vector<double> off;
    double light = 0, rightLight = 0, sum = 0;
    for (size_t i = 0; i < level.inside().size(); ++i) {
        if (!level.inside()[i]) continue;
        for (size_t c = 0; c < 3; ++c) {
            const double a = double(picture.planes[c][i]), b = double(right.planes[c][i]);
            off.push_back(std::abs(srgbFromLinear(a) - srgbFromLinear(b)));
            sum += off.back();
            light += a;
            rightLight += b;
        }
    }
    const double count = double(off.size());
    std::sort(off.begin(), off.end());
    return {sum / count, off[size_t(0.99 * count)], std::abs(light / rightLight - 1),
            count / double(3 * level.inside().size())};
}

// Engines that do not encode by the curve of sRGB but by its usual stand-in, a power of 2.2.
FloatImage decodedByPower(FloatImage picture) {
    for (std::vector<float>& plane : picture.planes)
        for (float& value : plane)
            value = float(std::pow(srgbFromLinear(double(value)), 2.2));
    return picture;
}

struct LevelCase {
    const char* scene;
    const char* exposure;
};

void PrintTo(const LevelCase& level, std::ostream* out) {
    *out << level.scene;
}

class Engines : public testing::TestWithParam<LevelCase> {
protected:
    void SetUp() override {
        if (const std::string reason = whyNoPages(); !reason.empty()) GTEST_SKIP() << reason;
    }
    static void TearDownTestSuite() { levels_.clear(); }

    LitLevel& level() {
        auto& slot = levels_[GetParam().scene];
        if (!slot) slot = std::make_unique<LitLevel>(GetParam().scene, GetParam().exposure);
        return *slot;
    }
    // Exports the level and returns its folder.
    std::string exported(const std::string& engine) {
        const std::string folder = folder_.path(engine);
        relume({"export", level().scene(), "--lightmap", level().lightmap(), "--for", engine, "-o", folder,
                "--exposure", GetParam().exposure});
        EXPECT_EQ(complaintsAbout({folder + "/scene.glb"}), "");
        return folder;
    }
    FloatImage shown(const std::string& engine) {
        const std::string folder = exported(engine);
        const std::string page = engine == "any" ? "@tests/any.html" : "index.html#tone=linear";
        return pictureOfPage(folder, page, kFiner * kWidth, kFiner * kHeight);
    }
    void expectWithin(const FloatImage& picture, double mean, double p99) {
        ASSERT_FALSE(picture.planes.empty());
        const Difference difference = differenceOf(averaged(picture), level());
        std::printf("%s: mean %.3f %%, p99 %.3f %% as displayed, light %.3f %%, in %.0f %% of the pixels\n",
                    GetParam().scene, 100 * difference.mean, 100 * difference.p99, 100 * difference.light,
                    100 * difference.counted);
        EXPECT_LE(difference.mean, mean);
        EXPECT_LE(difference.light, mean);
        EXPECT_LE(difference.p99, p99);
        EXPECT_GE(difference.counted, 0.3);
    }

private:
    static std::map<std::string, std::unique_ptr<LitLevel>> levels_;
    TemporaryFolder folder_;
};

std::map<std::string, std::unique_ptr<LitLevel>> Engines::levels_;

TEST_P(Engines, ThreeShowsTheSamePicture) {
    expectWithin(shown("three"), 0.005, 0.02);
}

TEST_P(Engines, BabylonShowsTheSamePicture) {
    expectWithin(shown("babylon"), 0.01, 0.05);
}

TEST_P(Engines, PlayCanvasShowsTheSamePicture) {
    expectWithin(decodedByPower(shown("playcanvas")), 0.01, 0.05);
}

TEST_P(Engines, ModelViewerShowsPlainGltfAlmostAlike) {
    expectWithin(shown("any"), 0.03, 0.25);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Engines,
                         testing::Values(LevelCase{"gallery", "-1"}, LevelCase{"cornell_geom", "-1"},
                                         LevelCase{"atrium", "-1"}, LevelCase{"town", "-9"}),
                         [](const auto& one) { return std::string(one.param.scene); });

// Makes a grey wall below an even sky; before it, on the left, a black square that the alpha of its vertex
// colours masks away, and on the right a pane that transmits nine tenths.
std::string seenThroughLevel(const TemporaryFolder& folder) {
    using nlohmann::json;
    test::GlbBuilder b;
    const auto paint = [](float grey) {
        return json{{"baseColorFactor", {grey, grey, grey, 1}}, {"metallicFactor", 0}};
    };
    b.json["materials"] = {{{"pbrMetallicRoughness", paint(0.5f)}},
                           {{"pbrMetallicRoughness", paint(0.0f)}, {"alphaMode", "MASK"}},
                           {{"pbrMetallicRoughness", paint(1.0f)},
                            {"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 0.9}}}}}}};
    b.json["extensionsUsed"] = {"KHR_materials_transmission"};
    const json places = {{-4, -4, 0}, {-2.2, -1, 1}, {0.2, -1, 1}};
    const double sizes[] = {8, 2, 2};
    b.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.9}, {"znear", 0.1}}}}};
    json nodes = json::array({b.node({{"camera", 0}, {"translation", {0, 0, 4}}})});
    for (size_t i = 0; i < 3; ++i) {
        json square = b.square();
        square["attributes"]["TEXCOORD_0"] = b.squareUvs();
        square["material"] = i;
        const std::vector<float> clear = {1, 1, 1, 0, 1, 1, 1, 0, 1, 1, 1, 0, 1, 1, 1, 0};
        if (i == 1) square["attributes"]["COLOR_0"] = b.accessor(clear, "VEC4");
        nodes.push_back(b.node(
            {{"mesh", b.mesh(square)}, {"translation", places[i]}, {"scale", {sizes[i], sizes[i], 1}}}));
    }
    b.json["scenes"] = {
        {{"nodes", nodes}, {"extras", {{"relume", {{"sky", {{"color", {1, 1, 1}}, {"intensity", 1}}}}}}}}};
    const std::vector<uint8_t> bytes = b.bytes();
    writeFileAtomically(folder.path("through.glb"), std::string(bytes.begin(), bytes.end()));
    return folder.path("through.glb");
}

TEST(EngineSurfaces, WhatIsBehindHolesAndGlassIsSeen) {
    if (const std::string reason = whyNoPages(); !reason.empty()) GTEST_SKIP() << reason;
    const TemporaryFolder folder;
    const std::string scene = seenThroughLevel(folder), lightmap = folder.path("l.exr");
    relume({"bake", scene, "-o", lightmap, "--size", "64", "--samples", "64"});
    relume({"shot", scene, "--lightmap", lightmap, "-o", folder.path("shot.png"), "--size",
            fmt::format("{}x{}", kWidth, kHeight), "--tone", "none", "--exposure", "0"});
    const FloatImage right = readImage(folder.path("shot.png"));
    for (const char* engine : {"three", "babylon", "playcanvas"}) {
        const std::string level = folder.path(engine);
        relume({"export", scene, "--lightmap", lightmap, "--for", engine, "-o", level, "--exposure", "0"});
        FloatImage picture = pictureOfPage(level, "index.html#tone=linear", kWidth, kHeight);
        ASSERT_FALSE(picture.planes.empty()) << engine;
        if (engine == std::string("playcanvas")) picture = decodedByPower(picture);
        for (const double column : {0.27, 0.73}) { // the hole, the glass
            const size_t at = size_t{kWidth} * (kHeight / 2) + size_t(column * kWidth);
            for (size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(srgbFromLinear(double(picture.planes[c][at])),
                            srgbFromLinear(double(right.planes[c][at])), 0.04)
                    << engine << " at " << column;
        }
    }
}

} // namespace
} // namespace relume
