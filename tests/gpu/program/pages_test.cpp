// This bakes lightmaps of several pages as a user does, and hands them to all commands that read lightmaps.
#include "assets/gltf/gltf.h"
#include "assets/images/ktx2.h"
#include "assets/images/paged_image.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <set>

#include <fmt/format.h>

namespace relume {
namespace {

using PageWords = std::vector<std::string>;

constexpr uint32_t kPages = 3;

class PagedFiles : public testing::Test {
protected:
    std::string path(const std::string& name) const { return folder_.path(name); }

    ProcessResult run(const PageWords& words) const {
        ProcessResult result = runRelume(words);
        EXPECT_EQ(result.status, 0) << result.err;
        return result;
    }
    /// Bakes onto pages; returns the path that stands for all of them.
    std::string bake(const std::string& name, const PageWords& more = {}, const std::string& pages = "3",
                     const std::string& scene = kScene) const {
        PageWords words = {"bake", scene, "-o", path(name)};
        if (std::find(more.begin(), more.end(), "--size") == more.end())
            words.insert(words.end(), {"--size", "48"});
        if (std::find(more.begin(), more.end(), "--samples") == more.end())
            words.insert(words.end(), {"--samples", "16"});
        if (!pages.empty()) words.insert(words.end(), {"--pages", pages});
        words.insert(words.end(), more.begin(), more.end());
        run(words);
        return path(name);
    }
    static std::string allBytes(const std::string& lightmap) {
        std::string bytes;
        for (const std::string& file : lightmapFiles(lightmap, {kPages})) {
            EXPECT_TRUE(std::filesystem::exists(file)) << file;
            bytes += bytesOf(file);
        }
        return bytes;
    }

    static inline const std::string kScene = RELUME_SOURCE_DIR "/assets/scenes/octagon.glb";
    TemporaryFolder folder_;
};

TEST_F(PagedFiles, ASceneThatIsWrittenWithThemHasTheSameLight) {
    const std::string lit = path("lit.glb");
    const FloatImage first = readLightmapFile(bake("a.exr", {"--scene-out", lit}));
    EXPECT_EQ(first.width, 96u);
    EXPECT_FALSE(std::filesystem::exists(path("a.exr")));
    EXPECT_FALSE(std::filesystem::exists(path("a.3.exr")));
    const Scene scene = loadGltf(lit);
    EXPECT_EQ(scene.pages, kPages);
    std::set<uint32_t> used;
    for (const Instance& instance : scene.instances)
        used.insert(instance.page);
    EXPECT_EQ(used.size(), kPages);
    // It has its pages by itself, and two bakes are the same bytes.
    const FloatImage again = readLightmapFile(bake("b.exr", {}, "", lit));
    EXPECT_EQ(again.planes, first.planes);
    EXPECT_EQ(allBytes(bake("c.exr", {"--scene-out", lit})), allBytes(path("a.exr")));
    const ProcessResult compared = run({"compare", path("a.exr"), path("b.exr"), "--metric", "maximum"});
    EXPECT_EQ(compared.out, "0\n");
    EXPECT_FALSE(contains(compared.err, "page")) << compared.err;
    // Pictures are lit by all pages, and by none alone.
    run({"shot", lit, "--lightmap", path("b.exr"), "--size", "64x48", "-o", path("b.png")});
    run({"shot", kScene, "--lightmap", path("a.exr"), "--size", "64x48", "-o", path("a.png")});
    EXPECT_EQ(bytesOf(path("a.png")), bytesOf(path("b.png")));
    const ProcessResult one =
        runRelume({"shot", lit, "--lightmap", path("b.1.exr"), "--size", "64x48", "-o", path("c.png")});
    EXPECT_EQ(one.status, 1);
    EXPECT_TRUE(contains(one.err, "is page 1 of a lightmap of 3: name all of them as " + path("b.exr")))
        << one.err;
}

// One page may be as large as the sheet of several.
TEST_F(PagedFiles, AreNotComparedWithOnePageInSilence) {
    bake("several.exr");
    bake("one.exr", {"--size", "96"}, "1");
    const ProcessResult compared = run({"compare", path("one.exr"), path("several.exr")});
    EXPECT_TRUE(contains(compared.err, "one.exr has 1 page, ")) << compared.err;
    EXPECT_TRUE(contains(compared.err, "several.exr has 3: ")) << compared.err;
}

TEST_F(PagedFiles, AreTheSameBytesAfterAResume) {
    const std::string checkpoint = path("checkpoint");
    // A GPU would be done before it keeps anything.
    const std::string samples = testDevice().info().software() ? "256" : "16384";
    const PageWords keeps = {"--samples", samples, "--checkpoint", checkpoint, "--checkpoint-every", "0.05"};
    bake("a.exr", keeps);
    ASSERT_TRUE(std::filesystem::exists(checkpoint));
    EXPECT_EQ(allBytes(bake("b.exr", {"--samples", samples, "--resume", checkpoint})),
              allBytes(path("a.exr")));
    const ProcessResult other = runRelume({"bake", kScene, "--size", "48", "--samples", samples, "--pages",
                                           "4", "-o", path("c.exr"), "--resume", checkpoint});
    EXPECT_EQ(other.status, 1);
    EXPECT_TRUE(contains(other.err, "pages=")) << other.err;
}

TEST_F(PagedFiles, HaveLayersThatAreMixedAndJoined) {
    const std::string whole = bake("whole.exr", {"--layers"});
    const LayeredImage layers = readLayeredLightmap(whole);
    ASSERT_GT(layers.layers.size(), 2u);
    run({"mix", whole, "-o", path("sum.exr")});
    EXPECT_EQ(readLightmapFile(path("sum.exr")).planes, layers.composite.planes);
    run({"mix", whole, "--mute", layers.layers[0].name, "-o", path("less.exr")});
    EXPECT_NE(readLightmapFile(path("less.exr")).planes, layers.composite.planes);
    PageWords join = {"mix", "--join"};
    std::string others;
    for (size_t i = 1; i < layers.layers.size(); ++i)
        others += (i > 1 ? "," : "") + layers.layers[i].name;
    join.push_back(bake("one.exr", {"--layers", "--lights", layers.layers[0].name}));
    join.push_back(bake("rest.exr", {"--layers", "--lights", others}));
    join.insert(join.end(), {"-o", path("joined.exr"), "--layers-out"});
    run(join);
    EXPECT_EQ(allBytes(path("joined.exr")), allBytes(whole));
}

TEST_F(PagedFiles, AsManyAsADensityNeeds) {
    run({"bake", kScene, "--size", "48", "--samples", "8", "--pages", "auto", "--density", "6", "-o",
         path("a.exr"), "--json", path("a.json")});
    const auto json = nlohmann::json::parse(bytesOf(path("a.json")));
    // The scene has lightmap UVs, which stay as they are.
    EXPECT_FALSE(json.contains("pages"));
    run({"unwrap", kScene, "--all", "--size", "48", "--pages", "auto", "--density", "8", "-o",
         path("u.glb")});
    EXPECT_GT(loadGltf(path("u.glb")).pages, 1u);
}

nlohmann::json jsonOfGlb(const std::string& path) {
    const std::string bytes = bytesOf(path);
    uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, sizeof length);
    return nlohmann::json::parse(bytes.substr(20, length));
}

TEST_F(PagedFiles, AreATextureEachForEnginesThatLoadThem) {
    const std::string lightmap = bake("a.exr");
    const FloatImage sheet = readLightmapFile(lightmap);
    run({"export", kScene, "--lightmap", lightmap, "--for", "three", "-o", path("web")});
    const nlohmann::json glb = jsonOfGlb(path("web/scene.glb"));
    std::set<int> textures, pages;
    for (const auto& material : glb["materials"]) {
        if (!material.contains("extensions") || !material["extensions"].contains("MOZ_lightmap")) continue;
        textures.insert(material["extensions"]["MOZ_lightmap"]["index"].get<int>());
        pages.insert(material["extras"]["relume"]["page"].get<int>());
    }
    EXPECT_EQ(textures.size(), kPages);
    EXPECT_EQ(pages, (std::set<int>{0, 1, 2}));
    // Each object's materials are of the page that its node tells.
    for (const auto& node : glb["nodes"]) {
        if (!node.contains("mesh")) continue;
        for (const auto& primitive : glb["meshes"][node["mesh"].get<size_t>()]["primitives"]) {
            const auto& material = glb["materials"][primitive["material"].get<size_t>()];
            if (!material.contains("extras")) continue;
            EXPECT_EQ(material["extras"]["relume"]["page"], node["extras"]["relume"]["page"]);
        }
    }
    for (uint32_t page = 0; page < kPages; ++page) {
        const FloatImage own = pageOf(sheet, page);
        const FloatImage read = readImage(path("web/lightmap." + std::to_string(page) + ".exr"));
        EXPECT_EQ(*read.find("R"), *own.find("R"));
        const FloatImage texture = readImage(path("web/lightmap." + std::to_string(page) + ".ktx2"));
        EXPECT_EQ(texture.width, 48u);
    }
    const std::string loader = bytesOf(path("web/loader.js"));
    EXPECT_TRUE(contains(loader, "{ length: 3 }")) << loader;
    EXPECT_FALSE(contains(loader, "@")) << loader;
    // In any viewer of glTF files light is emission, by one texture of all of them.
    run({"export", kScene, "--lightmap", lightmap, "--for", "any", "-o", path("game")});
    EXPECT_EQ(readImage(path("game/lightmap.exr")).width, 96u);
    EXPECT_FALSE(jsonOfGlb(path("game/scene.glb"))["scenes"][0].contains("extras"));
}

// These engines tell pages by the names of materials, which are in their own code.
TEST_F(PagedFiles, AreTheOnesThatAnEnginesCodeHasForItsMaterials) {
    const std::string lightmap = bake("a.exr");
    for (const auto& [engine, code, line] :
         {std::array<std::string, 3>{"godot", "level.gd", "    \"{}\": {},"},
          {"unity", "RelumeLightmap.cs", "        {{ \"{}\", {} }},"},
          {"bevy", "relume_lightmap.rs", "    (\"{}\", {}),"}}) {
        const std::string folder = path(engine) + "/";
        run({"export", kScene, "--lightmap", lightmap, "--for", engine, "-o", folder});
        const std::string text = bytesOf(folder + code);
        EXPECT_FALSE(contains(text, "@EACH") || contains(text, "@PAGE") || contains(text, "@MATERIAL"))
            << text;
        size_t lit = 0;
        const nlohmann::json glb = jsonOfGlb(folder + "scene.glb");
        for (const auto& material : glb["materials"]) {
            if (!material.contains("extensions") || !material["extensions"].contains("MOZ_lightmap"))
                continue;
            ++lit;
            EXPECT_TRUE(contains(text, fmt::format(fmt::runtime(line), material["name"].get<std::string>(),
                                                   material["extras"]["relume"]["page"].get<int>()) +
                                           "\n"))
                << engine << ": " << material["name"];
        }
        EXPECT_GE(lit, kPages);
        for (uint32_t page = 0; page < kPages; ++page)
            EXPECT_EQ(readImage(folder + fmt::format("lightmap.{}.exr", page)).width, 48u);
    }
}

} // namespace
} // namespace relume
