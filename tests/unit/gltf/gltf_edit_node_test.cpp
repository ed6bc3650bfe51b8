#include "assets/base/error.h"
#include "assets/gltf/edit/gltf_edit.h"
#include "tests/unit/edited_file.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

namespace relume {
namespace {

using nlohmann::json;
using test::expectNear;
using test::jsonOf;
using test::LitScene;

using GltfEditNode = test::EditedFile;

const json kPoint = {{"type", "point"}, {"name", "Lamp"}, {"color", {1, 1, 1}}, {"intensity", 10}};
const json kTurned = {0.18257418583505536, 0.3651483716701107, 0.5477225575051661, 0.7302967433402214};

const Light& lightOf(const Scene& scene, const std::string& name) {
    for (const Light& light : scene.lights)
        if (light.name == name) return light;
    throw Error("no light " + name + " among " + std::to_string(scene.lights.size()));
}

/// Expects the same pose: only where a light is and where it shines counts.
void expectSamePose(const glm::mat4& a, const glm::mat4& b) {
    for (int r = 0; r < 3; ++r)
        EXPECT_NEAR(a[3][r], b[3][r], 1e-5f);
    const glm::vec3 difference = glm::normalize(glm::vec3(a[2])) - glm::normalize(glm::vec3(b[2]));
    EXPECT_LT(glm::length(difference), 1e-5f);
}

/// Makes lights of every kind of node below every kind of parent.
LitScene parents() {
    LitScene scene;
    const int entry = scene.light(kPoint);
    const std::vector<json> above = {
        json::object(),
        {{"translation", {10, -20, 30}}, {"rotation", kTurned}, {"scale", {2, 2, 2}}},
        {{"rotation", kTurned}, {"scale", {-1, 2, 0.5}}},
        {{"matrix", {0, 2, 0, 0, -3, 0, 0, 0, 0.5, 0, 1, 0, 4, 5, 6, 1}}},
    };
    const std::vector<json> own = {
        json::object(),
        {{"translation", {0.1, 0.2, 0.3}}, {"rotation", kTurned}},
        {{"translation", {0.1, 0.2, 0.3}}, {"scale", {1, -2, -3}}},
        {{"matrix", {0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 0.25, 0.5, 0.75, 1}}},
    };
    for (json parent : above) {
        const int index = scene.node({});
        parent["children"] = json::array();
        for (const json& node : own)
            parent["children"].push_back(scene.lamp(node, entry, false));
        scene.json["nodes"][index] = parent;
        scene.json["scenes"][0]["nodes"].push_back(index);
    }
    return scene;
}

TEST_F(GltfEditNode, LightsMoveBelowAnyParent) {
    const std::string path = write(parents());
    const json original = jsonOf(path);
    const glm::mat4 turn = glm::rotate(glm::mat4(1.0f), 1.1f, glm::vec3(0.3f, 1, -0.2f));
    const std::vector<glm::mat4> moves = {glm::translate(glm::mat4(1.0f), {1, 2, -3}), turn,
                                          glm::translate(turn, {0.5f, 0, 0})};
    for (const glm::mat4& move : moves) {
        const std::string target = folder_.path("moved.glb");
        const Scene before = loadGltf(path);
        Scene after = before;
        for (Light& light : after.lights)
            light.transform = move * light.transform;
        saveEditedGltf(path, before, after, target);
        const Scene back = loadGltf(target);
        ASSERT_EQ(back.lights.size(), 16u);
        for (size_t i = 0; i < 16; ++i) {
            SCOPED_TRACE(i);
            expectSamePose(back.lights[i].transform, after.lights[i].transform);
            const json &was = original["nodes"][after.lights[i].node],
                       node = jsonOf(target)["nodes"][after.lights[i].node];
            EXPECT_EQ(node.contains("matrix"), was.contains("matrix"));
            EXPECT_EQ(node.value("scale", json()), was.value("scale", json()));
        }
        // Parents have no light and stay.
        for (const size_t parent : {1, 6, 11, 16})
            EXPECT_EQ(jsonOf(target)["nodes"][parent], original["nodes"][parent]);
    }
}

TEST_F(GltfEditNode, AMoveTouchesNoOtherNumber) {
    LitScene scene;
    scene.lamp({{"translation", {0.1, 0.30000001192092896, 3}}, {"rotation", kTurned}, {"scale", {2, 2, 2}}},
               scene.light(kPoint));
    const std::string path = write(scene);
    json expected = jsonOf(path);
    save(path, [](Scene& s) { s.lights[0].transform[3].x = 0.7f; });
    expected["nodes"][1]["translation"][0] = 0.7;
    EXPECT_EQ(jsonOf(path), expected);
    save(path, [](Scene& s) { s.lights[0].transform[3].x = 0.1f; });
    expected["nodes"][1]["translation"][0] = 0.1;
    EXPECT_EQ(jsonOf(path), expected);
}

TEST_F(GltfEditNode, BackUnderATurnedParentTheShortNumbersReturn) {
    const std::string path = write(parents());
    const json original = jsonOf(path);
    const Scene first = loadGltf(path);
    save(path, [](Scene& s) {
        for (Light& light : s.lights)
            light.transform[3] += glm::vec4(0.37f, -1.21f, 5.5f, 0);
    });
    EXPECT_NE(jsonOf(path), original);
    save(path, [&](Scene& s) {
        for (size_t i = 0; i < s.lights.size(); ++i)
            s.lights[i].transform = first.lights[i].transform;
    });
    const Scene back = loadGltf(path);
    for (size_t i = 0; i < back.lights.size(); ++i)
        expectNear(back.lights[i].transform, first.lights[i].transform, 2e-6f);
    EXPECT_EQ(jsonOf(path)["nodes"][2].value("translation", json({0, 0, 0})), json({0, 0, 0}));
}

TEST_F(GltfEditNode, AParentOfScaleZeroIsAnError) {
    LitScene scene;
    const int lamp = scene.lamp(json::object(), scene.light(kPoint), false);
    const int parent = scene.node({{"scale", {1, 0, 1}}, {"children", {lamp}}});
    scene.json["nodes"][parent]["children"] = json::array({lamp});
    scene.json["scenes"][0]["nodes"].push_back(parent);
    const std::string path = write(scene);
    const std::string message =
        messageOf([&] { save(path, [](Scene& s) { s.lights[0].transform[3].x = 1; }); });
    EXPECT_EQ(message, path +
                           ": 'Lamp' cannot be moved, as a node above it has a scale of 0: give that node a "
                           "scale or take it out of there");
}

TEST_F(GltfEditNode, ALightLeavesANodeThatCarriesMore) {
    LitScene scene;
    const int entry = scene.light(kPoint);
    json& nodes = scene.json["nodes"];
    nodes[0]["extensions"]["KHR_lights_punctual"] = {{"light", entry}, {"extras", 5}};
    nodes[0]["translation"] = {1, 0, 0};
    nodes[0]["scale"] = {2, 2, 2};
    const std::string path = write(scene);
    const json original = jsonOf(path);
    const Scene before = loadGltf(path);
    const EditedNodes moved = save(path, [](Scene& s) { s.lights[0].transform[3] = {5, 6, 7, 1}; });
    const Scene after = loadGltf(path);
    expectNear(after.instances[0].transform, before.instances[0].transform);
    EXPECT_EQ(glm::vec3(after.lights[0].transform[3]), glm::vec3(5, 6, 7));
    EXPECT_EQ(moved.lights, std::vector<int>{1});
    EXPECT_EQ(after.lights[0].node, 1);
    const json child = jsonOf(path)["nodes"][1];
    EXPECT_EQ(child["extensions"]["KHR_lights_punctual"], json({{"light", 0}, {"extras", 5}}));
    EXPECT_EQ(child["translation"], json({2, 3, 3.5}));
    EXPECT_FALSE(jsonOf(path)["nodes"][0].contains("extensions"));
    EXPECT_EQ(jsonOf(path)["nodes"][0]["children"], json::array({1}));

    save(path, [](Scene& s) { s.lights[0].transform[3] = {9, 6, 7, 1}; });
    EXPECT_EQ(jsonOf(path)["nodes"].size(), 2u); // its node is its own now
}

TEST_F(GltfEditNode, ALightThatMovesWithItsObjectStaysInItsNode) {
    LitScene scene;
    scene.json["nodes"][0]["extensions"]["KHR_lights_punctual"] = {{"light", scene.light(kPoint)}};
    scene.json["nodes"][0]["scale"] = {2, 2, 2};
    const std::string path = write(scene);
    const glm::mat4 move = glm::rotate(glm::translate(glm::mat4(1.0f), {1, 2, 3}), 0.7f, glm::vec3(1, 1, 0));
    const Scene before = loadGltf(path);
    save(path, [&](Scene& s) {
        s.instances[0].transform = move * s.instances[0].transform;
        // A light's transform may come without scale.
        s.lights[0].transform = move;
    });
    const json file = jsonOf(path);
    EXPECT_EQ(file["nodes"].size(), 1u);
    EXPECT_EQ(file["nodes"][0]["scale"], json({2, 2, 2}));
    expectNear(loadGltf(path).instances[0].transform, move * before.instances[0].transform);
}

TEST_F(GltfEditNode, AnObjectMovesWithoutItsChildren) {
    LitScene scene;
    json& nodes = scene.json["nodes"];
    const int mesh = nodes[0]["mesh"];
    scene.node({{"name", "Child"}, {"mesh", mesh}, {"translation", {1, 2, 3}}});
    nodes[0]["children"] = json::array({1});
    nodes[0]["weights"] = json::array({0.5});
    scene.json["animations"] = json::array(
        {{{"samplers", json::array()},
          {"channels", json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}},
                                    {{"sampler", 0}, {"target", {{"node", 0}, {"path", "scale"}}}}})}}});
    const std::string path = write(scene);
    const Scene before = loadGltf(path);
    const glm::mat4 to =
        glm::scale(glm::rotate(glm::translate(glm::mat4(1), {4, 5, 6}), 0.5f, {0, 1, 0}), {1, 3, 2});
    const EditedNodes moved = save(path, [&](Scene& s) { s.instances[0].transform = to; });
    EXPECT_EQ(moved.instances, (std::vector<int>{2, 1}));
    const Scene after = loadGltf(path);
    expectNear(after.instances[0].transform, to);
    EXPECT_EQ(after.instances[0].node, 2);
    expectNear(after.instances[1].transform, before.instances[1].transform);
    const json file = jsonOf(path);
    EXPECT_EQ(file["nodes"][0]["children"], json::array({2, 1}));
    EXPECT_EQ(file["nodes"][2]["weights"], json::array({0.5}));
    EXPECT_FALSE(file["nodes"][0].contains("mesh"));
    EXPECT_EQ(file["animations"][0]["channels"][0]["target"]["node"], 2);
    EXPECT_EQ(file["animations"][0]["channels"][1]["target"]["node"], 0);
}

TEST_F(GltfEditNode, ObjectsMoveInTheFormTheyHave) {
    LitScene scene;
    const int mesh = scene.json["nodes"][0]["mesh"];
    scene.json["scenes"][0]["nodes"] = {0, 1, 2};
    scene.node({{"mesh", mesh}, {"rotation", kTurned}, {"scale", {2, -3, 0.5}}});
    scene.node({{"mesh", mesh}, {"matrix", {0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 0.25, 0.5, 0.75, 1}}});
    const std::string path = write(scene);
    const Scene before = loadGltf(path);
    const glm::mat4 move = glm::rotate(glm::translate(glm::mat4(1), {1, 2, 3}), 0.4f, glm::vec3(1, 1, 0));
    save(path, [&](Scene& s) {
        for (Instance& instance : s.instances)
            instance.transform = move * instance.transform;
    });
    const Scene after = loadGltf(path);
    for (size_t i = 0; i < 3; ++i)
        expectNear(after.instances[i].transform, move * before.instances[i].transform);
    const json nodes = jsonOf(path)["nodes"];
    EXPECT_FALSE(nodes[0].contains("scale"));
    EXPECT_EQ(nodes[1]["scale"], json({2, -3, 0.5}));
    EXPECT_TRUE(nodes[2].contains("matrix"));
    EXPECT_FALSE(nodes[2].contains("rotation"));

    glm::mat4 shear(1.0f);
    shear[1][0] = 0.5f;
    save(path, [&](Scene& s) { s.instances[0].transform = shear; });
    expectNear(loadGltf(path).instances[0].transform, shear);
    EXPECT_TRUE(jsonOf(path)["nodes"][0].contains("matrix"));
    EXPECT_FALSE(jsonOf(path)["nodes"][0].contains("rotation"));
}

TEST_F(GltfEditNode, LightsAreAddedToAFileWithoutAny) {
    LitScene scene;
    scene.json["scenes"] = json::array({json::object(), {{"nodes", json::array({0})}}});
    scene.json["scene"] = 1;
    const std::string path = write(scene);
    Light spot, sun, panel, disc;
    spot.name = "Spot";
    spot.type = LightType::Spot;
    spot.transform = glm::rotate(glm::translate(glm::mat4(1), {0.1f, 2.5f, -0.7f}), 0.8f, glm::vec3(1, 0, 1));
    spot.color = {1, 0.9f, 0.7f};
    spot.intensity = 1234.567f;
    spot.range = 12;
    spot.innerConeAngle = spot.outerConeAngle = 1.57079637f;
    spot.radius = 0.05f;
    sun.name = "Sun";
    sun.type = LightType::Directional;
    sun.angle = 0.00925f;
    panel.name = "Panel";
    panel.type = LightType::Rectangle;
    panel.size = {0.6f, 1.2f};
    panel.intensity = 3000;
    disc.name = "Disc";
    disc.type = LightType::Disc;
    disc.radius = 0.3f;
    const EditedNodes added = save(path, [&](Scene& s) { s.lights = {spot, panel, sun, disc}; });
    EXPECT_EQ(added.lights, (std::vector<int>{1, 2, 3, 4}));
    const json file = jsonOf(path);
    EXPECT_EQ(file["extensionsUsed"], json({"KHR_lights_punctual", "EXT_lights_area"}));
    EXPECT_EQ(file["scenes"][1]["nodes"], json({0, 1, 2, 3, 4}));
    EXPECT_FALSE(file["scenes"][0].contains("nodes"));
    const json lights = file["extensions"]["KHR_lights_punctual"]["lights"];
    EXPECT_EQ(lights[0]["extras"], json({{"relume", {{"radius", 0.05}}}}));
    EXPECT_EQ(lights[1]["extras"], json({{"relume", {{"angle", 0.00925}}}}));
    EXPECT_FALSE(lights[1].contains("range"));
    EXPECT_LE(lights[0]["spot"]["outerConeAngle"].get<double>(), 1.5707963267948966);
    EXPECT_LT(lights[0]["spot"]["innerConeAngle"].get<double>(),
              lights[0]["spot"]["outerConeAngle"].get<double>());
    EXPECT_EQ(file["nodes"][2]["extras"]["relume"]["areaLight"], json({{"name", "Panel"},
                                                                       {"type", "rectangle"},
                                                                       {"color", {1, 1, 1}},
                                                                       {"intensity", 3000},
                                                                       {"size", {0.6, 1.2}}}));
    EXPECT_EQ(
        file["nodes"][4]["extras"]["relume"]["areaLight"],
        json({{"name", "Disc"}, {"type", "disc"}, {"color", {1, 1, 1}}, {"intensity", 1}, {"radius", 0.3}}));
    const Scene back = loadGltf(path);
    const Light& read = lightOf(back, "Spot");
    expectSamePose(read.transform, spot.transform);
    EXPECT_EQ(read.transform[3], spot.transform[3]);
    EXPECT_EQ(read.color, spot.color);
    EXPECT_EQ(read.intensity, spot.intensity);
    EXPECT_EQ(read.range, spot.range);
    EXPECT_EQ(read.outerConeAngle, spot.outerConeAngle);
    EXPECT_EQ(lightOf(back, "Sun").type, LightType::Directional);
}

TEST_F(GltfEditNode, AreaLightsAreEditedInTheirNode) {
    const std::string path = write(LitScene());
    const Scene first = loadGltf(path);
    Scene now = first;
    now.lights.resize(1);
    now.lights[0].name = "Panel";
    now.lights[0].type = LightType::Rectangle;
    now.lights[0].node = saveEditedGltf(path, first, now, path).lights[0];
    const json added = jsonOf(path);
    json expected = added;
    Scene edited = now;
    edited.lights[0].color = {1, 0.2f, 1};
    edited.lights[0].size.y = 0.3f;
    edited.lights[0].transform = glm::translate(glm::mat4(1.0f), {0, 2.2f, 0});
    saveEditedGltf(path, now, edited, path);
    json& area = expected["nodes"][1]["extras"]["relume"]["areaLight"];
    area["color"][1] = 0.2;
    area["size"][1] = 0.3;
    json& entry = expected["extensions"]["EXT_lights_area"]["lights"][0];
    entry["color"][1] = 0.2;
    entry["size"] = 0.3;
    entry["rect"]["aspect"] = 3.3333333;
    expected["nodes"][1]["translation"] = {0, 2.2, 0};
    EXPECT_EQ(jsonOf(path), expected);

    Scene disc = edited;
    disc.lights[0].type = LightType::Disc;
    disc.lights[0].radius = 0.5f;
    saveEditedGltf(path, edited, disc, path);
    area["type"] = "disc";
    area["radius"] = 0.5;
    area.erase("size");
    entry["type"] = "disk";
    entry["size"] = 1;
    entry.erase("rect");
    EXPECT_EQ(jsonOf(path), expected);

    Scene point = disc;
    point.lights[0].type = LightType::Point;
    EXPECT_EQ(saveEditedGltf(path, disc, point, path).lights[0], 1);
    EXPECT_FALSE(jsonOf(path)["nodes"][1].contains("extras"));
    EXPECT_EQ(loadGltf(path).lights[0].type, LightType::Point);
    EXPECT_EQ(loadGltf(path).lights[0].transform[3].y, 2.2f);
}

/// Makes three lights on three entries.
LitScene three() {
    LitScene scene;
    for (const char* name : {"A", "B", "C"}) {
        json light = kPoint;
        light["name"] = name;
        scene.lamp({{"extras", {{"id", name}}}}, scene.light(light));
    }
    return scene;
}

TEST_F(GltfEditNode, ADeletedLightsNodeStaysAndLaterEntriesAreRenumbered) {
    const std::string path = write(three());
    save(path, [](Scene& s) { s.lights.erase(s.lights.begin()); });
    const json file = jsonOf(path);
    ASSERT_EQ(file["nodes"].size(), 4u);
    EXPECT_EQ(file["nodes"][1], json::object({{"extras", {{"id", "A"}}}}));
    EXPECT_EQ(file["extensions"]["KHR_lights_punctual"]["lights"].size(), 2u);
    const Scene back = loadGltf(path);
    ASSERT_EQ(back.lights.size(), 2u);
    EXPECT_EQ(back.lights[0].name, "B");
    EXPECT_EQ(back.lights[1].name, "C");
    save(path, [](Scene& s) { s.lights.clear(); });
    EXPECT_FALSE(jsonOf(path).contains("extensions"));
    EXPECT_FALSE(jsonOf(path).contains("extensionsUsed"));
    EXPECT_EQ(jsonOf(path)["nodes"].size(), 4u);
}

TEST_F(GltfEditNode, AnEntryStaysWhileItIsUsedOrMayBePointedAt) {
    LitScene shared = three();
    shared.json["nodes"].push_back(shared.json["nodes"][2]); // of no scene
    std::string path = write(shared);
    save(path, [](Scene& s) { s.lights.erase(s.lights.begin() + 1); });
    EXPECT_EQ(jsonOf(path)["extensions"], shared.json["extensions"]);
    EXPECT_EQ(loadGltf(path).lights[1].name, "C");

    LitScene pointed = three();
    pointed.json["extensionsUsed"].push_back("KHR_animation_pointer");
    path = write(pointed);
    save(path, [](Scene& s) { s.lights.erase(s.lights.begin()); });
    EXPECT_EQ(jsonOf(path)["extensions"], pointed.json["extensions"]);
    EXPECT_EQ(loadGltf(path).lights[1].name, "C");
}

TEST_F(GltfEditNode, ADeletedLightReturnsToItsNode) {
    const std::string path = write(three());
    const json original = jsonOf(path);
    const Light last = loadGltf(path).lights[2];
    save(path, [](Scene& s) { s.lights.pop_back(); });
    const EditedNodes nodes = save(path, [&](Scene& s) { s.lights.push_back(last); });
    EXPECT_EQ(nodes.lights.back(), 3);
    EXPECT_EQ(jsonOf(path), original);
}

TEST_F(GltfEditNode, ANodeThatSomethingNamesIsNotDropped) {
    LitScene scene = three();
    scene.json["nodes"][3].erase("extras");
    const json target = {{"node", 3}, {"path", "translation"}};
    scene.json["animations"] = json::array(
        {{{"channels", json::array({{{"sampler", 0}, {"target", target}}})}, {"samplers", json::array()}}});
    std::string path = write(scene);
    save(path, [](Scene& s) { s.lights.pop_back(); });
    EXPECT_EQ(jsonOf(path)["nodes"].size(), 4u);
    scene.json.erase("animations");
    path = write(scene);
    save(path, [](Scene& s) { s.lights.pop_back(); });
    EXPECT_EQ(jsonOf(path)["nodes"].size(), 3u);
    EXPECT_EQ(jsonOf(path)["scenes"][0]["nodes"], json({0, 1, 2}));
}

TEST_F(GltfEditNode, ALightBecomesAnotherKind) {
    const std::string path = write(three());
    save(path, [](Scene& s) {
        s.lights[0].type = LightType::Spot;
        s.lights[0].radius = 0.1f;
        s.lights[1].type = LightType::Rectangle;
    });
    save(path, [](Scene& s) {
        s.lights[0].type = LightType::Directional;
        s.lights[0].radius = 0.0f;
        s.lights[0].angle = 0.01f;
    });
    const json file = jsonOf(path);
    const json entry = file["extensions"]["KHR_lights_punctual"]["lights"][0];
    EXPECT_EQ(entry["type"], "directional");
    EXPECT_FALSE(entry.contains("spot"));
    EXPECT_EQ(entry["extras"]["relume"], json::object({{"angle", 0.01}}));
    EXPECT_EQ(file["nodes"][2]["extensions"], json({{"EXT_lights_area", {{"light", 0}}}}));
}

TEST_F(GltfEditNode, ExtrasThatAreNoObjectAreNamed) {
    LitScene scene = three();
    scene.json["nodes"][2]["extras"] = "text";
    const std::string path = write(scene);
    const std::string message =
        messageOf([&] { save(path, [](Scene& s) { s.lights[1].type = LightType::Disc; }); });
    EXPECT_EQ(
        message,
        path + ": nodes[2].extras is no object, so that nothing can be kept in it: remove it from the file");
}

} // namespace
} // namespace relume
