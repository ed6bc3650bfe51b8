#include "assets/base/error.h"
#include "assets/gltf/gltf.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "assets/images/sky_picture.h"
#include "assets/model/scene_limits.h"
#include "tests/unit/glb_builder.h"

#include <gtest/gtest.h>

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace relume {
namespace {

using nlohmann::json;
using test::GlbBuilder;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Makes a file with a square and lights, which it adds on nodes of their own.
class LightFile {
public:
    LightFile() : builder(test::squareScene()) { builder.json["scenes"] = {{{"nodes", {0}}}}; }

    /// Adds a node of the scene and returns its index.
    int node(json value) {
        const int index = builder.node(std::move(value));
        builder.json["scenes"][0]["nodes"].push_back(index);
        return index;
    }
    int punctual(const json& light, json node = json::object()) {
        json& lights = builder.json["extensions"]["KHR_lights_punctual"]["lights"];
        lights.push_back(light);
        builder.json["extensionsUsed"] = {"KHR_lights_punctual"};
        node["extensions"]["KHR_lights_punctual"]["light"] = lights.size() - 1;
        return this->node(std::move(node));
    }
    int area(const json& light, json node = json::object()) {
        node["extras"]["relume"]["areaLight"] = light;
        return this->node(std::move(node));
    }
    json& sky() { return builder.json["scenes"][0]["extras"]["relume"]["sky"]; }

    Scene load() { return loadGltf(builder.write("lights.glb")); }
    std::string error() {
        try {
            load();
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    }

    GlbBuilder builder;
};

/// Returns the warnings of the scene in one line each, without the path before them.
std::string warningsOf(const Scene& scene) {
    std::string lines;
    for (const std::string& warning : scene.warnings)
        lines += warning.substr(scene.path.size() + 2) + "\n";
    return lines;
}

FloatImage picture(const std::vector<glm::vec3>& pixels, uint32_t width) {
    FloatImage image{width, static_cast<uint32_t>(pixels.size()) / width, {}, {}, {}};
    for (int c = 0; c < 3; ++c) {
        std::vector<float>& plane = image.add(std::string(1, "RGB"[c]));
        for (size_t i = 0; i < plane.size(); ++i)
            plane[i] = pixels[i][c];
    }
    return image;
}

void expectRigid(const glm::mat4& m) {
    const glm::mat3 axes(m);
    const glm::mat3 one = glm::transpose(axes) * axes;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            EXPECT_NEAR(one[c][r], c == r ? 1.0f : 0.0f, 1e-6f);
    EXPECT_NEAR(glm::determinant(axes), 1.0f, 1e-6f);
}

void expectAxis(const glm::vec4& axis, const glm::vec3& expected) {
    const glm::vec3 unit = glm::normalize(expected);
    for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(axis[i], unit[i], 1e-6f);
}

TEST(GltfLight, ReadsTheExtentOfPunctualLights) {
    LightFile file;
    const json radius = {{"relume", {{"radius", .25}}}};
    const int bulb = file.punctual({{"type", "point"}, {"name", "Bulb"}, {"extras", radius}});
    const int spot = file.punctual({{"type", "spot"}, {"extras", radius}}, {{"name", "Spot"}});
    const int sun =
        file.punctual({{"type", "directional"}, {"extras", {{"relume", {{"angle", .0093}}}, {"other", 1}}}});
    file.punctual({{"type", "point"}, {"extras", "others' extras may be anything"}});
    const Scene scene = file.load();
    ASSERT_EQ(scene.lights.size(), 4u);
    EXPECT_EQ(scene.lights[0].name, "Bulb");
    EXPECT_EQ(scene.lights[0].node, bulb);
    EXPECT_EQ(scene.lights[0].radius, .25f);
    EXPECT_EQ(scene.lights[1].name, "Spot");
    EXPECT_EQ(scene.lights[1].node, spot);
    EXPECT_EQ(scene.lights[1].radius, .25f);
    EXPECT_EQ(scene.lights[2].node, sun);
    EXPECT_EQ(scene.lights[2].angle, .0093f);
    EXPECT_EQ(scene.lights[3].radius, 0.0f);
    EXPECT_EQ(warningsOf(scene), "");
}

TEST(GltfLight, ReadsAreaLights) {
    LightFile file;
    const int panel = file.area({{"name", "Panel"},
                                 {"type", "rectangle"},
                                 {"color", {1, .5, .25}},
                                 {"intensity", 3000},
                                 {"size", {1.5, .25}}},
                                {{"name", "Node"}, {"translation", {1, 2, 3}}});
    const int disc = file.area({{"type", "disc"}, {"radius", .5}, {"intensity", 0}}, {{"name", "Disc"}});
    const Scene scene = file.load();
    ASSERT_EQ(scene.lights.size(), 2u);
    const Light &a = scene.lights[0], &b = scene.lights[1];
    EXPECT_EQ(a.type, LightType::Rectangle);
    EXPECT_EQ(a.name, "Panel");
    EXPECT_EQ(a.node, panel);
    EXPECT_EQ(a.color, glm::vec3(1, .5f, .25f));
    EXPECT_EQ(a.intensity, 3000.0f);
    EXPECT_EQ(a.size, glm::vec2(1.5f, .25f));
    EXPECT_EQ(a.transform, glm::translate(glm::mat4(1.0f), {1, 2, 3}));
    EXPECT_EQ(b.type, LightType::Disc);
    EXPECT_EQ(b.name, "Disc");
    EXPECT_EQ(b.node, disc);
    EXPECT_EQ(b.radius, .5f);
    EXPECT_EQ(b.intensity, 0.0f); // off, but there
    EXPECT_EQ(warningsOf(scene), "");
}

TEST(GltfLight, MendsNumbersAndSaysSo) {
    LightFile file;
    file.punctual({{"type", "point"},
                   {"name", "A"},
                   {"intensity", -5},
                   {"range", "far"},
                   {"color", {1, -2, 1}},
                   {"extras", {{"relume", {{"radius", -.1}}}}}});
    file.punctual({{"type", "point"}, {"name", "B"}, {"intensity", 1e300}, {"color", {1, 2}}});
    file.punctual({{"type", "directional"}, {"name", "C"}, {"extras", {{"relume", {{"angle", 4}}}}}});
    file.punctual({{"type", "spot"}, {"name", "D"}, {"spot", {{"outerConeAngle", 0}}}});
    file.punctual(
        {{"type", "spot"}, {"name", "E"}, {"spot", {{"outerConeAngle", nullptr}, {"innerConeAngle", 1}}}});
    const Scene scene = file.load();
    ASSERT_EQ(scene.lights.size(), 5u);
    EXPECT_EQ(scene.lights[0].intensity, 0.0f);
    EXPECT_EQ(scene.lights[0].range, 0.0f);
    EXPECT_EQ(scene.lights[0].radius, 0.0f);
    EXPECT_EQ(scene.lights[0].color, glm::vec3(1, 0, 1));
    EXPECT_EQ(scene.lights[1].intensity, 1.0f);
    EXPECT_EQ(scene.lights[1].color, glm::vec3(1));
    EXPECT_EQ(scene.lights[2].angle, glm::pi<float>());
    EXPECT_GT(scene.lights[3].outerConeAngle, 0.0f);
    EXPECT_LE(scene.lights[3].outerConeAngle, 1e-3f);
    EXPECT_FLOAT_EQ(scene.lights[4].outerConeAngle, glm::quarter_pi<float>());
    EXPECT_EQ(scene.lights[4].innerConeAngle, scene.lights[4].outerConeAngle);
    EXPECT_EQ(warningsOf(scene), "light 'A': its range is not a finite number, 0 is used\n"
                                 "light 'A': its radius is negative, 0 is used\n"
                                 "light 'A': its color is negative, 0 is used\n"
                                 "light 'A': its intensity is negative, 0 is used\n"
                                 "light 'B': its color is not three finite numbers, white is used\n"
                                 "light 'B': its intensity is not a finite number, 1 is used\n"
                                 "light 'C': its angle is wider than half the sky, pi is used\n"
                                 "light 'D' and 1 more: has cone angles out of range, they are clamped\n"
                                 "light 'E': its outerConeAngle is not a finite number, 0.785398 is used\n");
}

TEST(GltfLight, IgnoresLightsThatCannotShine) {
    LightFile file;
    file.area({{"name", "A"}, {"type", "rectangle"}, {"size", {1, 0}}});
    file.area({{"name", "B"}, {"type", "rectangle"}, {"size", 2}});
    file.area({{"name", "C"}, {"type", "rectangle"}});
    file.area({{"name", "D"}, {"type", "disc"}, {"radius", -1}});
    file.area({{"name", "E"}, {"type", "disc"}, {"radius", json::array()}});
    file.area({{"name", "F"}, {"type", "sphere"}, {"radius", 1}});
    file.area({{"name", "G"}});
    file.area({{"name", "H"}, {"type", "disc"}, {"radius", 1}}, {{"scale", {0, 0, 0}}});
    const Scene scene = file.load();
    EXPECT_TRUE(scene.lights.empty());
    EXPECT_EQ(warningsOf(scene), "light 'A' and 2 more: its size is not two positive numbers, it is ignored\n"
                                 "light 'D' and 1 more: its radius is not a positive number, it is ignored\n"
                                 "light 'F': has the unknown type 'sphere' and is ignored\n"
                                 "light 'G': has the unknown type '' and is ignored\n"
                                 "light 'H': its node is scaled to nothing, it has no direction and is "
                                 "ignored\n");
}

TEST(GltfLight, WrongJsonIsAnError) {
    const auto errorOf = [](const auto& spoil) {
        LightFile file;
        file.punctual({{"type", "point"}});
        spoil(file);
        return file.error();
    };
    const auto has = [](const std::string& text, const std::string& part) {
        return text.find(part + ": the file is damaged, export it again") != std::string::npos;
    };
    EXPECT_EQ(errorOf([](LightFile&) {}), "");
    EXPECT_PRED2(has, errorOf([](LightFile& f) { f.area("bright"); }),
                 "nodes[2].extras.relume.areaLight is not an object");
    EXPECT_PRED2(has, errorOf([](LightFile& f) {
                     f.area({{"name", 7}});
                 }),
                 "nodes[2].extras.relume.areaLight.name is not a string");
    EXPECT_PRED2(has, errorOf([](LightFile& f) {
                     f.node({{"extras", {{"relume", 7}}}});
                 }),
                 "nodes[2].extras.relume is not an object");
    EXPECT_PRED2(has, errorOf([](LightFile& f) {
                     f.sky() = {1, 1, 1};
                 }),
                 "scenes[0].extras.relume.sky is not an object");
    EXPECT_PRED2(has, errorOf([](LightFile& f) { f.sky()["file"] = 7; }),
                 "scenes[0].extras.relume.sky.file is not a string");
    EXPECT_PRED2(has, errorOf([](LightFile& f) {
                     f.punctual({{"type", 7}});
                 }),
                 "extensions.KHR_lights_punctual.lights[1].type is not a string");
    EXPECT_PRED2(has, errorOf([](LightFile& f) {
                     f.punctual({{"extras", {{"relume", 7}}}});
                 }),
                 "extensions.KHR_lights_punctual.lights[1].extras.relume is not an object");
    EXPECT_PRED2(has, errorOf([](LightFile& f) { f.punctual("lamp"); }),
                 "extensions.KHR_lights_punctual.lights[1] is not an object");
}

TEST(GltfLight, ScaleMeansNothing) {
    LightFile file;
    const float h = std::sqrt(.5f);
    const json spot = {{"type", "spot"}}, disc = {{"type", "disc"}, {"radius", 1}};
    const json turned = {0, h, 0, h}; // a quarter turn about Y: Z goes to X
    file.punctual(spot, {{"rotation", turned}, {"scale", {3, .5, 100}}, {"translation", {1, 2, 3}}});
    file.punctual(spot, {{"rotation", turned}, {"scale", {-1, 1, 1}}});
    file.punctual(spot, {{"rotation", turned}, {"scale", {1, 1, -2}}});
    file.punctual(spot, {{"rotation", turned}, {"scale", {2, 2, 0}}}); // flattened, still with a plane
    file.area(disc, {{"name", "Disc"}, {"scale", {2, 2, 2}}});
    file.punctual({{"type", "point"}}, {{"scale", {0, 0, 0}}, {"translation", {4, 5, 6}}});
    const Scene scene = file.load();
    ASSERT_EQ(scene.lights.size(), 6u);
    for (const Light& light : scene.lights)
        expectRigid(light.transform);
    for (size_t i : {0u, 1u, 3u}) {
        expectAxis(scene.lights[i].transform[2], {1, 0, 0});
        expectAxis(scene.lights[i].transform[1], {0, 1, 0});
    }
    EXPECT_EQ(scene.lights[0].transform[3], glm::vec4(1, 2, 3, 1));
    expectAxis(scene.lights[2].transform[2], {-1, 0, 0}); // mirrored in Z, it shines the other way
    expectAxis(scene.lights[2].transform[1], {0, 1, 0});
    EXPECT_EQ(scene.lights[4].radius, 1.0f);
    EXPECT_EQ(scene.lights[5].transform[3], glm::vec4(4, 5, 6, 1));
    EXPECT_EQ(warningsOf(scene), "light 'Disc': its node is scaled, its size stays as it is written\n");
}

TEST(GltfLight, StraightensShearedNodes) {
    LightFile file;
    const int child = file.builder.node(
        {{"rotation", {.3827, 0, 0, .9239}}, {"extensions", json::object()}, {"name", "Beam"}});
    file.punctual({{"type", "spot"}});
    json& nodes = file.builder.json["nodes"];
    nodes[static_cast<size_t>(child)]["extensions"] = nodes.back()["extensions"];
    nodes.back() = {{"scale", {1, 3, 1}}, {"children", {child}}};
    const Scene scene = file.load();
    ASSERT_EQ(scene.lights.size(), 1u);
    expectRigid(scene.lights[0].transform);
    EXPECT_EQ(warningsOf(scene), "light 'Beam': its node is sheared, its axes are made perpendicular\n");
}

TEST(GltfSky, ReadsAConstantOne) {
    LightFile file;
    file.sky() = {{"color", {.5, 1, 2}}, {"intensity", 100}, {"rotation", -1.5}};
    const Scene scene = file.load();
    EXPECT_EQ(scene.sky.radiance, glm::vec3(50, 100, 200));
    EXPECT_EQ(scene.sky.rotation, -1.5f);
    EXPECT_TRUE(scene.sky.pixels.empty());
    EXPECT_EQ(warningsOf(scene), "");
}

TEST(GltfSky, OnlyTheDefaultScenesCounts) {
    LightFile file;
    file.sky() = {{"intensity", 7}};
    file.builder.json["scenes"].push_back({{"nodes", {0}}});
    EXPECT_EQ(file.load().sky.radiance, glm::vec3(7));
    file.builder.json["scene"] = 1;
    EXPECT_FALSE(file.load().sky.shines());
}

TEST(GltfSky, MendsNumbersAndSaysSo) {
    LightFile file;
    file.sky() = {{"color", {1, 1e30, -1}}, {"intensity", 1e30}, {"rotation", "round"}};
    const Scene scene = file.load();
    EXPECT_EQ(scene.sky.radiance, glm::vec3(kBrightest, kBrightest, 0));
    EXPECT_EQ(warningsOf(scene), "sky: its color is negative, 0 is used\n"
                                 "sky: its rotation is not a finite number, 0 is used\n"
                                 "sky: is brighter than 1e+12 cd/m^2 and is dimmed to that\n");
}

TEST(GltfSky, ReadsItsPictureFromTheZenithDown) {
    const std::vector<glm::vec3> pixels = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12},
                                           {0, 0, 0}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
    std::filesystem::create_directories(test::tempPath("skies"));
    writeImage(test::tempPath("skies/studio.exr"), picture(pixels, 4));
    LightFile file;
    file.sky() = {{"file", "skies/studio.exr"}, {"intensity", 3}};
    const Scene scene = file.load();
    EXPECT_EQ(scene.sky.radiance, glm::vec3(3));
    EXPECT_EQ(scene.sky.width, 4u);
    EXPECT_EQ(scene.sky.height, 2u);
    EXPECT_EQ(scene.sky.pixels, pixels);
    EXPECT_TRUE(std::filesystem::equivalent(scene.sky.file, test::tempPath("skies/studio.exr")));
    EXPECT_EQ(warningsOf(scene), "");
}

TEST(GltfSky, MendsPixelsAndCountsThem) {
    writeImage(test::tempPath("broken.exr"),
               picture({{1, NAN, 3}, {-4, 5, -6}, {kInfinity, 80, 9}, {1, 1, 1}, {1, -kInfinity, 1}}, 5));
    LightFile file;
    file.sky() = {{"file", "broken.exr"}};
    const Scene scene = file.load();
    EXPECT_EQ(scene.sky.pixels,
              (std::vector<glm::vec3>{{1, 0, 3}, {0, 5, 0}, {80, 80, 9}, {1, 1, 1}, {1, 0, 1}}));
    EXPECT_EQ(warningsOf(scene),
              "sky 'broken.exr': is 5 x 1, not twice as wide as high: it is stretched over "
              "the sky\n"
              "sky 'broken.exr': 4 of its 5 pixels are negative, infinite or not numbers: 0 "
              "or the largest finite value is used\n");
}

TEST(GltfSky, NamesThePictureItCannotUse) {
    const auto errorOf = [](const std::string& name) {
        LightFile file;
        file.sky() = {{"file", name}};
        const std::string error = file.error();
        EXPECT_EQ(error.rfind(test::tempPath("lights.glb") + ": its sky: " + test::tempPath(name), 0), 0u)
            << error;
        return error.substr(error.rfind(test::tempPath(name)) + test::tempPath(name).size());
    };
    EXPECT_EQ(errorOf("nowhere.exr"), ": no such file: check the name");
    test::writeText("empty.exr", "");
    EXPECT_NE(errorOf("empty.exr").find("cannot be read as an image"), std::string::npos);
    test::writeText("empty.hdr", "");
    EXPECT_NE(errorOf("empty.hdr").find("its header does not end"), std::string::npos);
    test::writeBytes("sky.png", test::kTwoPixels);
    EXPECT_EQ(errorOf("sky.png"), ": a sky's picture must be an .exr or .hdr file: convert it");
    FloatImage grey{2, 1, {}, {}, {}};
    grey.add("Y");
    writeImage(test::tempPath("grey.exr"), grey);
    EXPECT_EQ(errorOf("grey.exr"), ": has no channel R: save it with R, G and B");
    // Runs of a row make such files small, so their size alone does not give them away.
    std::string huge = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8193 +X 8192\n";
    huge.resize(70'000, '\1');
    test::writeText("huge.hdr", huge);
    EXPECT_EQ(errorOf("huge.hdr"), ": has 8192 x 8193 pixels, more than 64 Mpixel: scale it down");
}

TEST(GltfSky, APictureHasAtMost65535PixelsAlongASide) {
    const auto write = [](const std::string& name, uint32_t width, uint32_t height) {
        const std::vector<glm::vec3> pixels(size_t{width} * height, glm::vec3(1.0f));
        writeImage(test::tempPath(name), picture(pixels, width));
        LightFile file;
        file.sky() = {{"file", name}};
        return file;
    };
    EXPECT_EQ(write("wide.exr", 65535, 1).load().sky.width, 65535u);
    EXPECT_EQ(write("high.exr", 1, 65535).load().sky.height, 65535u);
    EXPECT_NE(write("wider.exr", 65536, 1)
                  .error()
                  .find("wider.exr: has 65536 x 1 pixels, more than 65535 along one side: scale it down"),
              std::string::npos);
    EXPECT_NE(write("higher.exr", 1, 65536).error().find("has 1 x 65536 pixels, more than 65535"),
              std::string::npos);
}

} // namespace
} // namespace relume
