#include "bake/layers/scene_states.h"

#include <gtest/gtest.h>

#include <set>

namespace relume {
namespace {

constexpr size_t kMiB = size_t{1} << 20;

// Returns a state that takes so many megabytes.
std::vector<uint32_t> largeState(size_t megabytes, uint32_t first) {
    std::vector<uint32_t> words(megabytes * kMiB / sizeof(uint32_t), 0);
    words.front() = first;
    return words;
}

Scene sceneOfTwo() {
    Scene scene;
    scene.materials.resize(2);
    scene.instances.resize(2);
    scene.lights.resize(1);
    return scene;
}

SceneState noteOf(SceneStates& states, const Scene& scene) {
    states.note(scene);
    return states.now();
}

TEST(StateBook, NumbersAreAboveNothing) {
    StateBook book;
    EXPECT_GT(book.numberOf({}), 0u);
    EXPECT_GT(book.numberOf({0}), 0u);
}

TEST(StateBook, WhatComesBackHasItsNumber) {
    StateBook book;
    const uint64_t first = book.numberOf({1, 2, 3}), second = book.numberOf({4, 5});
    EXPECT_EQ(book.numberOf({1, 2, 3}), first);
    EXPECT_EQ(book.numberOf({4, 5}), second);
    EXPECT_EQ(book.numberOf({1, 2, 3}), first);
}

TEST(StateBook, WhatDiffersHasAnother) {
    StateBook book;
    std::set<uint64_t> numbers;
    const std::vector<std::vector<uint32_t>> states = {{},     {0},    {0, 0}, {1},
                                                       {1, 0}, {0, 1}, {2},    {0xffffffffu}};
    for (const std::vector<uint32_t>& state : states)
        numbers.insert(book.numberOf(state));
    EXPECT_EQ(numbers.size(), states.size());
}

TEST(StateBook, SixtyFourMegabytesOfStatesAreKnown) {
    StateBook book;
    const uint64_t first = book.numberOf(largeState(16, 1));
    for (uint32_t i = 2; i <= 4; ++i)
        book.numberOf(largeState(16, i));
    EXPECT_EQ(book.numberOf(largeState(16, 1)), first);
    book.numberOf({7});
    EXPECT_NE(book.numberOf(largeState(16, 1)), first) << "a word more is too much";
}

TEST(StateBook, TheOldestIsForgottenBeyondThat) {
    StateBook book;
    const uint64_t first = book.numberOf(largeState(16, 1)), second = book.numberOf(largeState(16, 2));
    for (uint32_t i = 3; i <= 5; ++i)
        book.numberOf(largeState(16, i));
    EXPECT_EQ(book.numberOf(largeState(16, 2)), second);
    const uint64_t again = book.numberOf(largeState(16, 1));
    EXPECT_GT(again, first + 4) << "a number is given once";
    EXPECT_NE(book.numberOf(largeState(16, 2)), second) << "the next oldest made room for it";
}

TEST(StateBook, AsManyAreForgottenAsItTakes) {
    StateBook book;
    const uint64_t small = book.numberOf({7}), large = book.numberOf(largeState(40, 1));
    EXPECT_EQ(book.numberOf({7}), small);
    book.numberOf(largeState(40, 2));
    EXPECT_NE(book.numberOf({7}), small);
    EXPECT_NE(book.numberOf(largeState(40, 1)), large);
}

TEST(StateBook, TheNewestIsKnownHoweverLargeItIs) {
    StateBook book;
    const uint64_t number = book.numberOf(largeState(80, 1));
    EXPECT_EQ(book.numberOf(largeState(80, 1)), number);
}

TEST(SceneStates, AreNoneBeforeTheFirst) {
    SceneStates states;
    EXPECT_EQ(states.now(), SceneState());
    states.note(sceneOfTwo());
    EXPECT_EQ(states.before(), SceneState());
    EXPECT_GT(states.now().surfaces, 0u);
    EXPECT_GT(states.now().objects, 0u);
}

TEST(SceneStates, ColoursAndObjectsCountByThemselves) {
    SceneStates states;
    Scene scene = sceneOfTwo();
    const SceneState first = noteOf(states, scene);
    scene.materials[1].baseColor.y = 0.5f;
    const SceneState coloured = noteOf(states, scene);
    EXPECT_NE(coloured.surfaces, first.surfaces);
    EXPECT_EQ(coloured.objects, first.objects);
    scene.instances[1].transform[3].z = 2.0f;
    const SceneState moved = noteOf(states, scene);
    EXPECT_EQ(moved.surfaces, coloured.surfaces);
    EXPECT_NE(moved.objects, coloured.objects);
}

TEST(SceneStates, EachColourOfEachMaterialCounts) {
    SceneStates states;
    std::set<uint64_t> numbers = {noteOf(states, sceneOfTwo()).surfaces};
    for (size_t material = 0; material < 2; ++material) {
        for (int k = 0; k < 3; ++k) {
            Scene scene = sceneOfTwo();
            scene.materials[material].baseColor[k] = 0.5f;
            numbers.insert(noteOf(states, scene).surfaces);
        }
    }
    EXPECT_EQ(numbers.size(), 7u);
}

TEST(SceneStates, EachPartOfATransformCounts) {
    SceneStates states;
    std::set<uint64_t> numbers = {noteOf(states, sceneOfTwo()).objects};
    for (int k = 0; k < 16; ++k) {
        Scene scene = sceneOfTwo();
        scene.instances[1].transform[k / 4][k % 4] += 0.25f;
        numbers.insert(noteOf(states, scene).objects);
    }
    EXPECT_EQ(numbers.size(), 17u);
}

TEST(SceneStates, WhatComesBackIsTheSame) {
    SceneStates states;
    Scene scene = sceneOfTwo();
    const SceneState first = noteOf(states, scene);
    scene.materials[0].baseColor.x = 0.25f;
    scene.instances[0].transform[3].x = 1.0f;
    const SceneState second = noteOf(states, scene);
    EXPECT_EQ(noteOf(states, sceneOfTwo()), first);
    EXPECT_EQ(noteOf(states, scene), second);
}

TEST(SceneStates, BeforeIsTheOneBeforeTheNewest) {
    SceneStates states;
    Scene scene = sceneOfTwo();
    const SceneState first = noteOf(states, scene);
    scene.instances[0].transform[3].x = 1.0f;
    const SceneState second = noteOf(states, scene);
    EXPECT_EQ(states.before(), first);
    states.note(scene);
    EXPECT_EQ(states.before(), second);
    EXPECT_EQ(states.now(), second);
}

TEST(SceneStates, HiddenObjectsStandNowhere) {
    SceneStates states;
    Scene scene = sceneOfTwo();
    const SceneState shown = noteOf(states, scene);
    scene.instances[1].hidden = true;
    const SceneState hidden = noteOf(states, scene);
    EXPECT_NE(hidden.objects, shown.objects);
    scene.instances[1].transform[3].x = 5.0f;
    EXPECT_EQ(noteOf(states, scene), hidden);
    scene.instances[1].hidden = false;
    EXPECT_NE(noteOf(states, scene).objects, shown.objects);
    scene.instances[1].transform[3].x = 0.0f;
    EXPECT_EQ(noteOf(states, scene), shown);
}

TEST(SceneStates, WhichObjectIsHiddenCounts) {
    SceneStates states;
    Scene first = sceneOfTwo(), second = sceneOfTwo();
    first.instances[0].hidden = true;
    second.instances[1].hidden = true;
    EXPECT_NE(noteOf(states, first).objects, noteOf(states, second).objects);
}

TEST(SceneStates, LightsAndAlphaDoNotCount) {
    SceneStates states;
    Scene scene = sceneOfTwo();
    const SceneState first = noteOf(states, scene);
    scene.lights[0].intensity = 5.0f;
    scene.lights[0].transform[3].x = 5.0f;
    scene.sky.radiance = glm::vec3(1.0f);
    scene.materials[0].baseColor.w = 0.5f;
    scene.materials[0].emission = glm::vec3(3.0f);
    scene.instances[0].name = "other";
    EXPECT_EQ(noteOf(states, scene), first);
}

} // namespace
} // namespace relume
