// EXT_lights_area is read and written beside our extras, which say the same and win.
#include "tests/unit/edited_file.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace relume {
namespace {

using nlohmann::json;
using test::jsonOf;
using test::LitScene;

class GltfAreaLight : public test::EditedFile {};

/// A file of another program: two nodes, one scaled, that share a rectangle, and one with a disc.
LitScene panels() {
    LitScene scene;
    scene.json["extensions"]["EXT_lights_area"]["lights"] = {
        {{"type", "rect"},
         {"color", {1, .5, .25}},
         {"intensity", 300},
         {"size", .5},
         {"rect", {{"aspect", 3}}}},
        {{"type", "disk"}, {"name", "Down"}, {"size", .3}}};
    scene.json["extensionsUsed"] = {"EXT_lights_area"};
    const auto add = [&](const char* name, int entry, const json& scale) {
        json node = {{"name", name}, {"translation", {0, 2, 0}}, {"scale", scale}};
        node["extensions"]["EXT_lights_area"]["light"] = entry;
        scene.json["scenes"][0]["nodes"].push_back(scene.node(node));
    };
    add("A", 0, {1, 1, 1});
    add("B", 0, {2, -4, 3});
    add("C", 1, {1, 1, 1});
    return scene;
}

TEST_F(GltfAreaLight, IsReadWithItsNodesLargestScale) {
    const Scene scene = loadGltf(write(panels()));
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.lights[0].type, LightType::Rectangle);
    EXPECT_EQ(scene.lights[0].name, "A");
    EXPECT_EQ(scene.lights[0].size, glm::vec2(1.5f, .5f)) << "size lies along Y, width is size times aspect";
    EXPECT_EQ(scene.lights[0].color, glm::vec3(1, .5f, .25f));
    EXPECT_EQ(scene.lights[0].intensity, 300.0f);
    EXPECT_EQ(scene.lights[1].size, glm::vec2(6, 2));
    EXPECT_EQ(scene.lights[2].type, LightType::Disc);
    EXPECT_EQ(scene.lights[2].name, "Down");
    EXPECT_FLOAT_EQ(scene.lights[2].radius, .15f) << "size is the diameter";
    EXPECT_EQ(scene.lights[2].intensity, 1000.0f) << "where the file has none";
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.front();
}

TEST_F(GltfAreaLight, WhatIsNoLightIsIgnoredWithAWarning) {
    for (const json& odd :
         {json({{"type", "sphere"}}), json({{"type", "rect"}, {"size", 0}}),
          json({{"type", "rect"}, {"size", -1}}), json({{"type", "rect"}, {"rect", {{"aspect", 0}}}})}) {
        LitScene scene = panels();
        scene.json["extensions"]["EXT_lights_area"]["lights"][1] = odd;
        const Scene loaded = loadGltf(write(scene));
        EXPECT_EQ(loaded.lights.size(), 2u) << odd;
        EXPECT_EQ(loaded.warnings.size(), 1u) << odd;
    }
}

TEST_F(GltfAreaLight, OursWinWhereANodeHasBoth) {
    LitScene scene = panels();
    scene.json["nodes"][1]["extras"]["relume"]["areaLight"] = {
        {"type", "rectangle"}, {"size", {7, 8}}, {"intensity", 9}};
    const Scene loaded = loadGltf(write(scene));
    ASSERT_EQ(loaded.lights.size(), 3u);
    EXPECT_EQ(loaded.lights[0].size, glm::vec2(7, 8));
    EXPECT_EQ(loaded.lights[0].intensity, 9.0f);
}

/// Other programs see the light by the extension alone as we do by both.
void expectSameByExtensionAlone(const std::string& path, const std::string& bare) {
    const Scene both = loadGltf(path);
    json file = jsonOf(path);
    for (json& node : file["nodes"])
        node.erase("extras");
    test::GlbBuilder builder;
    builder.json = file;
    const std::string chunks = test::chunksOf(path);
    builder.bin.assign(chunks.begin() + 8, chunks.end());
    const std::vector<uint8_t> bytes = builder.bytes();
    std::ofstream(bare, std::ios::binary) << std::string(bytes.begin(), bytes.end());
    const Scene alone = loadGltf(bare);
    ASSERT_EQ(alone.lights.size(), both.lights.size());
    for (size_t i = 0; i < both.lights.size(); ++i) {
        EXPECT_EQ(alone.lights[i].type, both.lights[i].type);
        EXPECT_EQ(alone.lights[i].name, both.lights[i].name);
        EXPECT_EQ(alone.lights[i].color, both.lights[i].color);
        EXPECT_EQ(alone.lights[i].intensity, both.lights[i].intensity);
        EXPECT_FLOAT_EQ(alone.lights[i].size.x, both.lights[i].size.x);
        EXPECT_FLOAT_EQ(alone.lights[i].size.y, both.lights[i].size.y);
        EXPECT_FLOAT_EQ(alone.lights[i].radius, both.lights[i].radius);
        test::expectNear(alone.lights[i].transform, both.lights[i].transform);
    }
}

TEST_F(GltfAreaLight, IsWrittenInBothForms) {
    Scene scene = loadGltf(write(panels()));
    const std::string path = folder_.path("copy.glb");
    saveGlb(scene, path);
    const json file = jsonOf(path);
    EXPECT_EQ(file["extensionsUsed"], json({"EXT_lights_area"}));
    ASSERT_EQ(file["extensions"]["EXT_lights_area"]["lights"].size(), 3u);
    EXPECT_EQ(file["extensions"]["EXT_lights_area"]["lights"][0], json({{"name", "A"},
                                                                        {"type", "rect"},
                                                                        {"color", {1, .5, .25}},
                                                                        {"intensity", 300},
                                                                        {"size", .5},
                                                                        {"rect", {{"aspect", 3}}}}));
    EXPECT_EQ(file["nodes"][1]["extras"]["relume"]["areaLight"]["size"], json({1.5, .5}));
    expectSameByExtensionAlone(path, folder_.path("bare.glb"));
}

TEST_F(GltfAreaLight, AnEditChangesOneOfTwoThatShareAnEntry) {
    const std::string path = write(panels());
    save(path, [](Scene& scene) {
        scene.lights[1].intensity = 40.0f;
        scene.lights[1].size = {3, 1};
    });
    const Scene back = loadGltf(path);
    EXPECT_EQ(back.lights[0].intensity, 300.0f);
    EXPECT_EQ(back.lights[1].intensity, 40.0f);
    EXPECT_EQ(back.lights[1].size, glm::vec2(3, 1));
    EXPECT_EQ(jsonOf(path)["extensions"]["EXT_lights_area"]["lights"].size(), 3u);
    EXPECT_EQ(jsonOf(path)["extensions"]["EXT_lights_area"]["lights"][2]["size"], 0.25)
        << "times the scale of 4";
    expectSameByExtensionAlone(path, folder_.path("bare.glb"));
}

TEST_F(GltfAreaLight, IsAddedMovedAndDeletedInBothForms) {
    const std::string path = write(LitScene());
    const json original = jsonOf(path);
    save(path, [](Scene& scene) {
        Light light;
        light.type = LightType::Disc;
        light.name = "New";
        light.radius = 0.25f;
        light.intensity = 500.0f;
        light.transform[3] = {1, 2, 3, 1};
        scene.lights.push_back(light);
    });
    EXPECT_EQ(jsonOf(path)["extensions"]["EXT_lights_area"]["lights"][0]["size"], 0.5);
    expectSameByExtensionAlone(path, folder_.path("bare.glb"));
    save(path, [](Scene& scene) {
        scene.lights[0].transform[3].x = 5.0f;
        scene.lights[0].type = LightType::Rectangle;
        scene.lights[0].size = {2, 0.5f};
    });
    EXPECT_EQ(loadGltf(path).lights.at(0).transform[3].x, 5.0f);
    expectSameByExtensionAlone(path, folder_.path("bare.glb"));
    save(path, [](Scene& scene) { scene.lights.clear(); });
    EXPECT_EQ(jsonOf(path), original);
}

TEST_F(GltfAreaLight, AMovedOneKeepsItsSize) {
    LitScene file = panels();
    file.node({{"name", "Stretched"}, {"scale", {1, 5, 1}}, {"children", {2}}});
    file.json["scenes"][0]["nodes"] = {0, 1, 3, 4};
    const std::string path = write(file);
    const Scene before = loadGltf(path);
    save(path, [](Scene& scene) {
        for (Light& light : scene.lights)
            light.transform = glm::mat4(0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 2, 3, 1);
    });
    const Scene back = loadGltf(path);
    ASSERT_EQ(back.lights.size(), 3u);
    for (size_t i = 0; i < back.lights.size(); ++i) {
        EXPECT_EQ(back.lights[i].size, before.lights[i].size) << i;
        EXPECT_EQ(back.lights[i].radius, before.lights[i].radius) << i;
        EXPECT_NEAR(back.lights[i].transform[3].z, 3.0f, 1e-5f) << i;
    }
}

} // namespace
} // namespace relume
