// KHR_node_visibility is read and written: what is hidden, and what stays to be seen.
#include "tests/unit/edited_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace relume {
namespace {

using nlohmann::json;
using test::jsonOf;
using test::LitScene;

const json kHidden = {{"KHR_node_visibility", {{"visible", false}}}};

class GltfVisibility : public test::EditedFile {
protected:
    /// Returns the names of the objects that are shown.
    static std::vector<std::string> shownIn(const Scene& scene) {
        std::vector<std::string> names;
        for (const Instance& instance : scene.instances)
            if (!instance.hidden) names.push_back(instance.name);
        return names;
    }
    static void setHidden(Scene& scene, const std::string& name, bool hidden) {
        for (Instance& instance : scene.instances)
            if (instance.name == name) instance.hidden = hidden;
    }
};

using Names = std::vector<std::string>;

/// A group with a mesh, a light and two children; one of the children has a child of its own.
LitScene group() {
    LitScene scene;
    scene.json["nodes"][0]["name"] = "Alone";
    const int lamp = scene.light({{"type", "point"}, {"name", "Lamp"}});
    const int top = scene.lamp({{"name", "Top"}, {"mesh", 0}, {"translation", {1, 2, 3}}}, lamp);
    const int left = scene.node({{"name", "Left"}, {"mesh", 0}, {"translation", {0, 1, 0}}});
    const int right = scene.node({{"name", "Right"}, {"mesh", 0}});
    const int leaf = scene.node({{"name", "Leaf"}, {"mesh", 0}, {"scale", {2, 2, 2}}});
    scene.json["nodes"][top]["children"] = {left, right};
    scene.json["nodes"][right]["children"] = {leaf};
    return scene;
}

TEST_F(GltfVisibility, AHiddenNodeHidesAllBelowItAndItsLights) {
    LitScene file = group();
    EXPECT_EQ(shownIn(loadGltf(write(file))), (Names{"Alone", "Top", "Left", "Right", "Leaf"}));
    EXPECT_EQ(loadGltf(write(file)).lights.size(), 1u);
    file.json["nodes"][3]["extensions"] = kHidden;
    file.json["nodes"][4]["extensions"] = {{"KHR_node_visibility", {{"visible", true}}}};
    EXPECT_EQ(shownIn(loadGltf(write(file))), (Names{"Alone", "Top", "Left"}));
    file.json["nodes"][1]["extensions"].update(kHidden);
    const Scene scene = loadGltf(write(file));
    EXPECT_EQ(shownIn(scene), Names{"Alone"});
    EXPECT_EQ(scene.instances.size(), 5u) << "they are there, hidden";
    EXPECT_TRUE(scene.lights.empty());
    EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST_F(GltfVisibility, HidingAndShowingAgainLeavesNoTrace) {
    const std::string path = write(LitScene());
    const json original = jsonOf(path);
    save(path, [](Scene& scene) { scene.instances[0].hidden = true; });
    json expected = original;
    expected["nodes"][0]["extensions"] = kHidden;
    expected["extensionsUsed"] = {"KHR_node_visibility"};
    EXPECT_EQ(jsonOf(path), expected);
    EXPECT_TRUE(loadGltf(path).instances[0].hidden);
    save(path, [](Scene& scene) { scene.instances[0].hidden = false; });
    EXPECT_EQ(jsonOf(path), original);
}

TEST_F(GltfVisibility, WhatIsHiddenAloneTakesNothingAlong) {
    const std::string path = write(group());
    const Scene before = loadGltf(path);
    save(path, [](Scene& scene) { setHidden(scene, "Top", true); });
    const Scene back = loadGltf(path);
    EXPECT_EQ(shownIn(back), (Names{"Alone", "Left", "Right", "Leaf"}));
    EXPECT_EQ(back.lights, before.lights);
    for (const Instance& instance : back.instances) {
        const auto same = std::find_if(before.instances.begin(), before.instances.end(),
                                       [&](const Instance& other) { return other.name == instance.name; });
        ASSERT_NE(same, before.instances.end());
        EXPECT_EQ(instance.transform, same->transform) << instance.name;
    }
}

TEST_F(GltfVisibility, OneObjectOfAHiddenGroupIsShown) {
    LitScene file = group();
    file.json["nodes"][1]["extensions"].update(kHidden);
    const std::string path = write(file);
    save(path, [](Scene& scene) { setHidden(scene, "Right", false); });
    const Scene back = loadGltf(path);
    EXPECT_EQ(shownIn(back), (Names{"Alone", "Right"}));
    EXPECT_TRUE(back.lights.empty()) << "the group's lamp stays off";
    save(path, [](Scene& scene) {
        for (Instance& instance : scene.instances)
            instance.hidden = false;
    });
    EXPECT_EQ(shownIn(loadGltf(path)).size(), 5u);
}

TEST_F(GltfVisibility, ALampComesBackOutsideAHiddenNode) {
    LitScene file = group();
    const std::string path = write(file);
    const Scene loaded = loadGltf(path);
    Scene dark = loaded;
    dark.lights.clear();
    setHidden(dark, "Top", true);
    setHidden(dark, "Left", true);
    saveEditedGltf(path, loaded, dark, path);
    dark = loadGltf(path);
    Scene lit = dark;
    lit.lights = loaded.lights;
    saveEditedGltf(path, dark, lit, path);
    const Scene back = loadGltf(path);
    ASSERT_EQ(back.lights.size(), 1u);
    test::expectNear(back.lights[0].transform, loaded.lights[0].transform);
    EXPECT_EQ(shownIn(back), (Names{"Alone", "Right", "Leaf"}));
}

/// Whatever is hidden, shown and moved at once, the file says it, with everything in its place.
TEST_F(GltfVisibility, RandomEditsAreReadBack) {
    std::mt19937 random(11);
    for (int round = 0; round < 60 && !HasFailure(); ++round) {
        SCOPED_TRACE(round);
        LitScene file = group();
        for (json& node : file.json["nodes"])
            if (random() % 3 == 0) node["extensions"].update(kHidden);
        const std::string path = write(file);
        for (int saves = 0; saves < 4; ++saves) {
            const Scene before = loadGltf(path);
            Scene after = before;
            for (Instance& instance : after.instances) {
                if (random() % 2 == 0) instance.hidden = !instance.hidden;
                if (random() % 3 == 0) instance.transform[3].x += 1.0f;
            }
            if (!after.lights.empty() && random() % 2 == 0) after.lights[0].transform[3].y += 1.0f;
            const EditedNodes nodes = saveEditedGltf(path, before, after, path);
            const Scene back = loadGltf(path);
            ASSERT_EQ(back.instances.size(), after.instances.size());
            ASSERT_EQ(back.lights.size(), after.lights.size());
            for (size_t i = 0; i < after.instances.size(); ++i) {
                const auto same =
                    std::find_if(back.instances.begin(), back.instances.end(),
                                 [&](const Instance& other) { return other.node == nodes.instances[i]; });
                ASSERT_NE(same, back.instances.end());
                EXPECT_EQ(same->hidden, after.instances[i].hidden) << same->name;
                test::expectNear(same->transform, after.instances[i].transform, 1e-4f);
            }
            for (size_t i = 0; i < after.lights.size(); ++i)
                test::expectNear(back.lights[i].transform, after.lights[i].transform, 1e-4f);
        }
    }
}

TEST_F(GltfVisibility, AWrittenGlbKeepsWhatIsHidden) {
    Scene scene = loadGltf(write(group()));
    setHidden(scene, "Left", true);
    saveGlb(scene, folder_.path("copy.glb"));
    EXPECT_EQ(shownIn(loadGltf(folder_.path("copy.glb"))), (Names{"Alone", "Top", "Right", "Leaf"}));
    EXPECT_EQ(jsonOf(folder_.path("copy.glb"))["extensionsUsed"],
              json({"KHR_lights_punctual", "KHR_node_visibility"}));
}

} // namespace
} // namespace relume
