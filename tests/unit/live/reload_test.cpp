// These files are written anew while they are open: what that changes, and what becomes of edits.
#include "app/live/reload.h"

#include "assets/base/error.h"
#include "tests/text.h"
#include "tests/ui/glb_json.h"
#include "tests/unit/session_fixture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

namespace relume {
namespace {

/// Makes a level of two objects of one mesh, two materials and two lights.
PreparedScene twoOfEach() {
    PreparedScene out;
    Scene& scene = out.scene;
    for (const char* name : {"Red", "Blue"}) {
        scene.materials.emplace_back().name = name;
        scene.lights.emplace_back().name = std::string(name) + " lamp";
        scene.lights.back().node = static_cast<int>(scene.lights.size());
        scene.instances.push_back({.name = std::string(name) + " box", .mesh = 0});
    }
    Primitive triangle;
    triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    triangle.indices = {0, 1, 2};
    scene.meshes.push_back({.name = "Box", .primitives = {triangle}});
    out.atlas.instances.resize(2);
    out.size = 64;
    return out;
}

SceneChanges changesOf(const PreparedScene& after) {
    const PreparedScene before = twoOfEach();
    return changesBetween(before.scene, before, after);
}

/// Gives the first material a texture.
void paint(PreparedScene& prepared, TextureRef Material::*use) {
    Scene& scene = prepared.scene;
    scene.images.push_back({.name = "Picture", .width = 1, .height = 1, .rgba = {9, 9, 9, 255}});
    scene.textures.push_back({.image = static_cast<int>(scene.images.size()) - 1});
    (scene.materials[0].*use).texture = static_cast<int>(scene.textures.size()) - 1;
}

TEST(SceneChanges, NothingIsNothing) {
    const SceneChanges none = changesOf(twoOfEach());
    EXPECT_FALSE(none.any());
    EXPECT_EQ(describe(none), "nothing");
}

TEST(SceneChanges, WhatABakeFollowsIsCounted) {
    PreparedScene after = twoOfEach();
    after.scene.lights[0].transform[3].x += 1.0f;
    after.scene.lights[0].node = 9; // in the file, which says nothing
    after.scene.lights.emplace_back().name = "New lamp";
    after.scene.instances[1].transform[3].y += 1.0f;
    after.scene.instances[0].hidden = true;
    after.scene.materials[0].baseColor.r = 0.5f;
    after.scene.sky.radiance = glm::vec3(1.0f);
    const SceneChanges changes = changesOf(after);
    EXPECT_FALSE(changes.surfaces);
    EXPECT_EQ(describe(changes), "2 lights, the sky, 2 objects, 1 material");
}

TEST(SceneChanges, WhatSharesANameIsCountedByWhatItIs) {
    PreparedScene before = twoOfEach();
    Scene& scene = before.scene;
    for (int i = 0; i < 5; ++i) {
        scene.instances.push_back({.name = "Chair", .mesh = 0});
        scene.instances.back().transform[3].x = static_cast<float>(i);
        scene.meshes.push_back({.name = "", .primitives = scene.meshes[0].primitives});
        scene.meshes.back().primitives[0].positions[1].x = 2.0f + static_cast<float>(i);
    }
    PreparedScene after = before;
    after.scene.instances.erase(after.scene.instances.begin() + 3); // a chair
    after.scene.meshes.erase(after.scene.meshes.begin() + 2);
    EXPECT_EQ(describe(changesBetween(scene, before, after)), "1 object, 1 mesh");
    after.scene.instances[4].transform[3].y = 1.0f; // another chair
    after.scene.meshes.back().primitives[0].positions[1].y = 1.0f;
    EXPECT_EQ(describe(changesBetween(scene, before, after)), "2 objects, 2 meshes");
    EXPECT_EQ(describe(changesBetween(after.scene, after, before)), "2 objects, 2 meshes");
}

TEST(SceneChanges, AMaterialThatComesFirstChangesNoMesh) {
    PreparedScene before = twoOfEach();
    before.scene.meshes[0].primitives[0].material = 1;
    PreparedScene after = before;
    after.scene.materials.insert(after.scene.materials.begin(), Material{})->name = "New";
    after.scene.meshes[0].primitives[0].material = 2;
    EXPECT_EQ(describe(changesBetween(before.scene, before, after)), "1 material");
    after.scene.meshes[0].primitives[0].material = 0;
    EXPECT_EQ(describe(changesBetween(before.scene, before, after)), "1 material, 1 mesh");
}

TEST(SceneChanges, WhatPatchesAreMadeWithIsMore) {
    using Change = void (*)(PreparedScene&);
    for (const Change change : {+[](PreparedScene& p) { p.scene.meshes[0].primitives[0].positions[1].x = 2; },
                                +[](PreparedScene& p) { p.scene.meshes[0].primitives[0].material = 1; },
                                +[](PreparedScene& p) { p.scene.materials[0].doubleSided = true; },
                                +[](PreparedScene& p) { p.scene.materials[0].alphaMode = AlphaMode::Mask; },
                                +[](PreparedScene& p) { paint(p, &Material::emissionTexture); },
                                +[](PreparedScene& p) { p.scene.instances.pop_back(); },
                                +[](PreparedScene& p) { p.scene.sky.pixels.emplace_back(1.0f); },
                                +[](PreparedScene& p) { p.atlas.instances[1].offset.x = 0.5f; },
                                +[](PreparedScene& p) { p.size = 128; }}) {
        PreparedScene after = twoOfEach();
        change(after);
        EXPECT_TRUE(changesOf(after).surfaces);
    }
}

TEST(SceneChanges, WhatIsPaintedOnSurfacesLeavesThePatches) {
    using Change = void (*)(PreparedScene&);
    for (const Change change : {+[](PreparedScene& p) { p.scene.materials[0].roughness = 0.5f; },
                                +[](PreparedScene& p) { p.scene.materials[1].metallic = 0.5f; },
                                +[](PreparedScene& p) { p.scene.images.emplace_back(); },
                                +[](PreparedScene& p) { paint(p, &Material::baseColorTexture); },
                                +[](PreparedScene& p) { paint(p, &Material::metallicRoughnessTexture); }}) {
        PreparedScene after = twoOfEach();
        change(after);
        const SceneChanges changes = changesOf(after);
        EXPECT_FALSE(changes.surfaces);
        EXPECT_TRUE(changes.paint);
        EXPECT_TRUE(changes.any());
    }
}

TEST(SceneChanges, APictureThatIsCutOutMakesOtherPatches) {
    PreparedScene before = twoOfEach();
    before.scene.materials[0].alphaMode = AlphaMode::Mask;
    PreparedScene after = before;
    paint(after, &Material::baseColorTexture);
    EXPECT_TRUE(changesBetween(before.scene, before, after).surfaces);
}

/// Holds what a file had, what it has now, and what the user made of it meanwhile.
struct ThreeWays {
    Scene before = twoOfEach().scene, after = before;
    SceneEdits own = editsOf(before);

    CarriedEdits carried() const { return carryEdits(before, own, after); }
};

TEST(CarriedEdits, WhereOnlyOneSideEditedBothStand) {
    ThreeWays all;
    all.own.lights[0].intensity = 5.0f;
    all.own.materials[1].baseColor.r = 0.25f;
    all.own.placements[0].transform[3].x = 3.0f;
    all.own.sky.radiance = glm::vec3(2.0f);
    all.after.lights[1].intensity = 7.0f;
    all.after.materials[1].emission = glm::vec3(4.0f);
    all.after.instances[1].hidden = true;
    const CarriedEdits out = all.carried();
    EXPECT_TRUE(out.conflicts.empty());
    EXPECT_EQ(out.edits.lights[0].intensity, 5.0f);
    EXPECT_EQ(out.edits.lights[1].intensity, 7.0f);
    EXPECT_EQ(out.edits.materials[1].baseColor.r, 0.25f);
    EXPECT_EQ(out.edits.materials[1].emission, glm::vec3(4.0f));
    EXPECT_EQ(out.edits.placements[0].transform[3].x, 3.0f);
    EXPECT_TRUE(out.edits.placements[1].hidden);
    EXPECT_EQ(out.edits.sky.radiance, glm::vec3(2.0f));
    EXPECT_TRUE(out.sameNumbers);
    EXPECT_FALSE(out.sameFile);
}

TEST(CarriedEdits, WhereBothSidesEditedTheUsersStaysAndIsTold) {
    ThreeWays all;
    all.own.lights[0].intensity = 5.0f;
    all.after.lights[0].intensity = 7.0f;
    all.after.lights[0].node = 12;
    all.own.placements[1].hidden = true;
    all.after.instances[1].transform[3].x = 1.0f;
    const CarriedEdits out = all.carried();
    EXPECT_EQ(out.edits.lights[0].intensity, 5.0f);
    EXPECT_EQ(out.edits.lights[0].node, 12) << "where a save finds it";
    EXPECT_TRUE(out.edits.placements[1].hidden);
    ASSERT_EQ(out.conflicts.size(), 2u);
    EXPECT_TRUE(contains(out.conflicts[0], "Blue box"));
    EXPECT_TRUE(contains(out.conflicts[1], "Red lamp"));
    // The same edit on both sides is none.
    all.after.lights[0].intensity = 5.0f;
    all.after.instances[1] = all.before.instances[1];
    EXPECT_TRUE(all.carried().conflicts.empty());
}

TEST(CarriedEdits, LightsThatCameAndWentOnEitherSide) {
    ThreeWays all;
    all.own.lights.erase(all.own.lights.begin()); // the red one
    Light& added = all.own.lights.emplace_back();
    added.name = "Mine";
    added.node = -2;
    all.after.lights.insert(all.after.lights.begin(), Light{.name = "Theirs", .node = 30});
    CarriedEdits out = all.carried();
    ASSERT_EQ(out.edits.lights.size(), 3u);
    EXPECT_EQ(out.edits.lights[0].name, "Theirs");
    EXPECT_EQ(out.edits.lights[1].name, "Blue lamp");
    EXPECT_EQ(out.edits.lights[2].name, "Mine");
    EXPECT_FALSE(out.sameNumbers);
    EXPECT_TRUE(out.conflicts.empty());
    all.after.lights[1].intensity = 9.0f; // of the red one, which the user deleted
    all.own.lights[0].intensity = 3.0f;   // of the blue one, which the file has no more
    all.after.lights.pop_back();
    out = all.carried();
    ASSERT_EQ(out.edits.lights.size(), 2u);
    EXPECT_EQ(out.edits.lights[0].name, "Theirs");
    EXPECT_EQ(out.edits.lights[1].name, "Mine");
    ASSERT_EQ(out.conflicts.size(), 2u);
    EXPECT_TRUE(contains(out.conflicts[0], "Red lamp: was deleted here"));
    EXPECT_TRUE(contains(out.conflicts[1], "Blue lamp: was edited here and deleted"));
}

/// Makes a file that has lost its lights, so that preview light stands in for them.
ThreeWays lostItsLights() {
    ThreeWays all;
    all.after.lights = {Light{.name = "Preview sun", .preview = true}};
    all.after.sky.radiance = glm::vec3(4000.0f);
    all.after.sky.preview = true;
    return all;
}

TEST(CarriedEdits, AFileThatLostItsLastLightGetsPreviewLight) {
    const CarriedEdits out = lostItsLights().carried();
    ASSERT_EQ(out.edits.lights.size(), 1u);
    EXPECT_TRUE(out.edits.lights[0].preview);
    EXPECT_TRUE(out.edits.sky.preview);
}

TEST(CarriedEdits, PreviewLightStaysAwayWhereTheUsersEditsShine) {
    ThreeWays lamp = lostItsLights();
    lamp.own.lights.emplace_back().name = "Mine";
    lamp.own.lights.back().node = -2;
    CarriedEdits out = lamp.carried();
    ASSERT_EQ(out.edits.lights.size(), 1u);
    EXPECT_EQ(out.edits.lights[0].name, "Mine");
    EXPECT_EQ(out.edits.sky, SkySettings{});

    ThreeWays sky = lostItsLights();
    sky.own.sky.radiance = glm::vec3(2.0f);
    out = sky.carried();
    EXPECT_TRUE(out.edits.lights.empty());
    EXPECT_EQ(out.edits.sky.radiance, glm::vec3(2.0f));

    ThreeWays glow = lostItsLights();
    glow.after.meshes[0].primitives[0].material = 1;
    glow.own.materials[0].emission = glm::vec3(3.0f); // which no surface has
    EXPECT_EQ(glow.carried().edits.lights.size(), 1u);
    glow.own.materials[1].emission = glm::vec3(3.0f);
    EXPECT_TRUE(glow.carried().edits.lights.empty());
    for (Placement& placement : glow.own.placements)
        placement.hidden = true;
    EXPECT_EQ(glow.carried().edits.lights.size(), 1u) << "hidden objects give no light";
}

TEST(CarriedEdits, PreviewLightThatTheUserHadStaysBesideALamp) {
    ThreeWays all = lostItsLights();
    all.before.lights = all.after.lights;
    all.before.sky = all.after.sky;
    all.own = editsOf(all.before);
    all.own.lights.emplace_back().name = "Mine";
    all.own.lights.back().node = -2;
    EXPECT_EQ(all.carried().edits.lights.size(), 2u);
    EXPECT_TRUE(all.carried().edits.sky.preview);
}

TEST(CarriedEdits, ALightThatTheUserRenamedIsStillTheFiles) {
    ThreeWays all;
    all.own.lights[0].name = "Key light";
    all.after.lights[0].intensity = 7.0f;
    all.after.lights.push_back(Light{.name = "Third", .node = 8});
    const CarriedEdits out = all.carried();
    ASSERT_EQ(out.edits.lights.size(), 3u);
    EXPECT_EQ(out.edits.lights[0].name, "Key light");
    EXPECT_EQ(out.edits.lights[2].name, "Third");
    EXPECT_EQ(out.conflicts.size(), 1u);
}

TEST(CarriedEdits, LightsOfOneNameGoByTheirNumbers) {
    ThreeWays all;
    for (std::vector<Light>* lights : {&all.before.lights, &all.own.lights, &all.after.lights})
        (*lights)[0].name = (*lights)[1].name = "Lamp";
    all.own.lights[1].intensity = 4.0f;
    all.after.lights[0].intensity = 2.0f;
    CarriedEdits out = all.carried();
    EXPECT_EQ(out.edits.lights[0].intensity, 2.0f);
    EXPECT_EQ(out.edits.lights[1].intensity, 4.0f);
    // Nobody knows which is which once their number changed: the file's count, and none comes twice.
    all.after.lights.push_back(Light{.name = "Lamp", .node = 8});
    all.own = editsOf(all.before);
    out = all.carried();
    EXPECT_EQ(out.edits.lights.size(), 3u);
}

TEST(CarriedEdits, ObjectsGoByNameInAnotherOrder) {
    ThreeWays all;
    all.own.placements[0].hidden = true; // the red box
    std::swap(all.after.instances[0], all.after.instances[1]);
    const CarriedEdits out = all.carried();
    EXPECT_FALSE(out.edits.placements[0].hidden);
    EXPECT_TRUE(out.edits.placements[1].hidden);
    EXPECT_FALSE(out.sameNumbers);
}

/// Opens a session whose file another program writes.
class Reload : public SessionTest {
protected:
    void SetUp() override {
        open();
        session_.watchFile(true);
    }
    void writeChanged(const std::function<void(nlohmann::json&)>& change) {
        std::ifstream in(kScenes + "cornell_small.glb", std::ios::binary);
        const std::string bytes((std::istreambuf_iterator<char>(in)), {});
        std::ofstream(file(), std::ios::binary) << withJson(bytes, change);
        std::filesystem::last_write_time(file(), time_ += std::chrono::seconds(2));
        ASSERT_TRUE(until([&, loads = loads_] { return loads_ > loads; }));
    }
    static nlohmann::json& nodeOf(nlohmann::json& document, const std::string& name) {
        for (nlohmann::json& node : document["nodes"])
            if (node.value("name", "") == name) return node;
        throw Error("no node " + name);
    }
    static void move(nlohmann::json& document, const std::string& name, float x) {
        nlohmann::json& node = nodeOf(document, name);
        if (node.contains("matrix"))
            node["matrix"][12] = float(node["matrix"][12]) + x;
        else
            node["translation"] = {x, 0.0f, 0.0f};
    }
};

TEST_F(Reload, AMovedObjectIsAnEditOfTheSameSurfaces) {
    const uint64_t surfaces = session_.surfaces();
    const glm::mat4 before = session_.document().edits.placements.at(0).transform;
    const std::string name = session_.scene()->prepared.scene.instances.at(0).name;
    writeChanged([&](nlohmann::json& document) { move(document, name, 0.125f); });
    EXPECT_EQ(session_.surfaces(), surfaces);
    EXPECT_NE(session_.document().edits.placements.at(0).transform, before);
    EXPECT_FALSE(session_.dirty());
    const std::vector<std::string> notes = session_.takeReloadNotes();
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_EQ(notes[0], "reloaded: 1 object");
    EXPECT_TRUE(session_.takeReloadNotes().empty()) << "told once";
}

TEST_F(Reload, AnotherMeshBeginsTheBakeAnew) {
    const uint64_t surfaces = session_.surfaces();
    writeFile(kScenes + "cornell_geom.glb");
    ASSERT_TRUE(until([&] { return loads_ == 2; }));
    EXPECT_GT(session_.surfaces(), surfaces);
    const std::vector<std::string> notes = session_.takeReloadNotes();
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_TRUE(contains(notes[0], "begins anew")) << notes[0];
}

TEST_F(Reload, EditsThatAreNotSavedStayAndConflictsAreTold) {
    Document next = session_.document();
    next.edits.placements.at(0).hidden = true;
    session_.edit("Hide", next);
    session_.endEdit();
    const std::vector<Instance> instances = session_.scene()->prepared.scene.instances;
    writeChanged([&](nlohmann::json& document) { move(document, instances.at(1).name, 0.125f); });
    EXPECT_TRUE(session_.document().edits.placements.at(0).hidden);
    EXPECT_TRUE(session_.dirty());
    EXPECT_EQ(session_.takeReloadNotes().size(), 1u);
    writeChanged([&](nlohmann::json& document) { move(document, instances.at(0).name, 0.25f); });
    EXPECT_TRUE(session_.document().edits.placements.at(0).hidden);
    const std::vector<std::string> notes = session_.takeReloadNotes();
    ASSERT_EQ(notes.size(), 2u);
    EXPECT_TRUE(contains(notes[1], instances.at(0).name + ": was edited here and in the file")) << notes[1];
}

TEST_F(Reload, WhatWasSavedByUsIsNoChangeOfTheOther) {
    const std::string name = session_.scene()->prepared.scene.instances.at(0).name;
    Document next = session_.document();
    next.edits.placements.at(1).transform[3].x += 0.25f;
    session_.edit("Move", next);
    session_.endEdit();
    session_.save();
    ASSERT_TRUE(until([&] { return session_.saves() == 1; }));
    // The other program knows nothing of that: its file has the object where it was.
    writeChanged([&](nlohmann::json& document) { move(document, name, 0.125f); });
    const std::vector<std::string> notes = session_.takeReloadNotes();
    ASSERT_FALSE(notes.empty());
    EXPECT_EQ(notes[0], "reloaded: 2 objects");
}

TEST_F(Reload, StepsOfAnotherFileAreForgotten) {
    Document next = session_.document();
    next.edits.placements.at(0).hidden = true;
    session_.edit("Hide", next);
    session_.endEdit();
    EXPECT_EQ(session_.undoName(), "Hide");
    writeChanged([&](nlohmann::json& document) {
        document["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.1, 0.2, 0.3, 1.0};
    });
    EXPECT_EQ(session_.undoName(), "") << "it would bring back the wall's old colour, too";
    EXPECT_TRUE(session_.document().edits.placements.at(0).hidden);
}

TEST_F(Reload, ASaveWaitsUntilANewerFileIsRead) {
    session_.watchFile(false);
    Document next = session_.document();
    next.edits.placements.at(0).hidden = true;
    session_.edit("Hide", next);
    session_.endEdit();
    session_.watchFile(true);
    const std::string name = session_.scene()->prepared.scene.instances.at(1).name;
    std::ifstream in(kScenes + "cornell_small.glb", std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), {});
    std::ofstream(file(), std::ios::binary)
        << withJson(bytes, [&](nlohmann::json& document) { move(document, name, 0.125f); });
    std::filesystem::last_write_time(file(), time_ += std::chrono::seconds(2));
    const float x = session_.document().edits.placements.at(1).transform[3].x;
    session_.save();
    ASSERT_TRUE(until([&] { return session_.saves() == 1; }));
    const Scene saved = loadGltf(file());
    EXPECT_TRUE(saved.instances.at(0).hidden);
    EXPECT_NEAR(saved.instances.at(1).transform[3].x, x + 0.125f, 1e-5f) << "the other program's";
}

// A program that saves all the time: the last save counts, and none is read half.
TEST_F(Reload, OfManySavesTheLastOneStays) {
    const std::string name = session_.scene()->prepared.scene.instances.at(0).name;
    std::ifstream in(kScenes + "cornell_small.glb", std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), {});
    constexpr int kSaves = 100;
    const float start = session_.document().edits.placements.at(0).transform[3].x;
    for (int i = 1; i <= kSaves; ++i) {
        const std::string saved = withJson(
            bytes, [&](nlohmann::json& document) { move(document, name, 0.001f * static_cast<float>(i)); });
        std::ofstream(file(), std::ios::binary) << saved.substr(0, saved.size() / 2);
        loads_ += session_.update();
        std::ofstream(file(), std::ios::binary) << saved;
        loads_ += session_.update();
    }
    std::filesystem::last_write_time(file(), time_ += std::chrono::seconds(2));
    ASSERT_TRUE(until([&] {
        return std::abs(session_.document().edits.placements.at(0).transform[3].x - start - 0.001f * kSaves) <
               1e-5f;
    }));
    EXPECT_EQ(session_.lastError(), "");
}

} // namespace
} // namespace relume
