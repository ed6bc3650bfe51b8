// This runs `relume export` as a user does. What it writes is put into the formulas by which engines show a
// level (../../app/export/README.md), and what comes out must be the light that our own bake has.
#include "app/offline/probe_files.h"
#include "app/offline/probe_forms.h"
#include "assets/gltf/gltf.h"
#include "assets/images/image_file.h"
#include "assets/images/ktx2.h"
#include "assets/images/layered_exr.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <gtest/gtest.h>
#include <half.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace relume {
namespace {

namespace fs = std::filesystem;
using ExportWords = std::vector<std::string>;

nlohmann::json glbJson(const std::string& path) {
    const std::string bytes = bytesOf(path);
    uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, sizeof length);
    return nlohmann::json::parse(bytes.substr(20, length));
}

// Returns the number that stands between these texts.
double numberBetween(const std::string& text, const std::string& before) {
    const size_t at = text.find(before);
    EXPECT_NE(at, std::string::npos) << before;
    return at == std::string::npos ? 0.0 : std::strtod(text.c_str() + at + before.size(), nullptr);
}

constexpr uint32_t kEdge = 64; // of the lightmap [texels]

/// A closed room with rough metals, one by texture, a picture on a wall and a lamp.
struct MetalRoom {
    MetalRoom() {
        const int lamp = maker.material(0.2f, 3.0f);
        Material metal;
        metal.name = "Metal";
        metal.baseColor = {0.9f, 0.7f, 0.4f, 1.0f};
        metal.metallic = 1.0f;
        metal.roughness = 0.8f;
        const int metalNumber = maker.material(metal);
        Material half = metal;
        half.name = "Half";
        half.metallic = 0.6f;
        half.roughness = 1.0f;
        const int halfNumber = maker.material(half);
        const int paint = maker.material(0.5f);
        maker.box(
            {0, 0, 0}, {glm::vec3(2, 0, 0), {0, 2, 0}, {0, 0, 2}},
            {metalNumber, halfNumber, paint, paint, lamp, metalNumber},
            {glm::uvec2(14), glm::uvec2(14), glm::uvec2(14), glm::uvec2(14), glm::uvec2(14), glm::uvec2(14)});
        scene = maker.scene();
        Light& light = scene.lights.emplace_back();
        light.name = "Point";
        light.intensity = 2.0f;
        light.transform[3] = {1, 1, 1, 1};
        scene.images = {{"Grey", 2, 1, {188, 188, 188, 255, 188, 188, 188, 255}},
                        {"Steel", 1, 1, {0, 200, 150, 255}}};
        scene.textures = {{.image = 0}, {.image = 1}};
        scene.materials[static_cast<size_t>(paint)].baseColorTexture.texture = 0;
        scene.materials[static_cast<size_t>(halfNumber)].metallicRoughnessTexture.texture = 1;
    }
    SceneMaker maker{kEdge};
    Scene scene;
};

class ExportCommand : public testing::Test {
protected:
    ExportCommand() { saveGlb(room_.scene, scene_); }

    std::string path(const std::string& name) const { return folder_.path(name); }
    void relume(const ExportWords& words) const {
        const ProcessResult run = runRelume(words);
        ASSERT_EQ(run.status, 0) << run.err;
    }
    /// Bakes lighting and what leaves the surfaces.
    void bake() const {
        const ExportWords common = {"bake",      scene_, "--size",    std::to_string(kEdge),
                                    "--samples", "64",   "--validate"};
        ExportWords lighting = common, radiance = common;
        lighting.insert(lighting.end(), {"-o", path("lighting.exr")});
        radiance.insert(radiance.end(), {"-o", path("radiance.exr"), "--quantity", "radiance"});
        relume(lighting);
        relume(radiance);
    }
    std::string exported(const std::string& engine, const ExportWords& more = {}) const {
        ExportWords words = {"export", scene_,     "--lightmap", path("lighting.exr"), "--for",
                             engine,   "--output", path(engine), "--validate"};
        words.insert(words.end(), more.begin(), more.end());
        relume(words);
        return path(engine) + "/";
    }
    /// Returns a picture of a .glb file as readImage() has it.
    FloatImage pictureOf(const std::string& glb, size_t number) const {
        const std::string bytes = bytesOf(glb);
        const nlohmann::json json = glbJson(glb);
        uint32_t length = 0;
        std::memcpy(&length, bytes.data() + 12, sizeof length);
        const nlohmann::json& view = json["bufferViews"][size_t{json["images"][number]["bufferView"]}];
        std::ofstream(path("picture.png"), std::ios::binary)
            << bytes.substr(28 + length + view.value("byteOffset", size_t{0}), size_t{view["byteLength"]});
        return readImage(path("picture.png"));
    }
    ProcessResult refused(const ExportWords& more) const {
        ExportWords words = {"-q", "export", scene_};
        words.insert(words.end(), more.begin(), more.end());
        return runRelume(words);
    }
    /// Calls action(place in the image, material of the exported file, textures included) for each texel
    /// inside of the walls. The material's base colour and metallic factor are those of the texel.
    template<class Action>
    void forWalls(const std::string& glb, const Action& action) const {
        const Scene level = loadGltf(glb);
        const nlohmann::json json = glbJson(glb);
        ASSERT_EQ(level.instances.size(), 6u);
        for (size_t wall = 0; wall < 6; ++wall) {
            const Mesh& mesh = level.meshes[static_cast<size_t>(level.instances[wall].mesh)];
            Material material = level.materials[static_cast<size_t>(mesh.primitives[0].material)];
            const auto pixel = [&](const TextureRef& use) {
                const int image = level.textures[static_cast<size_t>(use.texture)].image;
                return level.images[static_cast<size_t>(image)].rgba;
            };
            if (material.baseColorTexture.texture >= 0)
                material.baseColor *= glm::vec4(
                    glm::vec3(float(linearFromSrgb(pixel(material.baseColorTexture)[0] / 255.0))), 1);
            if (material.metallicRoughnessTexture.texture >= 0)
                material.metallic *= float(pixel(material.metallicRoughnessTexture)[2]) / 255.0f;
            glm::vec2 low(1.0f), high(0.0f);
            for (const glm::vec2& uv : mesh.primitives[0].texCoord1) {
                low = glm::min(low, uv);
                high = glm::max(high, uv);
            }
            const glm::uvec2 begin(glm::round(low * float(kEdge))), end(glm::round(high * float(kEdge)));
            ASSERT_GT(end.x, begin.x + 2);
            for (uint32_t y = begin.y + 1; y + 1 < end.y; ++y)
                for (uint32_t x = begin.x + 1; x + 1 < end.x; ++x)
                    action(size_t{y} * kEdge + x, material);
        }
    }

    TemporaryFolder folder_;
    const std::string scene_ = folder_.path("room.glb");
    const MetalRoom room_;
};

TEST_F(ExportCommand, AFolderHasWhatItsEngineNeedsAndNothingElse) {
    bake();
    const std::map<std::string, ExportWords> own = {{"any", {}},
                                                    {"three", {"index.html", "loader.js"}},
                                                    {"babylon", {"index.html", "loader.js"}},
                                                    {"playcanvas", {"index.html", "loader.js"}},
                                                    {"bevy", {"relume_lightmap.rs"}},
                                                    {"godot", {"level.gd", "level.tscn"}},
                                                    {"unity", {"RelumeLightmap.cs"}},
                                                    {"blender", {"level.py"}}};
    for (const auto& [engine, files] : own) {
        ExportWords expected = {"README.txt", "lightmap.exr", "lightmap.ktx2", "scene.glb"};
        expected.insert(expected.end(), files.begin(), files.end());
        std::sort(expected.begin(), expected.end());
        exported(engine);
        ExportWords found;
        for (const auto& entry : fs::directory_iterator(path(engine)))
            found.push_back(entry.path().filename());
        std::sort(found.begin(), found.end());
        EXPECT_EQ(found, expected) << engine;
        const nlohmann::json json = glbJson(path(engine) + "/scene.glb");
        EXPECT_FALSE(json.contains("extensions")) << "lights"; // of KHR_lights_punctual and ours
        EXPECT_EQ(json["meshes"].size(), 6u);
    }
}

TEST_F(ExportCommand, TheTextureIsTheLightmapToHalfPrecision) {
    bake();
    const FloatImage right = readImage(path("lighting.exr"));
    for (const bool shared : {false, true}) {
        const std::string folder = exported("three", {"--texture-format", shared ? "shared" : "half"});
        const FloatImage exr = readImage(folder + "lightmap.exr"), ktx = readImage(folder + "lightmap.ktx2");
        ASSERT_EQ(ktx.width, right.width);
        for (size_t i = 0; i < right.planes[0].size(); ++i) {
            const float brightest = std::max({exr.planes[0][i], exr.planes[1][i], exr.planes[2][i]});
            for (size_t c = 0; c < 3; ++c) {
                ASSERT_EQ(exr.planes[c][i], right.planes[c][i]);
                if (shared)
                    ASSERT_LE(std::abs(ktx.planes[c][i] - exr.planes[c][i]), brightest / 512 + 1e-7f);
                else
                    ASSERT_EQ(ktx.planes[c][i], float(half(exr.planes[c][i])));
            }
        }
    }
}

// Its 8 bits are linear, which readImage() takes for sRGB.
TEST_F(ExportCommand, ThePictureInTheFileTimesItsIntensityIsTheLightmap) {
    bake();
    const FloatImage right = readImage(path("lighting.exr"));
    const std::string glb = exported("three") + "scene.glb";
    const nlohmann::json json = glbJson(glb);
    for (const nlohmann::json& material : json["materials"]) {
        const nlohmann::json& lightmap = material["extensions"]["MOZ_lightmap"];
        EXPECT_EQ(lightmap["texCoord"], 1);
        const double intensity = lightmap["intensity"];
        const FloatImage image = pictureOf(glb, json["textures"][size_t{lightmap["index"]}]["source"]);
        ASSERT_EQ(image.width, kEdge);
        for (size_t i = 0; i < right.planes[0].size(); ++i)
            for (size_t c = 0; c < 3; ++c)
                ASSERT_NEAR(intensity * srgbFromLinear(double(image.planes[c][i])),
                            double(right.planes[c][i]), intensity / 500.0);
    }
}

// Bevy shows emission x exposure + lightmap x lightmap_exposure x base x (1 - metallic) x exposure, where
// exposure = 2^-EV100 / 1.2 [bevy_pbr, pbr_functions.wgsl; bevy_camera, Exposure].
TEST_F(ExportCommand, BevysFormulaGivesTheLightThatLeavesTheSurfaces) {
    bake();
    const std::string folder = exported("bevy", {"--exposure", "1.5"});
    const FloatImage light = readImage(folder + "lightmap.ktx2"), right = readImage(path("radiance.exr"));
    const double ev100 = numberBetween(bytesOf(folder + "relume_lightmap.rs"), "EV100: f32 = ");
    const double exposure = std::exp2(-ev100) / 1.2;
    EXPECT_NEAR(exposure, std::exp2(1.5), 1e-3);
    forWalls(folder + "scene.glb", [&](size_t i, const Material& material) {
        for (int c = 0; c < 3; ++c) {
            const double shown =
                exposure * double(material.emission[c] + light.planes[size_t(c)][i] * material.baseColor[c] *
                                                             (1.0f - material.metallic));
            const double ours = std::exp2(1.5) * double(right.planes[size_t(c)][i]);
            ASSERT_NEAR(shown, ours, 0.004 * ours) << material.name; // steps of 8 bits in the metals' texture
        }
    });
}

// Godot shows emission, which is exposed in the file, + lightmap x EXPOSURE x albedo x (1 - metallic).
TEST_F(ExportCommand, GodotsFormulaGivesTheLightThatLeavesTheSurfaces) {
    bake();
    const std::string folder = exported("godot", {"--exposure", "-2"});
    const FloatImage light = readImage(folder + "lightmap.exr"), right = readImage(path("radiance.exr"));
    const double factor = numberBetween(bytesOf(folder + "level.gd"), "EXPOSURE := ");
    EXPECT_NEAR(factor, 0.25, 1e-6);
    forWalls(folder + "scene.glb", [&](size_t i, const Material& material) {
        for (int c = 0; c < 3; ++c) {
            const double shown =
                double(material.emission[c]) + factor * double(light.planes[size_t(c)][i]) *
                                                   double(material.baseColor[c] * (1.0f - material.metallic));
            const double ours = 0.25 * double(right.planes[size_t(c)][i]);
            ASSERT_NEAR(shown, ours, 0.004 * ours) << material.name;
        }
    });
}

// glTFast, Unity's importer, reads no KHR_materials_emissive_strength: what shines is exposed in the file.
TEST_F(ExportCommand, UnitysEmissionIsExposedAndEndsAtWhite) {
    bake();
    const auto emissionAt = [&](const std::string& exposure) {
        const Scene level = loadGltf(exported("unity", {"--exposure", exposure}) + "scene.glb");
        glm::vec3 brightest(0.0f);
        for (const Material& material : level.materials)
            brightest = glm::max(brightest, material.emission);
        return brightest;
    };
    EXPECT_EQ(emissionAt("-2"), glm::vec3(0.75f)); // the lamp's 3 cd/m^2
    EXPECT_EQ(emissionAt("3"), glm::vec3(1.0f));
}

TEST_F(ExportCommand, WithoutALightmapItBakesTheOneThatBakeWrites) {
    relume({"bake", scene_, "-o", path("a.exr"), "--size", "32", "--samples", "16"});
    relume({"export", scene_, "-o", path("b"), "--for", "unity", "--size", "32", "--samples", "16"});
    const FloatImage a = readImage(path("a.exr")), b = readImage(path("b/lightmap.exr"));
    for (size_t c = 0; c < 3; ++c)
        EXPECT_EQ(a.planes[c], b.planes[c]);
}

TEST_F(ExportCommand, LayersGiveTheirSum) {
    relume({"bake", scene_, "-o", path("layers.exr"), "--layers", "--size", "32", "--samples", "16"});
    relume({"mix", path("layers.exr"), "-o", path("sum.exr")});
    relume({"export", scene_, "-o", path("b"), "--for", "godot", "--layers", path("layers.exr")});
    const FloatImage a = readImage(path("sum.exr")), b = readImage(path("b/lightmap.exr"));
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < a.planes[c].size(); ++i)
            ASSERT_NEAR(a.planes[c][i], b.planes[c][i], 1e-5f * std::abs(a.planes[c][i]));
    // A scene that was written beside the lightmap is its own, another one is not.
    relume({"bake", scene_, "-o", path("l.exr"), "--scene-out", path("lit.glb"), "--size", "32", "--samples",
            "16"});
    const ProcessResult lit = runRelume(
        {"export", path("lit.glb"), "-o", path("d"), "--for", "godot", "--lightmap", path("l.exr")});
    EXPECT_EQ(lit.status, 0) << lit.err;
    EXPECT_EQ(lit.err.find("is a lightmap of"), std::string::npos) << lit.err;
    const std::string other = path("other.glb");
    std::filesystem::copy_file(scene_, other);
    const ProcessResult run =
        runRelume({"export", other, "-o", path("c"), "--for", "godot", "--layers", path("layers.exr")});
    EXPECT_NE(run.err.find("layers.exr: is a lightmap of room.glb, not of " + other), std::string::npos)
        << run.err;
}

TEST_F(ExportCommand, LightProbesComeAlongAsTheEngineReadsThem) {
    relume({"bake", scene_, "-o", path("layers.exr"), "--layers", "--size", std::to_string(kEdge),
            "--samples", "64", "--probes", "0.5", "--probe-samples", "64", "--probes-out", path("p.json")});
    const ProbeSet probes = readProbes(path("p.json"));
    ASSERT_TRUE(probes.grid);
    const auto with = [&](const std::string& engine, const std::string& layers) {
        const std::string folder = path(engine + layers);
        relume({"export", scene_, "--layers", path(layers), "--for", engine, "--output", folder, "--probes",
                path("p.json")});
        return folder + "/";
    };
    const std::string three = with("three", "layers.exr"), bevy = with("bevy", "layers.exr");
    EXPECT_EQ(bytesOf(three + "probes.three.json"), threeProbes(readProbes(three + "probes.json"), "probes"));
    const auto group = nlohmann::json::parse(bytesOf(three + "probes.three.json")).at("object");
    EXPECT_EQ(group.at("children").size(), probes.probes.size());
    EXPECT_NE(bytesOf(three + "README.txt").find("probes.three.json"), std::string::npos);
    ProbeSet weighed = probes;
    weighLike(weighed, readLayeredExr(path("layers.exr")));
    EXPECT_EQ(bytesOf(bevy + "probes.ktx2"), probeBytes("probes.ktx2", weighed));
    EXPECT_NE(bytesOf(bevy + "README.txt").find("IrradianceVolume"), std::string::npos);
    EXPECT_FALSE(fs::exists(three + "probes.ktx2"));
    EXPECT_FALSE(fs::exists(bevy + "probes.three.json"));

    // They are weighed as the layers are.
    relume({"mix", path("layers.exr"), "-o", path("mixed.exr"), "--layers-out", "--set", "Point*=3"});
    const ProbeSet mixed = readProbes(with("any", "mixed.exr") + "probes.json");
    EXPECT_GT(mixed.probes[0].radiance[0].g, 1.05 * probes.probes[0].radiance[0].g);

    // Places that are no grid are no volume.
    relume({"bake", scene_, "-o", path("one.exr"), "--size", std::to_string(kEdge), "--samples", "64",
            "--probe-at", "1,1,1", "--probe-samples", "64", "--probes-out", path("one.json")});
    relume({"export", scene_, "--lightmap", path("one.exr"), "--for", "bevy", "--output", path("one"),
            "--probes", path("one.json")});
    EXPECT_TRUE(fs::exists(path("one/probes.json")));
    EXPECT_FALSE(fs::exists(path("one/probes.ktx2")));
    const ProcessResult odd = refused({"--lightmap", path("one.exr"), "--for", "three", "--output",
                                       path("odd"), "--probes", path("layers.exr")});
    EXPECT_EQ(odd.status, 1);
    EXPECT_EQ(std::count(odd.err.begin(), odd.err.end(), '\n'), 1) << odd.err;
    EXPECT_FALSE(fs::exists(path("odd")));
}

TEST_F(ExportCommand, WrongUsageIsToldAndNothingIsWritten) {
    const std::string out = path("out");
    for (const ExportWords& words :
         std::vector<ExportWords>{{"-o", out},
                                  {"--for", "three"},
                                  {"--for", "quake", "-o", out},
                                  {"--for", "three", "-o", out, "--texture-size", "64"},
                                  {"--for", "babylon", "-o", out, "--texture-format", "shared"},
                                  {"--for", "three", "-o", out, "--lightmap", "a.exr", "--layers", "b.exr"},
                                  {"--for", "three", "-o", out, "--lightmap", "a.exr", "--samples", "4"},
                                  {"--for", "three", "-o", out, "--lightmap", "a.exr", "--size", "64"}}) {
        const ProcessResult run = refused(words);
        EXPECT_EQ(run.status, 2) << words.back() << run.err;
    }
    EXPECT_EQ(folder_.files(), ExportWords{"room.glb"});
}

TEST_F(ExportCommand, WhatIsWrongWithFilesIsToldInALineAndNothingIsWritten) {
    std::ofstream(path("file")) << "text";
    const ExportWords before = {"file", "grey.exr", "room.glb", "wide.exr"};
    FloatImage wide{8, 4, {}, {}, {}};
    for (const char* channel : {"R", "G", "B"})
        wide.add(channel);
    writeImage(path("wide.exr"), wide);
    FloatImage grey{8, 8, {}, {}, {}};
    grey.add("Y");
    writeImage(path("grey.exr"), grey);
    const auto told = [&](const std::string& lightmap, const std::string& folder) {
        const ProcessResult run = refused({"--for", "three", "-o", folder, "--lightmap", lightmap});
        EXPECT_EQ(run.status, 1) << run.err;
        EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
        EXPECT_EQ(folder_.files(), before);
        return run.err;
    };
    EXPECT_TRUE(contains(told(path("none.exr"), path("out")), "none.exr"));
    EXPECT_TRUE(contains(told(path("wide.exr"), path("out")), "wide.exr"));
    EXPECT_TRUE(contains(told(path("grey.exr"), path("out")), "grey.exr"));
    EXPECT_TRUE(contains(told(path("file"), path("out")), path("file") + ":"));
    EXPECT_TRUE(contains(told(path("wide.exr"), path("file")), "is a file"));
    EXPECT_TRUE(contains(told(path("wide.exr"), path("no/out")), path("no")));
}

TEST_F(ExportCommand, WhatItReadsIsNotOverwritten) {
    bake();
    fs::create_directory(path("three"));
    fs::rename(path("lighting.exr"), path("three/lightmap.exr"));
    const std::string before = bytesOf(path("three/lightmap.exr"));
    const ProcessResult run =
        refused({"--for", "three", "-o", path("three"), "--lightmap", path("three/lightmap.exr")});
    EXPECT_NE(run.status, 0);
    EXPECT_TRUE(contains(run.err, "lightmap.exr")) << run.err;
    EXPECT_EQ(bytesOf(path("three/lightmap.exr")), before);
}

TEST_F(ExportCommand, AFolderThatIsThereKeepsItsOtherFiles) {
    bake();
    fs::create_directory(path("three"));
    std::ofstream(path("three/mine.txt")) << "text";
    exported("three");
    exported("three"); // once more, over its own files
    EXPECT_EQ(bytesOf(path("three/mine.txt")), "text");
}

} // namespace
} // namespace relume
