// An edit is compared with the scene that is baked, which decides what becomes of it.
#include "bake/baker/edit_decision.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

Scene editedRoom() {
    Scene scene;
    scene.materials.resize(3);
    scene.materials[1].emission = glm::vec3(2.0f);
    scene.materials[2].emission = glm::vec3(3.0f);
    scene.materials[2].doubleSided = true;
    scene.lights.resize(2);
    scene.instances.resize(2);
    scene.sky.radiance = glm::vec3(1.0f);
    scene.sky.file = "sky.hdr";
    return scene;
}

SceneDifference after(void (*edit)(SceneEdits&)) {
    const Scene scene = editedRoom();
    SceneEdits edits = editsOf(scene);
    edit(edits);
    return differenceBetween(scene, edits);
}

constexpr BakeReadiness kReady{.follows = true, .fits = true, .atRest = true};
constexpr BakeReadiness kUnderWay{.follows = true, .fits = true, .atRest = false};

} // namespace

TEST(SceneDifference, OfTheSameSceneIsNone) {
    EXPECT_FALSE(after([](SceneEdits&) {}).any());
}

TEST(SceneDifference, NamesOfMaterialsAreNone) {
    EXPECT_FALSE(after([](SceneEdits& edits) { edits.materials[0].name = "Wood"; }).any());
}

TEST(SceneDifference, LightsAndSettingsOfTheSkyAreLights) {
    for (void (*const edit)(SceneEdits&) : {+[](SceneEdits& edits) { edits.lights[1].intensity = 2.0f; },
                                            +[](SceneEdits& edits) { edits.lights[0].transform[3].x = 1.0f; },
                                            +[](SceneEdits& edits) { edits.lights.pop_back(); },
                                            +[](SceneEdits& edits) { edits.lights.emplace_back(); },
                                            +[](SceneEdits& edits) { edits.sky.radiance.g = 0.5f; },
                                            +[](SceneEdits& edits) { edits.sky.rotation = 0.5f; }}) {
        const SceneDifference difference = after(edit);
        EXPECT_TRUE(difference.lights);
        EXPECT_FALSE(difference.colours || difference.objects || difference.patches);
    }
}

TEST(SceneDifference, BaseColoursAndStrengthsAreColours) {
    for (void (*const edit)(SceneEdits&) :
         {+[](SceneEdits& edits) { edits.materials[0].baseColor.r = 0.5f; },
          +[](SceneEdits& edits) { edits.materials[1].emission *= 0.5f; },
          +[](SceneEdits& edits) { edits.materials[2].emission *= 0.5f; },
          +[](SceneEdits& edits) { edits.materials[1].emission = glm::vec3(0.0f); },
          +[](SceneEdits& edits) { edits.materials[0].emission = glm::vec3(1.0f); }}) {
        const SceneDifference difference = after(edit);
        EXPECT_TRUE(difference.colours);
        EXPECT_FALSE(difference.lights || difference.objects || difference.patches);
    }
}

TEST(SceneDifference, PlacesAndWhatIsHiddenAreObjects) {
    for (void (*const edit)(SceneEdits&) :
         {+[](SceneEdits& edits) { edits.placements[1].transform[3].x = 1.0f; },
          +[](SceneEdits& edits) { edits.placements[0].hidden = true; }}) {
        const SceneDifference difference = after(edit);
        EXPECT_TRUE(difference.objects);
        EXPECT_FALSE(difference.lights || difference.colours || difference.patches);
    }
}

TEST(SceneDifference, ThatPatchesAreMadeOfIsTold) {
    for (void (*const edit)(SceneEdits&) :
         {+[](SceneEdits& edits) { edits.materials[0].baseColor.a = 0.5f; },
          +[](SceneEdits& edits) { edits.materials[2].emission = glm::vec3(0.0f); },
          +[](SceneEdits& edits) { edits.materials.emplace_back(); },
          +[](SceneEdits& edits) { edits.placements.emplace_back(); },
          +[](SceneEdits& edits) { edits.sky.file = "other.hdr"; }})
        EXPECT_TRUE(after(edit).patches);
}

TEST(EditDecision, NothingAndLightsCountAtOnce) {
    EXPECT_EQ(decideEdit({}, kUnderWay), Applied::Now);
    EXPECT_EQ(decideEdit({.lights = true}, kUnderWay), Applied::Now);
    EXPECT_EQ(decideEdit({.lights = true}, kReady), Applied::Now);
}

TEST(EditDecision, ColoursAndObjectsWaitForRest) {
    for (const SceneDifference& difference :
         {SceneDifference{.colours = true}, SceneDifference{.objects = true},
          SceneDifference{.lights = true, .colours = true, .objects = true}}) {
        EXPECT_EQ(decideEdit(difference, kUnderWay), Applied::Later);
        EXPECT_EQ(decideEdit(difference, kReady), Applied::Now);
    }
}

TEST(EditDecision, OtherPatchesNeedANewBakeAtOnce) {
    for (const BakeReadiness& readiness : {kReady, kUnderWay})
        EXPECT_EQ(decideEdit({.colours = true, .patches = true}, readiness), Applied::NeedsNewBake);
}

TEST(EditDecision, WithoutLayersEveryEditNeedsANewBake) {
    const BakeReadiness readiness{.follows = false, .fits = true, .atRest = true};
    EXPECT_EQ(decideEdit({}, readiness), Applied::NeedsNewBake);
    EXPECT_EQ(decideEdit({.lights = true}, readiness), Applied::NeedsNewBake);
}

// The lights that are baked fit, whatever is said of more of them.
TEST(EditDecision, LightsBeyondTheMemoryNeedANewBake) {
    const BakeReadiness readiness{.follows = true, .fits = false, .atRest = true};
    EXPECT_EQ(decideEdit({}, readiness), Applied::Now);
    EXPECT_EQ(decideEdit({.lights = true}, readiness), Applied::NeedsNewBake);
    EXPECT_EQ(decideEdit({.colours = true}, readiness), Applied::NeedsNewBake);
}

} // namespace relume
