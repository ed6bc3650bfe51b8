#include "assets/gltf/gltf.h"

#include "assets/base/error.h"
#include "tests/unit/glb_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

namespace relume {
namespace {

using nlohmann::json;
using test::GlbBuilder;

const std::vector<float> kPlaces = {0, 0, 0, 5, 0, 0, 0, 7, 0};

/// Makes a square on a node that stands at (0, 0, 10) and places it by these attributes.
GlbBuilder instancedScene(const std::function<json(GlbBuilder&)>& attributes) {
    GlbBuilder b;
    json square = b.square();
    square["attributes"]["TEXCOORD_1"] = b.squareUvs();
    const int mesh = b.mesh(square, "Tile");
    const json use = attributes(b);
    b.node({{"mesh", mesh},
            {"name", "Floor"},
            {"translation", {0, 0, 10}},
            {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", use}}}}}});
    b.json["extensionsUsed"] = b.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    return b;
}

void expectAt(const Instance& instance, const glm::vec3& point, const glm::vec3& wanted) {
    const glm::vec3 at(instance.transform * glm::vec4(point, 1.0f));
    for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(at[i], wanted[i], 1e-4f) << instance.name;
}

bool tells(const Scene& scene, const std::string& part) {
    return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                       [&](const std::string& w) { return w.find(part) != std::string::npos; });
}

TEST(GltfInstancing, EachCopyIsAnObjectWithANameOfItsOwn) {
    const float h = std::sqrt(0.5f);
    const Scene scene =
        loadGltf(instancedScene([&](GlbBuilder& b) -> json {
                     return {{"TRANSLATION", b.accessor<float>(kPlaces, "VEC3")},
                             {"ROTATION", b.accessor<float>({0, 0, 0, 1, 0, 0, h, h, 0, 0, 0, 1}, "VEC4")},
                             {"SCALE", b.accessor<float>({1, 1, 1, 2, 3, 1, 1, 1, 1}, "VEC3")},
                             {"_ID", b.accessor<float>({1, 2, 3}, "SCALAR")}};
                 }).write("copies.glb"));
    ASSERT_EQ(scene.instances.size(), 3u);
    std::set<std::string> names;
    for (const Instance& instance : scene.instances) {
        names.insert(instance.name);
        EXPECT_EQ(instance.mesh, 0);
        EXPECT_EQ(instance.node, 0);
    }
    EXPECT_EQ(names, (std::set<std::string>{"Floor #1", "Floor #2", "Floor #3"}));
    expectAt(scene.instances[0], {1, 1, 0}, {1, 1, 10});
    expectAt(scene.instances[1], {1, 0, 0}, {5, 2, 10}); // a quarter turn about z takes x to y
    expectAt(scene.instances[1], {0, 1, 0}, {2, 0, 10});
    expectAt(scene.instances[2], {0, 0, 0}, {0, 7, 10});
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(GltfInstancing, NormalizedRotationsAreRead) {
    const int8_t full = 127, half = 90;
    const int16_t fine = 23170;
    const auto load = [](const std::function<json(GlbBuilder&)>& attributes) {
        return loadGltf(instancedScene(attributes).write("normalized.glb"));
    };
    const Scene bytes = load([&](GlbBuilder& b) -> json {
        return {{"ROTATION", b.accessor<int8_t>({0, 0, 0, full, 0, 0, half, half}, "VEC4", true)}};
    });
    ASSERT_EQ(bytes.instances.size(), 2u);
    expectAt(bytes.instances[1], {1, 0, 0}, {0, 1, 10});
    const Scene shorts = load([&](GlbBuilder& b) -> json {
        return {{"ROTATION", b.accessor<int16_t>({fine, 0, 0, fine}, "VEC4", true)}};
    });
    ASSERT_EQ(shorts.instances.size(), 1u);
    expectAt(shorts.instances[0], {0, 1, 0}, {0, 0, 11});
}

TEST(GltfInstancing, WhatDoesNotFitIsToldAndLeftOut) {
    const Scene fewer = loadGltf(instancedScene([](GlbBuilder& b) -> json {
                                     return {{"TRANSLATION", b.accessor<float>(kPlaces, "VEC3")},
                                             {"SCALE", b.accessor<float>({2, 2, 2}, "VEC3")}};
                                 }).write("fewer.glb"));
    EXPECT_EQ(fewer.instances.size(), 1u);
    EXPECT_TRUE(tells(fewer, "has 1 instances with all they need, and 2 without"));
    const Scene none =
        loadGltf(instancedScene([](GlbBuilder&) { return json::object(); }).write("no_copies.glb"));
    ASSERT_EQ(none.instances.size(), 1u);
    EXPECT_EQ(none.instances[0].name, "Floor");
    const Scene flat = loadGltf(instancedScene([](GlbBuilder& b) -> json {
                                    return {{"TRANSLATION", b.accessor<float>({1, 2, 3, 4}, "VEC2")}};
                                }).write("flat.glb"));
    EXPECT_TRUE(tells(flat, "TRANSLATION with a wrong number of components"));
    GlbBuilder far = instancedScene([](GlbBuilder& b) -> json {
        return {{"TRANSLATION", b.accessor<float>({NAN, 0, 0, 1, 0, 0}, "VEC3")}};
    });
    const Scene finite = loadGltf(far.write("nan.glb"));
    ASSERT_EQ(finite.instances.size(), 1u);
    EXPECT_EQ(finite.instances[0].name, "Floor #2");
}

TEST(GltfInstancing, MoreCopiesThanAFileMayHaveAreRefused) {
    GlbBuilder b = instancedScene([](GlbBuilder& builder) -> json {
        builder.json["accessors"].push_back({{"componentType", 5126}, {"count", 1 << 25}, {"type", "VEC3"}});
        return {{"TRANSLATION", builder.json["accessors"].size() - 1}};
    });
    try {
        loadGltf(b.write("many.glb"));
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("of names out of"), std::string::npos) << error.what();
    }
}

// The tool quantizes the mesh, and places the copies of the quantized mesh.
TEST(GltfInstancing, AToolsCompressedFileHasThePlainOnesObjects) {
    const std::string folder = std::string(RELUME_SOURCE_DIR) + "/tests/data/";
    const Scene plain = loadGltf(folder + "plain.glb"), packed = loadGltf(folder + "instanced_meshopt.glb");
    ASSERT_EQ(packed.instances.size(), 5u);
    for (size_t k = 0; k < 5; ++k) {
        glm::vec3 wanted(0.0f), middle(0.0f);
        for (const glm::vec3& p : plain.meshes[0].primitives[0].positions)
            wanted += glm::vec3(plain.instances[k].transform * glm::vec4(p, 1.0f)) / 49.0f;
        for (const glm::vec3& p : packed.meshes[0].primitives[0].positions)
            middle += glm::vec3(packed.instances[k].transform * glm::vec4(p, 1.0f)) / 49.0f;
        EXPECT_LT(glm::distance(middle, wanted), 3e-4f);
    }
}

} // namespace
} // namespace relume
