// Copies that a node makes of its mesh by EXT_mesh_gpu_instancing are moved and hidden in the file.
#include "tests/unit/edited_file.h"

#include <cmath>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

using nlohmann::json;
using test::chunksOf;
using test::expectNear;
using test::GlbBuilder;
using test::jsonOf;

class GltfEditCopies : public test::EditedFile {
protected:
    /// Writes a square on a turned node, which is copied to three places.
    std::string copies(const char* name = "copies.glb", bool scaled = false) const {
        GlbBuilder b;
        const int mesh = b.mesh(b.square(), "Tile");
        json attributes = {{"TRANSLATION", b.accessor<float>({0, 0, 0, 5.1f, 0, 0, 0, 7, 0}, "VEC3")}};
        if (scaled) {
            const int16_t part = 23170; // a quarter turn about z, by normalized integers
            attributes["ROTATION"] =
                b.accessor<int16_t>({0, 0, 0, 32767, 0, 0, part, part, 0, 0, 0, 32767}, "VEC4", true);
            attributes["SCALE"] = b.accessor<float>({1, 1, 1, 2, 3, 1, 1, 1, -1}, "VEC3");
        }
        const float h = std::sqrt(0.5f);
        b.node({{"mesh", mesh},
                {"name", "Floor"},
                {"translation", {0, 0, 10}},
                {"rotation", {h, 0, 0, h}},
                {"scale", {2, 2, 2}},
                {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}});
        b.json["extensionsUsed"] = b.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
        return write(b, name);
    }
    static void expectSame(const Scene& a, const Scene& b, size_t changed) {
        ASSERT_EQ(a.instances.size(), b.instances.size());
        for (size_t i = 0; i < a.instances.size(); ++i) {
            EXPECT_EQ(a.instances[i].name, b.instances[i].name);
            if (i == changed) continue;
            EXPECT_EQ(a.instances[i].transform, b.instances[i].transform) << "to the bit";
        }
    }
};

TEST_F(GltfEditCopies, ACopyMovesAndTheOthersStayToTheBit) {
    const std::string path = copies();
    const Scene before = loadGltf(path);
    const json was = jsonOf(path);
    const std::string chunks = chunksOf(path);
    const glm::mat4 to = glm::translate(glm::mat4(1.0f), {1, 2, 3}) * before.instances[1].transform;
    const EditedNodes nodes = save(path, [&](Scene& s) { s.instances[1].transform = to; });
    EXPECT_EQ(nodes.instances, (std::vector<int>{0, 0, 0}));
    const Scene after = loadGltf(path);
    expectSame(before, after, 1);
    expectNear(after.instances[1].transform, to);
    EXPECT_EQ(chunksOf(path), chunks);
    json is = jsonOf(path);
    const json attributes = is["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    EXPECT_EQ(attributes.size(), 1u) << "no rotation and no scale was needed";
    EXPECT_EQ(is["accessors"].size(), was["accessors"].size() + 1);
    EXPECT_EQ(is["accessors"][0], was["accessors"][0]);
}

TEST_F(GltfEditCopies, ACopyIsTurnedAndScaled) {
    for (const bool scaled : {false, true}) {
        const std::string path = copies("turned.glb", scaled);
        const Scene before = loadGltf(path);
        const glm::mat4 turned = glm::rotate(before.instances[2].transform, 0.5f, {0, 1, 0});
        const glm::mat4 to = glm::scale(turned, glm::vec3(1.5f, 2, 1));
        save(path, [&](Scene& s) { s.instances[2].transform = to; });
        const Scene after = loadGltf(path);
        expectSame(before, after, 2);
        expectNear(after.instances[2].transform, to);
    }
}

TEST_F(GltfEditCopies, ManySavesDoNotLetTheFileGrow) {
    const std::string path = copies();
    glm::mat4 to(1.0f);
    size_t accessors = 0;
    for (int i = 1; i <= 4; ++i) {
        save(path, [&](Scene& s) {
            to = glm::translate(s.instances[0].transform, {float(i), 0, 0});
            s.instances[0].transform = to;
        });
        if (i == 1) accessors = jsonOf(path)["accessors"].size();
    }
    expectNear(loadGltf(path).instances[0].transform, to);
    EXPECT_EQ(jsonOf(path)["accessors"].size(), accessors);
    EXPECT_EQ(jsonOf(path)["buffers"].size(), 2u) << "the chunk and one for the places";
}

TEST_F(GltfEditCopies, NodesThatShareAnAccessorAreMovedApart) {
    GlbBuilder b;
    const int mesh = b.mesh(b.square(), "Tile");
    const int places = b.accessor<float>({0, 0, 0, 5, 0, 0}, "VEC3");
    for (const char* name : {"A", "B"})
        b.node({{"mesh", mesh},
                {"name", name},
                {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}}}});
    const std::string path = write(b);
    for (int i = 0; i < 2; ++i) // as B becomes what A's own accessor is, too
        save(path, [&](Scene& s) { s.instances[0].transform[3].y += 1.0f; });
    const Scene after = loadGltf(path);
    EXPECT_EQ(after.instances[0].transform[3].y, 2.0f);
    EXPECT_EQ(after.instances[2].transform[3].y, 0.0f);
}

TEST_F(GltfEditCopies, ACopyIsHiddenShownAndMovedWhileItIsHidden) {
    const std::string path = copies("hidden.glb", true);
    const Scene before = loadGltf(path);
    save(path, [](Scene& s) { s.instances[1].hidden = true; });
    Scene hidden = loadGltf(path);
    EXPECT_FALSE(hidden.instances[0].hidden);
    EXPECT_TRUE(hidden.instances[1].hidden);
    expectSame(before, hidden, 3);
    EXPECT_FALSE(jsonOf(path).contains("KHR_node_visibility"));
    const glm::mat4 to = glm::translate(glm::mat4(1.0f), {0, 4, 0}) * before.instances[1].transform;
    save(path, [&](Scene& s) { s.instances[1].transform = to; });
    hidden = loadGltf(path);
    EXPECT_TRUE(hidden.instances[1].hidden);
    expectNear(hidden.instances[1].transform, to);
    save(path, [](Scene& s) { s.instances[1].hidden = false; });
    const Scene shown = loadGltf(path);
    EXPECT_FALSE(shown.instances[1].hidden);
    expectNear(shown.instances[1].transform, to);
    EXPECT_FALSE(jsonOf(path)["nodes"][0].contains("extras"));
}

TEST_F(GltfEditCopies, AllCopiesAreHiddenByTheirNode) {
    const std::string path = copies();
    const auto hiddenOf = [&] {
        std::vector<bool> hidden;
        for (const Instance& instance : loadGltf(path).instances)
            hidden.push_back(instance.hidden);
        return hidden;
    };
    const auto hide = [&](const std::vector<bool>& which) {
        save(path, [&](Scene& s) {
            for (size_t i = 0; i < which.size(); ++i)
                s.instances[i].hidden = which[i];
        });
        EXPECT_EQ(hiddenOf(), which);
    };
    const Scene before = loadGltf(path);
    hide({true, true, true});
    EXPECT_TRUE(jsonOf(path)["nodes"][0]["extensions"].contains("KHR_node_visibility"));
    EXPECT_FALSE(jsonOf(path)["nodes"][0].contains("extras"));
    hide({true, false, true});
    EXPECT_FALSE(jsonOf(path)["nodes"][0]["extensions"].contains("KHR_node_visibility"));
    hide({true, true, true});
    hide({false, true, false});
    hide({false, false, false});
    expectSame(before, loadGltf(path), 3);
}

TEST_F(GltfEditCopies, WhatGltfCannotHoldIsTold) {
    GlbBuilder b;
    const int mesh = b.mesh(b.square(), "Tile");
    const int places = b.accessor<float>({0, 0, 0, 5, 0, 0}, "VEC3");
    b.node({{"mesh", mesh},
            {"name", "Floor"},
            {"scale", {1, 3, 1}},
            {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}}}});
    const std::string path = write(b), bytes = test::readAll(path);
    const std::string message = messageOf([&] {
        save(path, [](Scene& s) {
            const glm::mat4 turn = glm::rotate(glm::mat4(1.0f), 0.5f, {0, 0, 1});
            s.instances[0].transform = turn * s.instances[0].transform;
        });
    });
    EXPECT_NE(message.find("object 'Floor #1' gets a shear"), std::string::npos) << message;
    EXPECT_EQ(test::readAll(path), bytes);
}

// A program that knows nothing of the extras may give a hidden copy a size: then it is shown.
TEST_F(GltfEditCopies, ACopyThatHasASizeIsNotHidden) {
    GlbBuilder b;
    const int mesh = b.mesh(b.square(), "Tile");
    const json attributes = {{"SCALE", b.accessor<float>({1, 1, 1, 0, 0, 0}, "VEC3")}};
    const json hidden = {{{"copy", 0}, {"scale", {2, 2, 2}}},
                         {{"copy", 1}, {"scale", {2, 2, 2}}},
                         {{"copy", 9}, {"scale", {2, 2, 2}}},
                         7,
                         {{"copy", 1}, {"scale", "none"}}};
    b.node({{"mesh", mesh},
            {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}},
            {"extras", {{"relume", {{"hiddenCopies", hidden}}}}}});
    const Scene scene = loadGltf(write(b));
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_FALSE(scene.instances[0].hidden);
    EXPECT_EQ(scene.instances[0].transform[0].x, 1.0f);
    EXPECT_TRUE(scene.instances[1].hidden);
    EXPECT_EQ(scene.instances[1].transform[0].x, 2.0f);
}

TEST_F(GltfEditCopies, ASecondFileKeepsTheFirstAsItWas) {
    const std::string path = copies(), bytes = test::readAll(path), other = folder_.path("other.glb");
    const Scene before = loadGltf(path);
    Scene after = before;
    after.instances[0].transform[3].x += 1.0f;
    saveEditedGltf(path, before, after, other);
    EXPECT_EQ(test::readAll(path), bytes);
    EXPECT_EQ(loadGltf(other).instances[0].transform[3].x, 1.0f);
}

} // namespace
} // namespace relume
