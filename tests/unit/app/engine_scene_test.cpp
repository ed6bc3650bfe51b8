#include "app/export/engine_scene.h"

#include "app/export/any_scene.h"
#include "app/export/engine_files.h"
#include "app/export/engine_metals.h"
#include "app/export/surface_light.h"
#include "assets/base/error.h"
#include "tests/text.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

namespace relume {
namespace {

Primitive mappedSquare(int material) {
    Primitive square;
    square.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    square.normals.assign(4, glm::vec3(0, 0, 1));
    square.texCoord0 = square.texCoord1 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    square.indices = {0, 1, 2, 0, 2, 3};
    square.material = material;
    return square;
}

/// Makes two copies of one mesh, each with half of the atlas, and a third object without lightmap UVs.
struct ThreeObjects {
    ThreeObjects() {
        scene.materials.resize(1);
        scene.materials[0].name = "Paint";
        scene.materials[0].baseColor = {0.5f, 0.25f, 1.0f, 1.0f};
        scene.materials[0].metallic = 0.0f;
        scene.meshes.push_back({"Square", {mappedSquare(0)}});
        for (const char* name : {"Left", "Right", "Bare"})
            scene.instances.push_back({name, 0, glm::mat4(1.0f)});
        scene.lights.resize(2);
        scene.sky.radiance = glm::vec3(1.0f);
        atlas.instances = {
            {{0.5f, 1.0f}, {0.0f, 0.0f}, 1}, {{0.5f, 1.0f}, {0.5f, 0.0f}, 1}, {{1.0f, 1.0f}, {0, 0}, -1}};
        atlas.repacked = true;
    }
    Scene scene;
    LightmapAtlas atlas;
};

const glm::vec3 kAmbient(2.0f, 4.0f, 8.0f);

TEST(EngineScene, EachObjectGetsAMeshWithItsOwnPartOfTheLightmap) {
    const ThreeObjects three;
    const EngineScene out = engineScene(three.scene, three.atlas, kAmbient);
    ASSERT_EQ(out.scene.instances.size(), 3u);
    std::set<int> meshes;
    for (const Instance& instance : out.scene.instances)
        meshes.insert(instance.mesh);
    EXPECT_EQ(meshes.size(), 3u);
    const auto uv = [&](size_t object, size_t vertex) {
        const auto mesh = static_cast<size_t>(out.scene.instances[object].mesh);
        return out.scene.meshes[mesh].primitives[0].texCoord1[vertex];
    };
    EXPECT_EQ(uv(0, 2), glm::vec2(0.5f, 1.0f));
    EXPECT_EQ(uv(1, 0), glm::vec2(0.5f, 0.0f));
    EXPECT_EQ(out.scene.meshes[static_cast<size_t>(out.scene.instances[1].mesh)].name, "Right");
}

// Engines darken the lightmap by an occlusion map, which it has in it already.
TEST(EngineScene, NormalMapsAreKeptAndOcclusionIsLeftOut) {
    ThreeObjects three;
    Scene& scene = three.scene;
    scene.images = {{"Unused", 1, 1, {0, 0, 0, 255}}, {"Shared", 1, 1, {9, 9, 9, 255}}};
    scene.textures.resize(2);
    scene.textures[0].image = 0;
    scene.textures[1].image = 1;
    scene.keptTextures.resize(3);
    scene.keptTextures[1].texture = 1;
    scene.keptTextures[2].name = "Bumps";
    scene.materials.push_back(scene.materials[0]);
    scene.materials[0].normalMap.use.texture = 2;
    scene.materials[0].normalMap.amount = 0.5f;
    scene.materials[0].occlusionMap.use.texture = 0;
    scene.materials[1].normalMap.use.texture = 1;
    scene.meshes.push_back({"Other", {mappedSquare(1)}});
    scene.instances[1].mesh = 1;
    const Scene out = engineScene(scene, three.atlas, kAmbient).scene;
    ASSERT_EQ(out.keptTextures.size(), 2u);
    ASSERT_EQ(out.textures.size(), 1u);
    const auto materialOf = [&](size_t object) -> const Material& {
        const auto mesh = static_cast<size_t>(out.instances[object].mesh);
        return out.materials[static_cast<size_t>(out.meshes[mesh].primitives[0].material)];
    };
    const KeptMap left = materialOf(0).normalMap, right = materialOf(1).normalMap;
    EXPECT_EQ(out.keptTextures[static_cast<size_t>(left.use.texture)].name, "Bumps");
    EXPECT_EQ(left.amount, 0.5f);
    const KeptTexture& shared = out.keptTextures[static_cast<size_t>(right.use.texture)];
    ASSERT_EQ(shared.texture, 0);
    EXPECT_EQ(out.images[static_cast<size_t>(out.textures[0].image)].name, "Shared");
    EXPECT_EQ(materialOf(0).occlusionMap.use.texture, -1);
}

TEST(EngineScene, LightsAndSkyAreLeftOutAsTheLightmapHasThem) {
    const ThreeObjects three;
    const EngineScene out = engineScene(three.scene, three.atlas, kAmbient);
    EXPECT_TRUE(out.scene.lights.empty());
    EXPECT_FALSE(out.scene.sky.shines());
}

TEST(EngineScene, WhatHasNoLightmapUvsShinesAsTheMeanLightMakesIt) {
    const ThreeObjects three;
    const EngineScene out = engineScene(three.scene, three.atlas, kAmbient);
    const auto materialOf = [&](size_t object) {
        const auto mesh = static_cast<size_t>(out.scene.instances[object].mesh);
        return static_cast<size_t>(out.scene.meshes[mesh].primitives[0].material);
    };
    EXPECT_EQ(materialOf(0), materialOf(1));
    EXPECT_NE(materialOf(0), materialOf(2));
    EXPECT_TRUE(out.lit[materialOf(0)]);
    EXPECT_FALSE(out.lit[materialOf(2)]);
    EXPECT_EQ(out.scene.materials[materialOf(0)].emission, glm::vec3(0.0f));
    EXPECT_EQ(out.scene.materials[materialOf(2)].emission, glm::vec3(1.0f, 1.0f, 8.0f));
    // Engines find materials by name.
    EXPECT_NE(out.scene.materials[materialOf(0)].name, out.scene.materials[materialOf(2)].name);
}

// Vertex colours are in the base colour of glTF and not in its emission. Two triangles of 1 and 3 times the
// area: a quarter of the first one's colour and three of the other's.
TEST(EngineScene, WhatShinesInPlaceOfTheLightmapHasItsVertexColours) {
    ThreeObjects three;
    Primitive& square = three.scene.meshes[0].primitives[0];
    square.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {3, 0, 0}, {0, 1, 0}};
    square.indices = {0, 1, 2, 3, 4, 5};
    square.normals.assign(6, glm::vec3(0, 0, 1));
    square.texCoord0.assign(6, glm::vec2(0));
    square.texCoord1.assign(6, glm::vec2(0));
    square.colors.assign(3, glm::vec4(1, 0, 0, 1));
    square.colors.resize(6, glm::vec4(0, 1, 0.5f, 1));
    const EngineScene out = engineScene(three.scene, three.atlas, kAmbient);
    const auto emissionOf = [&](size_t object) {
        const auto mesh = static_cast<size_t>(out.scene.instances[object].mesh);
        return out.scene.materials[static_cast<size_t>(out.scene.meshes[mesh].primitives[0].material)]
            .emission;
    };
    EXPECT_EQ(emissionOf(2), glm::vec3(0.25f, 0.75f, 3.0f)) << "of 1 1 8";
    EXPECT_EQ(emissionOf(0), glm::vec3(0.0f));
}

TEST(EngineScene, PanesAreNotLitByTheLightmap) {
    ThreeObjects three;
    three.scene.materials[0].pane = true;
    const EngineScene out = engineScene(three.scene, three.atlas, kAmbient);
    EXPECT_TRUE(std::none_of(out.lit.begin(), out.lit.end(), [](bool lit) { return lit; }));
    for (const Material& material : out.scene.materials)
        EXPECT_EQ(material.emission, glm::vec3(1.0f, 1.0f, 8.0f));
}

// Some engines light whatever has a second set of UVs.
TEST(EngineScene, WhatTheLightmapDoesNotLightHasNoLightmapUvs) {
    ThreeObjects three;
    const auto uvsOf = [](const EngineScene& level, size_t object) {
        const auto mesh = static_cast<size_t>(level.scene.instances[object].mesh);
        return level.scene.meshes[mesh].primitives[0].texCoord1.size();
    };
    const EngineScene bare = engineScene(three.scene, three.atlas, kAmbient);
    EXPECT_EQ(uvsOf(bare, 0), 4u);
    EXPECT_EQ(uvsOf(bare, 2), 0u);
    three.scene.materials[0].pane = true;
    EXPECT_EQ(uvsOf(engineScene(three.scene, three.atlas, kAmbient), 0), 0u);
    // Its picture was laid out by them before they were placed, which are another set now.
    three.scene.images = {{"Used", 1, 1, {9, 9, 9, 255}}};
    three.scene.textures = {{.image = 0}};
    three.scene.materials[0].baseColorTexture = {.texture = 0, .texCoord = 1};
    const EngineScene pictured = engineScene(three.scene, three.atlas, kAmbient);
    EXPECT_EQ(uvsOf(pictured, 0), 0u);
    const Primitive& square = pictured.scene.meshes[0].primitives[0];
    const Material& pane = pictured.scene.materials[static_cast<size_t>(square.material)];
    EXPECT_EQ(uvSet(square, pane.baseColorTexture.texCoord), three.scene.meshes[0].primitives[0].texCoord1);
}

TEST(EngineScene, TexturesKeepTheirUvsBesideTheLightmaps) {
    ThreeObjects three;
    Scene& scene = three.scene;
    scene.images.push_back({"", 1, 1, {1, 2, 3, 4}});
    scene.textures.push_back({0, Wrap::Repeat, Wrap::Repeat, false});
    scene.materials[0].baseColorTexture = {0, 0, glm::mat3(1)};
    scene.materials[0].emissionTexture = {0, 1, glm::mat3(1)};
    scene.meshes[0].primitives[0].texCoord0 = {{0, 0}, {5, 0}, {5, 5}, {0, 5}};
    const EngineScene level = engineScene(scene, three.atlas, kAmbient);
    const Primitive& left = level.scene.meshes.at(0).primitives.at(0);
    const Material& material = level.scene.materials.at(static_cast<size_t>(left.material));
    EXPECT_EQ(left.movedUvs, -1) << "the material itself says which set is read";
    EXPECT_EQ(uvsOf(left, material.baseColorTexture)[2], glm::vec2(5, 5));
    EXPECT_EQ(material.emissionTexture.texCoord, 2);
    EXPECT_EQ(uvsOf(left, material.emissionTexture)[2], glm::vec2(1, 1));
    EXPECT_NE(left.texCoord1[2], glm::vec2(1, 1)) << "a part of the atlas";
    EXPECT_EQ(meshesWithThirdSet(level.scene), (std::vector<std::string>{"Left", "Right"}));
    scene.materials[0].emissionTexture.texCoord = 0;
    EXPECT_TRUE(meshesWithThirdSet(engineScene(scene, three.atlas, kAmbient).scene).empty());
}

// Returns a lightmap of one texel that is lit.
SurfaceLight oneTexel() {
    SurfaceLight light;
    light.size = 1;
    light.reflected = {glm::vec3(6.0f)};
    light.emitted = {glm::vec3(0.0f)};
    light.material = {1};
    return light;
}

TEST(AnyScene, WhateverShinesIsBroughtToTheScreen) {
    ThreeObjects three;
    three.scene.materials.push_back(three.scene.materials[0]);
    three.scene.materials[1].name = "Pane";
    three.scene.materials[1].pane = true;
    three.scene.meshes.push_back({"Window", {mappedSquare(1)}});
    three.scene.instances[1].mesh = 1;
    EngineScene level = engineScene(three.scene, three.atlas, kAmbient);
    lightByEmission(level, oneTexel(), three.scene.materials, -1.0f);
    const auto emissionOf = [&](size_t object) {
        const auto mesh = static_cast<size_t>(level.scene.instances[object].mesh);
        const int material = level.scene.meshes[mesh].primitives[0].material;
        return level.scene.materials[static_cast<size_t>(material)].emission;
    };
    EXPECT_EQ(emissionOf(0), glm::vec3(3.0f));             // by the lightmap
    EXPECT_EQ(emissionOf(1), glm::vec3(0.5f, 0.5f, 4.0f)); // the pane: base x mean light x 2^-1
    EXPECT_EQ(emissionOf(2), glm::vec3(0.5f, 0.5f, 4.0f)); // without UVs
}

// Godot knows no rotation.
TEST(EngineScene, TransformsThatTexturesShareGoIntoTheirUvs) {
    Scene scene;
    scene.textures = {{.image = 0}};
    const glm::mat3 turned(0, -2, 0, 2, 0, 0, 0.5f, 0.25f, 1); // (x, y) to (2 y + .5, .25 - 2 x)
    scene.materials.resize(3);
    scene.materials[0].baseColorTexture = {0, 0, turned};
    scene.materials[0].emissionTexture = {0, 0, turned};
    scene.materials[1].baseColorTexture = {0, 0, turned};
    scene.materials[1].emissionTexture = {0, 0, glm::mat3(1.0f)};
    scene.materials[1].name = "Two";
    scene.materials[2].baseColorTexture = {0, 1, turned};
    for (int material = 0; material < 3; ++material)
        scene.meshes.push_back({"", {mappedSquare(material)}});
    for (Mesh& mesh : scene.meshes)
        mesh.primitives[0].texCoord0 = {{0, 0}, {1, 0}, {1, 3}, {0, 3}};
    const Scene before = scene;
    EXPECT_EQ(applyTextureTransforms(scene), std::vector<std::string>{"Two"});
    EXPECT_EQ(scene.meshes[0].primitives[0].texCoord0,
              (std::vector<glm::vec2>{{0.5f, 0.25f}, {0.5f, -1.75f}, {6.5f, -1.75f}, {6.5f, 0.25f}}));
    for (const TextureRef* use : {&scene.materials[0].baseColorTexture, &scene.materials[0].emissionTexture})
        EXPECT_EQ(use->transform, glm::mat3(1.0f));
    for (size_t other : {1u, 2u}) {
        EXPECT_EQ(scene.meshes[other].primitives[0].texCoord0, before.meshes[other].primitives[0].texCoord0);
        EXPECT_EQ(scene.materials[other].baseColorTexture.transform, turned);
    }
}

TEST(EngineFiles, GodotsSkyIsAColourOfItsScreen) {
    const glm::vec3 sky(4, 8, 16); // .25, .5 and 1 on the screen: .537099, .735357 and 1 in sRGB
    const std::vector<EngineFile> files =
        engineFiles(Engine::Godot, {.name = "A", .exposure = -4, .sky = sky});
    const auto level = std::find_if(files.begin(), files.end(),
                                    [](const EngineFile& file) { return file.name == "level.tscn"; });
    ASSERT_NE(level, files.end());
    EXPECT_TRUE(contains(level->text, "background_color = Color(0.537099, 0.735357, 1, 1)")) << level->text;
}

// Engines add emission to what is seen through glass.
TEST(EngineScene, PanesShineByTheShareThatTheyDoNotTransmit) {
    for (const auto& [transmission, shown] : {std::pair(0.0f, 1.0f), {0.75f, 0.25f}, {1.0f, 0.08f}}) {
        ThreeObjects three;
        three.scene.materials[0].pane = true;
        three.scene.materials[0].transmission = transmission;
        const EngineScene out = engineScene(three.scene, three.atlas, kAmbient);
        const glm::vec3 whole(1.0f, 1.0f, 8.0f); // base x mean light
        for (const Material& material : out.scene.materials)
            for (int c = 0; c < 3; ++c)
                EXPECT_FLOAT_EQ(material.emission[c], shown * whole[c]) << transmission;
        Scene blended = out.scene; // of which blending shows the same share
        blendWhatTransmits(blended);
        for (const Material& material : blended.materials) {
            EXPECT_EQ(material.transmission, 0.0f);
            EXPECT_EQ(material.alphaMode, transmission > 0.0f ? AlphaMode::Blend : AlphaMode::Opaque);
            EXPECT_FLOAT_EQ(material.baseColor.a, shown);
            for (int c = 0; c < 3; ++c)
                EXPECT_FLOAT_EQ(material.emission[c], whole[c]);
        }
    }
}

// A viewer's surroundings are no light of the level's.
TEST(AnyScene, PanesThatBlendReflectNothingAndThoseThatTransmitKeepTheirTint) {
    for (const float transmission : {0.0f, 0.9f}) {
        ThreeObjects three;
        Material& pane = three.scene.materials[0];
        pane.pane = true;
        pane.alphaMode = AlphaMode::Blend;
        pane.baseColor = {0.5f, 0.7f, 1.0f, 0.3f};
        pane.transmission = transmission;
        EngineScene level = engineScene(three.scene, three.atlas, kAmbient);
        lightByEmission(level, oneTexel(), three.scene.materials, 0.0f);
        for (const Material& material : level.scene.materials) {
            EXPECT_EQ(material.baseColor.a, 0.3f);
            EXPECT_EQ(glm::vec3(material.baseColor),
                      transmission > 0.0f ? glm::vec3(0.5f, 0.7f, 1.0f) : glm::vec3(0.0f));
            EXPECT_GT(material.emission.g, 0.0f);
        }
    }
}

TEST(EngineScene, HiddenObjectsAreLeftOut) {
    ThreeObjects three;
    three.scene.instances[0].hidden = true;
    const EngineScene out = engineScene(three.scene, three.atlas, kAmbient);
    ASSERT_EQ(out.scene.instances.size(), 2u);
    EXPECT_EQ(out.scene.instances[0].name, "Right");
}

TEST(EngineScene, OwnLightStaysAsItIs) {
    ThreeObjects three;
    three.scene.materials[0].emission = {5, 6, 7};
    const EngineScene out = engineScene(three.scene, three.atlas, kAmbient);
    for (const Material& material : out.scene.materials)
        EXPECT_EQ(material.emission, glm::vec3(5, 6, 7));
}

TEST(EngineScene, ObjectsWithoutAMaterialGetGltfsDefaultOne) {
    ThreeObjects three;
    three.scene.meshes[0].primitives[0].material = -1;
    three.scene.materials.clear();
    const EngineScene out = engineScene(three.scene, three.atlas, kAmbient);
    for (const Mesh& mesh : out.scene.meshes)
        ASSERT_GE(mesh.primitives[0].material, 0);
    EXPECT_TRUE(contains(out.scene.materials[0].name, "Default"));
}

TEST(EngineScene, TexturesThatNobodyReadsAreLeftOut) {
    ThreeObjects three;
    three.scene.images = {{"Unused", 1, 1, {1, 1, 1, 255}}, {"Used", 1, 1, {9, 9, 9, 255}}};
    three.scene.textures = {{.image = 0}, {.image = 1}};
    three.scene.materials[0].baseColorTexture.texture = 1;
    const EngineScene out = engineScene(three.scene, three.atlas, kAmbient);
    ASSERT_EQ(out.scene.images.size(), 1u);
    EXPECT_EQ(out.scene.images[0].name, "Used");
    EXPECT_EQ(out.scene.materials[0].baseColorTexture.texture, 0);
}

// Our kernels and engines must make the same of a surface [shaders/lib/scene_material.glsl].
TEST(EngineMetals, AnEnginesAlbedoIsOurs) {
    for (const float metallic : {0.0f, 0.3f, 1.0f})
        for (const float roughness : {0.0f, 0.5f, 1.0f}) {
            const float ours = 1.0f - metallic + 0.5f * metallic * roughness * roughness;
            EXPECT_FLOAT_EQ(1.0f - engineMetallic(metallic, roughness), ours);
        }
}

TEST(EngineMetals, TexturesGetTheFactorTexelByTexel) {
    Scene scene;
    scene.images = {{"Metal", 2, 1, {0, 255, 255, 255, 0, 0, 255, 255}}}; // rough metal, polished metal
    scene.textures = {{.image = 0}};
    scene.materials.resize(3);
    for (Material& material : scene.materials)
        material.metallicRoughnessTexture.texture = 0;
    scene.materials[2].metallic = 0.5f;
    giveEngineMetals(scene);
    const auto blue = [&](size_t material, size_t texel) {
        const auto texture = static_cast<size_t>(scene.materials[material].metallicRoughnessTexture.texture);
        return int{scene.images[static_cast<size_t>(scene.textures[texture].image)].rgba[4 * texel + 2]};
    };
    EXPECT_EQ(blue(0, 0), 128); // half of the light of a fully rough metal
    EXPECT_EQ(blue(0, 1), 255);
    EXPECT_EQ(blue(2, 0), 64);
    EXPECT_EQ(blue(2, 1), 128);
    EXPECT_EQ(scene.materials[0].metallic, 1.0f);
    EXPECT_EQ(scene.materials[0].metallicRoughnessTexture.texture,
              scene.materials[1].metallicRoughnessTexture.texture);
    EXPECT_EQ(scene.images.size(), 3u); // equal factors share one
}

TEST(FillBetween, RingsGetTheMeanOfTheirNeighbours) {
    constexpr uint32_t kSize = 8;
    std::vector<glm::vec3> texels(kSize * kSize, glm::vec3(0.0f));
    std::vector<bool> has(texels.size(), false);
    const auto put = [&](uint32_t x, uint32_t y, float value) {
        texels[y * kSize + x] = glm::vec3(value);
        has[y * kSize + x] = true;
    };
    put(2, 2, 1.0f);
    put(2, 4, 3.0f);
    fillBetween(texels, has, kSize, 1);
    EXPECT_EQ(texels[2 * kSize + 2].x, 1.0f);
    EXPECT_EQ(texels[1 * kSize + 1].x, 1.0f); // beside the first alone
    EXPECT_EQ(texels[3 * kSize + 2].x, 2.0f); // between both
    EXPECT_EQ(texels[5 * kSize + 3].x, 3.0f);
    for (const glm::vec3& texel : texels) { // no texel stays black
        EXPECT_GE(texel.x, 1.0f);
        EXPECT_LE(texel.x, 3.0f);
    }
}

TEST(FillBetween, NothingComesOfNothing) {
    std::vector<glm::vec3> texels(16, glm::vec3(0.0f));
    fillBetween(texels, std::vector<bool>(16, false), 4, 2);
    for (const glm::vec3& texel : texels)
        EXPECT_EQ(texel, glm::vec3(0.0f));
}

TEST(EngineFiles, NothingIsLeftToFillIn) {
    const std::set<std::string> marks = {"@NAME@", "@EV@",   "@EV100@", "@FACTOR@", "@SKY@",     "@PAGES@",
                                         "@ONE@",  "@MANY@", "@EACH@",  "@PAGE@",   "@MATERIAL@"};
    for (const uint32_t pages : {1u, 3u})
        for (size_t engine = 0; engine < engineNames().size(); ++engine) {
            const auto files = engineFiles(
                static_cast<Engine>(engine),
                {.name = "level", .exposure = 1, .sky = {1, 2, 3}, .pages = pages, .lit = {{"Wall", 2}}});
            EXPECT_TRUE(std::any_of(files.begin(), files.end(), [](const EngineFile& file) {
                return file.name == "README.txt";
            })) << engineNames()[engine];
            for (const EngineFile& file : files) {
                for (const std::string& mark : marks)
                    EXPECT_FALSE(contains(file.text, mark)) << file.name << " has " << mark;
                if (file.name == "README.txt") {
                    EXPECT_LE(std::count(file.text.begin(), file.text.end(), '\n'), 12)
                        << engineNames()[engine];
                }
            }
        }
}

TEST(EngineFiles, ANameIsNoMarkup) {
    for (const EngineFile& file : engineFiles(Engine::Three, {.name = "a<b>&c"}))
        if (file.name == "index.html") {
            EXPECT_TRUE(contains(file.text, "a&lt;b>&amp;c"));
        }
}

TEST(EngineFiles, ANameEndsNoTextInQuotes) {
    for (const EngineFile& file :
         engineFiles(Engine::Godot, {.name = "level", .pages = 3, .lit = {{R"(a "b\c)", 2}}}))
        if (file.name == "level.gd") {
            EXPECT_TRUE(contains(file.text, R"("a \"b\\c": 2,)")) << file.text;
        }
}

TEST(EngineScene, NamesOfMaterialsAreOneLine) {
    ThreeObjects three;
    three.scene.materials[0].name = "of two\nlines";
    const EngineScene out = engineScene(three.scene, three.atlas, kAmbient);
    EXPECT_EQ(out.scene.materials[0].name, "of two lines");
}

TEST(EngineFiles, UnknownEnginesAreToldWithThoseThatThereAre) {
    try {
        engineOf("quake");
        FAIL();
    } catch (const Error& error) {
        EXPECT_TRUE(contains(error.what(), "quake"));
        EXPECT_TRUE(contains(error.what(), "three"));
    }
}

} // namespace
} // namespace relume
