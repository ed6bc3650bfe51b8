#include "assets/gltf/gltf.h"
#include "assets/gltf/edit/gltf_edit.h"

#include "assets/base/error.h"
#include "tests/unit/glb_builder.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace relume {
namespace {

using nlohmann::json;
using test::GlbBuilder;
using test::squareScene;

bool says(const Scene& scene, const std::string& part) {
    return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                       [&](const std::string& w) { return w.find(part) != std::string::npos; });
}

std::string refusalOf(const std::string& path, const GltfChoice& choice) {
    try {
        loadGltf(path, choice);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

/// Makes a file of three scenes: "Day" with one square, one without a name with two, "Night" with three.
GlbBuilder threeScenes() {
    GlbBuilder b;
    const int mesh = b.mesh(b.square());
    for (const char* name : {"A", "B", "C"})
        b.node({{"mesh", mesh}, {"name", name}});
    b.json["scenes"] = {
        {{"name", "Day"}, {"nodes", {0}}}, {{"nodes", {0, 1}}}, {{"name", "Night"}, {"nodes", {0, 1, 2}}}};
    b.json["scene"] = 1;
    return b;
}

TEST(GltfChoice, AScenesNameOrNumberChooses) {
    const std::string path = threeScenes().write("three.glb");
    const Scene own = loadGltf(path);
    EXPECT_EQ(own.instances.size(), 2u);
    EXPECT_EQ(own.sceneNames, (std::vector<std::string>{"Day", "1", "Night"}));
    EXPECT_EQ(own.sceneNumber, 1);
    EXPECT_TRUE(says(own, "scene '1': is one of 3, and is read: choose another by --scene"));
    for (const auto& [name, number] : {std::pair{"Day", 0}, {"0", 0}, {"1", 1}, {"Night", 2}, {"2", 2}}) {
        const Scene scene = loadGltf(path, {.scene = name});
        EXPECT_EQ(scene.instances.size(), static_cast<size_t>(number) + 1) << name;
        EXPECT_EQ(scene.sceneNumber, number);
        EXPECT_TRUE(scene.warnings.empty());
    }
    EXPECT_NE(refusalOf(path, {.scene = "Dusk"}).find("has no scene 'Dusk': it has 'Day', '1', 'Night'"),
              std::string::npos);
    EXPECT_NE(refusalOf(squareScene().write("no_scene.glb"), {.scene = "Day"}).find("it has none"),
              std::string::npos);
}

TEST(GltfChoice, ANewLightIsSavedIntoTheSceneThatWasRead) {
    const std::string path = threeScenes().write("lit.glb"), saved = test::tempPath("saved.glb");
    const Scene before = loadGltf(path, {.scene = "Night"});
    Scene after = before;
    after.lights.push_back({.name = "Lamp"});
    after.sky.radiance = glm::vec3(2.0f);
    saveEditedGltf(path, partsOfEdits(before), after, saved);
    EXPECT_EQ(loadGltf(saved, {.scene = "Night"}).lights.size(), 1u);
    EXPECT_TRUE(loadGltf(saved, {.scene = "Night"}).sky.shines());
    EXPECT_EQ(loadGltf(saved).lights.size(), 0u);
    EXPECT_FALSE(loadGltf(saved).sky.shines());
}

TEST(GltfChoice, ARootThatIsAlsoAChildIsPlacedOnceBelowItsParent) {
    GlbBuilder b;
    const int mesh = b.mesh(b.square());
    b.node({{"translation", {1, 0, 0}}, {"children", {1}}});
    b.node({{"translation", {2, 0, 0}}, {"children", {2}}});
    b.node({{"translation", {4, 0, 0}}, {"mesh", mesh}, {"name", "Leaf"}});
    for (const json& roots : {json{0, 1, 2}, json{2, 1, 0}, json{0, 2}, json{2}, json{1, 1, 2}}) {
        b.json["scenes"] = {{{"nodes", roots}}};
        const std::string path = b.write("both.glb");
        const Scene scene = loadGltf(path);
        ASSERT_EQ(scene.instances.size(), 1u) << roots;
        EXPECT_EQ(scene.instances[0].transform[3].x, 7.0f) << roots; // by all its ancestors, as glTF says
        EXPECT_TRUE(says(scene, "lists nodes as roots that are children")) << roots;
        Scene after = scene;
        after.instances[0].transform[3].x = 9.0f;
        saveEditedGltf(path, scene, after, test::tempPath("both_moved.glb"));
        EXPECT_EQ(loadGltf(test::tempPath("both_moved.glb")).instances[0].transform[3].x, 9.0f);
    }
}

TEST(GltfChoice, AMissingTrailingByteIsPadding) {
    std::vector<uint8_t> bytes = squareScene().bytes();
    for (int missing = 1; missing <= 3; ++missing) {
        bytes.pop_back();
        const Scene scene = loadGltf(test::writeBytes("short.glb", bytes));
        EXPECT_EQ(scene.instances.size(), 1u);
        EXPECT_TRUE(says(scene, "ends a few bytes too early")) << missing;
    }
    bytes.pop_back();
    EXPECT_NE(refusalOf(test::writeBytes("short.glb", bytes), {}), "");
    // A buffer whose chunk is short, and one whose file is: an exporter that counts its padding.
    GlbBuilder b = squareScene();
    b.bytes();
    b.json["buffers"] = {{{"byteLength", b.bin.size() + 2}}};
    EXPECT_TRUE(says(loadGltf(b.write("claims.glb")), "ends a few bytes too early"));
    b.json["buffers"] = {{{"byteLength", b.bin.size() + 3}, {"uri", "claims.bin"}}};
    test::writeBytes("claims.bin", b.bin);
    EXPECT_TRUE(says(loadGltf(test::writeText("claims.gltf", b.json.dump())), "ends a few bytes too early"));
    b.json["buffers"][0]["byteLength"] = b.bin.size() + 4;
    EXPECT_NE(refusalOf(test::writeText("claims.gltf", b.json.dump()), {}), "");
    // A file that is longer than its buffer is as good as any.
    b.json["buffers"][0]["byteLength"] = b.bin.size();
    b.bin.resize(b.bin.size() + 100);
    test::writeBytes("claims.bin", b.bin);
    EXPECT_TRUE(loadGltf(test::writeText("claims.gltf", b.json.dump())).warnings.empty());
}

TEST(GltfChoice, BuffersOfOneFileHaveSizesOfTheirOwn) {
    const Scene own = loadGltf(squareScene().write("own.glb"));
    GlbBuilder b = squareScene();
    b.bytes();
    test::writeBytes("shared.bin", b.bin);
    const size_t whole = b.bin.size(), positions = b.json["bufferViews"][0]["byteLength"].get<size_t>();
    ASSERT_LT(positions, whole);
    for (const auto& sizes : {std::vector{positions, whole, whole}, {whole, positions, positions + 1}}) {
        b.json["buffers"] = json::array();
        for (const size_t size : sizes)
            b.json["buffers"].push_back({{"byteLength", size}, {"uri", "shared.bin"}});
        const int shortest = sizes[0] == positions ? 0 : 1;
        for (size_t i = 0; i < b.json["bufferViews"].size(); ++i)
            b.json["bufferViews"][i]["buffer"] = i == 0 ? shortest : 1 - shortest;
        const Scene scene = loadGltf(test::writeText("shared.gltf", b.json.dump()));
        EXPECT_TRUE(scene.warnings.empty());
        ASSERT_EQ(scene.instances.size(), 1u);
        const Primitive& read = scene.meshes[0].primitives.at(0);
        EXPECT_EQ(read.positions, own.meshes[0].primitives.at(0).positions);
        EXPECT_EQ(read.texCoord1, own.meshes[0].primitives.at(0).texCoord1);
    }
    // A file that is too short for one of them is still refused.
    b.json["buffers"][2]["byteLength"] = whole + 4;
    EXPECT_NE(refusalOf(test::writeText("shared.gltf", b.json.dump()), {}), "");
}

TEST(GltfChoice, ARequiredExtensionThatNoMeshUsesIsAWarning) {
    GlbBuilder b = squareScene();
    b.json["extensionsUsed"] = b.json["extensionsRequired"] = {"ACME_fog", "KHR_draco_mesh_compression"};
    b.json["materials"] = {{{"extensions", {{"ACME_fog", json::object()}}}}};
    b.json["meshes"][0]["primitives"][0]["material"] = 0;
    const Scene scene = loadGltf(b.write("fog.glb"));
    EXPECT_EQ(scene.instances.size(), 1u);
    EXPECT_TRUE(says(scene, "extension 'ACME_fog': is not supported and ignored"));
}

TEST(GltfChoice, PointsAndLinesAreSkippedAndTold) {
    GlbBuilder b = squareScene();
    json lines = b.json["meshes"][0]["primitives"][0], points = lines;
    lines["mode"] = 1;
    points["mode"] = 0;
    b.json["meshes"][0]["primitives"].push_back(lines);
    b.json["meshes"][0]["primitives"].push_back(points);
    const Scene scene = loadGltf(b.write("lines.glb"));
    EXPECT_EQ(scene.meshes[0].primitives.size(), 1u);
    EXPECT_TRUE(says(scene, "has points or lines, which are skipped"));
}

} // namespace
} // namespace relume
