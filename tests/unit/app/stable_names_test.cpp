// Names like "Obj 2" go by the order of what a file holds: saved and read again, they mean the same things.
#include "app/edit/scene_edit.h"
#include "app/edit/scene_names.h"
#include "tests/unit/edited_file.h"

#include <gtest/gtest.h>

#include <random>

namespace relume {
namespace {

using nlohmann::json;
using test::LitScene;

class StableNames : public test::EditedFile {
protected:
    struct Saved {
        Scene after; // as it was edited, with the nodes that the file has now
        Scene back;  // as it is read again
    };

    /// Edits the file at `path` and saves it over itself.
    static Saved edited(const std::string& path, const std::vector<SceneEdit>& made) {
        const Scene before = loadGltf(path);
        SceneEdits edits = editsOf(before);
        for (const SceneEdit& edit : made)
            applyEdit(before, edit, edits);
        Scene after = before;
        applyEdits(after, edits);
        const EditedNodes nodes = saveEditedGltf(path, before, after, path);
        for (size_t i = 0; i < after.lights.size(); ++i)
            after.lights[i].node = nodes.lights[i];
        for (size_t i = 0; i < after.instances.size(); ++i)
            after.instances[i].node = nodes.instances[i];
        return {std::move(after), loadGltf(path)};
    }

    static std::vector<std::string> labelsOf(const Scene& scene) {
        std::vector<std::string> labels;
        for (const NamedThing& thing : namedThings(scene, editsOf(scene)))
            labels.push_back(thing.label());
        return labels;
    }

    static void expectSameThings(const Saved& saved) {
        const Scene &after = saved.after, &back = saved.back;
        ASSERT_EQ(back.instances.size(), after.instances.size());
        ASSERT_EQ(back.lights.size(), after.lights.size());
        for (size_t i = 0; i < back.instances.size(); ++i) {
            SCOPED_TRACE("object " + std::to_string(i));
            EXPECT_EQ(back.instances[i].node, after.instances[i].node);
            EXPECT_EQ(back.instances[i].name, after.instances[i].name);
            test::expectNear(back.instances[i].transform, after.instances[i].transform, 1e-4f);
        }
        for (size_t i = 0; i < back.lights.size(); ++i) {
            SCOPED_TRACE("light " + std::to_string(i));
            EXPECT_EQ(back.lights[i].node, after.lights[i].node);
            EXPECT_EQ(back.lights[i].type, after.lights[i].type);
            EXPECT_EQ(back.lights[i].name, after.lights[i].name);
            test::expectNear(back.lights[i].transform, after.lights[i].transform, 1e-4f);
        }
        EXPECT_EQ(labelsOf(back), labelsOf(after));
    }

    static glm::vec3 placeOf(const Scene& scene, const std::string& name) {
        const NamedThing thing =
            findThing(namedThings(scene, editsOf(scene)), name, {.lamps = true, .objects = true});
        return thing.kind == NamedThing::Kind::Lamp ? scene.lights[thing.index].transform[3]
                                                    : scene.instances[thing.index].transform[3];
    }

    /// Makes a node of this name below another of this name, 1 m above it, each with what `carried` is.
    static LitScene pair(const std::string& name, json carried) {
        LitScene scene;
        carried["name"] = name;
        carried["translation"] = {0, 1, 0};
        const int child = scene.node(carried);
        carried["translation"] = {3, 0, 0};
        carried["children"] = {child};
        scene.json["scenes"][0]["nodes"].push_back(scene.node(carried));
        return scene;
    }
};

TEST_F(StableNames, AnObjectThatLeavesItsNodeIsStillTheFirst) {
    const std::string path = write(pair("Obj", {{"mesh", 0}}));
    for (int turn = 1; turn <= 3; ++turn) {
        expectSameThings(edited(path, {MoveEdit{"object:Obj", {1, 0, 0}, true}}));
        EXPECT_EQ(placeOf(loadGltf(path), "object:Obj"), glm::vec3(3 + turn, 0, 0));
        EXPECT_EQ(placeOf(loadGltf(path), "object:Obj 2"), glm::vec3(3, 1, 0));
    }
}

TEST_F(StableNames, ALightThatLeavesItsNodeIsStillTheFirst) {
    LitScene scene = pair("Lamp", {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    scene.light({{"type", "point"}});
    const std::string path = write(scene);
    expectSameThings(edited(path, {MoveEdit{"Lamp", {1, 0, 0}, true}}));
    expectSameThings(edited(path, {MoveEdit{"Lamp", {1, 0, 0}, true}, RotateEdit{"Lamp 2", {0, 90, 0}}}));
    EXPECT_EQ(placeOf(loadGltf(path), "Lamp"), glm::vec3(5, 0, 0));
    EXPECT_EQ(placeOf(loadGltf(path), "Lamp 2"), glm::vec3(3, 1, 0));
}

TEST_F(StableNames, TwoLightsOfANodeKeepTheirOrder) {
    LitScene scene;
    scene.light({{"type", "point"}, {"name", "Lamp"}});
    json node = {{"name", "Post"}, {"mesh", 0}, {"translation", {1, 0, 0}}};
    node["extensions"]["KHR_lights_punctual"]["light"] = 0;
    node["extras"]["relume"]["areaLight"] = {{"type", "disc"}, {"radius", 0.3}, {"name", "Lamp"}};
    scene.json["scenes"][0]["nodes"].push_back(scene.node(node));
    for (const char* first : {"Lamp", "Lamp 2"}) {
        SCOPED_TRACE(first);
        const std::string path = write(scene);
        expectSameThings(edited(path, {MoveEdit{first, {0, 1, 0}, true}}));
        expectSameThings(edited(path, {MoveEdit{"Lamp 2", {0, 0, 1}, true}}));
        expectSameThings(edited(path, {MoveEdit{"Lamp", {0, 0, 2}, true}}));
        EXPECT_EQ(loadGltf(path).lights[0].type, LightType::Point);
    }
}

TEST_F(StableNames, ALightThatComesBackIsWhereItWas) {
    LitScene scene;
    const int entry = scene.light({{"type", "point"}, {"name", "Lamp"}});
    for (int i = 0; i < 3; ++i)
        scene.lamp({{"translation", {i, 0, 0}}}, entry);
    const std::string path = write(scene);
    const Scene before = loadGltf(path);
    Scene after = before;
    Light back = after.lights[1];
    back.node = -1; // as one that was deleted with its node
    back.transform[3].y = 7;
    after.lights.insert(after.lights.begin() + 1, back);
    saveEditedGltf(path, before, after, path);
    const Scene read = loadGltf(path);
    ASSERT_EQ(read.lights.size(), 4u);
    for (size_t i = 0; i < 4; ++i)
        test::expectNear(read.lights[i].transform, after.lights[i].transform);
    EXPECT_EQ(placeOf(read, "Lamp 2").y, 7);
}

class RandomNames : public StableNames {
protected:
    int pick(size_t count) { return std::uniform_int_distribution<int>(0, int(count) - 1)(random_); }
    glm::vec3 vector() {
        std::uniform_real_distribution<float> number(-90, 90);
        return {number(random_), number(random_), number(random_)};
    }
    std::string name() {
        const std::vector<std::string> names = {"Obj", "Obj 2", "Obj 2 2", "Lamp", "Lamp 2", ""};
        return names[size_t(pick(names.size()))];
    }

    /// Makes a forest of nodes in which many things share few names.
    LitScene file() {
        LitScene scene;
        for (int i = 0; i < 3; ++i)
            scene.light({{"type", i == 0 ? "spot" : "point"}, {"name", name()}});
        scene.json["meshes"][0]["name"] = name();
        for (int nodes = 3 + pick(8); nodes > 0; --nodes) {
            json node = {{"name", name()}, {"translation", {pick(5), pick(5), pick(5)}}};
            if (pick(2) == 0) node["rotation"] = {0, 0.6, 0, 0.8};
            if (pick(2) == 0) node["mesh"] = 0;
            if (pick(2) == 0) node["extensions"]["KHR_lights_punctual"]["light"] = pick(3);
            if (pick(3) == 0)
                node["extras"]["relume"]["areaLight"] = {{"type", "disc"}, {"radius", 0.3}, {"name", name()}};
            const int index = scene.node(node), parent = pick(size_t(index) + 1) - 1;
            json& holder =
                parent < 0 ? scene.json["scenes"][0]["nodes"] : scene.json["nodes"][parent]["children"];
            holder.push_back(index);
        }
        return scene;
    }

    SceneEdit edit(const Scene& scene, const SceneEdits& edits) {
        std::vector<std::string> lamps, placed;
        for (const NamedThing& thing : namedThings(scene, edits)) {
            if (thing.kind == NamedThing::Kind::Lamp) lamps.push_back("light:" + thing.name);
            if (thing.kind == NamedThing::Kind::Lamp || thing.kind == NamedThing::Kind::Object)
                placed.push_back(thing.label());
        }
        for (std::string& label : placed) // "object 'Obj'" is typed object:Obj
            label = label.substr(0, label.find(' ')) + ":" +
                    label.substr(label.find('\'') + 1, label.size() - label.find('\'') - 2);
        const auto some = [&](const std::vector<std::string>& names) {
            return names[size_t(pick(names.size()))];
        };
        const int kind = lamps.empty() ? pick(3) : pick(7);
        if (kind == 0) return RotateEdit{some(placed), vector()};
        if (kind == 1) {
            AddLightEdit add;
            add.type = pick(2) == 0 ? LightType::Point : LightType::Rectangle;
            add.settings = {{Property::Name, std::string("Lamp")}};
            return add;
        }
        if (kind == 3) return DuplicateEdit{some(lamps), pick(2) == 0 ? "Lamp" : ""};
        if (kind == 4) return DeleteEdit{some(lamps)};
        if (kind == 5) return SetEdit{some(lamps), {Property::Name, std::string("Obj")}};
        return MoveEdit{some(placed), vector(), pick(2) == 0};
    }

    std::mt19937 random_;
};

TEST_F(RandomNames, MeanTheSameWhenTheyAreReadAgain) {
    constexpr uint32_t kFiles = 80, kSaves = 5;
    for (uint32_t seed = 0; seed < kFiles && !HasFailure(); ++seed) {
        SCOPED_TRACE(seed);
        random_.seed(seed);
        const std::string path = write(file());
        for (uint32_t i = 0; i < kSaves && !HasFailure(); ++i) {
            const Scene scene = loadGltf(path);
            SceneEdits edits = editsOf(scene);
            std::vector<SceneEdit> made;
            for (int count = 1 + pick(3); count > 0; --count) {
                made.push_back(edit(scene, edits));
                applyEdit(scene, made.back(), edits);
            }
            expectSameThings(edited(path, made));
        }
    }
}

} // namespace
} // namespace relume
