// These tests say what keys make of lights, and what of a scene shines in its picture.
#include "app/viewer/edits/light_actions.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

constexpr LightKey kSun{LightKey::Kind::Sky, 0, 0}, kPanel{LightKey::Kind::Emitter, 4, 1},
    kBulb{LightKey::Kind::Lamp, 0, 0}, kSpot{LightKey::Kind::Lamp, 1, 0};

/// Holds a document with a mesh light, two analytic lights and a sky.
class LightActions : public testing::Test {
protected:
    LightActions() {
        SceneEdits& edits = document_.edits;
        edits.materials.resize(2);
        edits.materials[1].emission = glm::vec3(2.0f);
        for (const char* name : {"Bulb", "Spot"}) {
            Light light;
            light.name = name;
            addLamp(document_, light);
        }
        edits.sky.radiance = glm::vec3(3.0f);
    }
    LightChange done(const LightKey& key, Action action, int argument = 0) const {
        const auto changed = changedLight(document_, source(key), action, argument);
        EXPECT_TRUE(std::holds_alternative<LightChange>(changed));
        return std::get<LightChange>(changed);
    }
    const LightSource& source(const LightKey& key) const {
        for (const LightSource& candidate : sources_)
            if (candidate.key == key) return candidate;
        return sources_.front();
    }

    Document document_;
    std::vector<LightSource> sources_ = {{kPanel, "Panel", glm::vec3(2.0f)},
                                         {kBulb, "Bulb", glm::vec3(1.0f)},
                                         {kSpot, "Spot", glm::vec3(1.0f)},
                                         {kSun, "sky", glm::vec3(3.0f)}};
};

TEST_F(LightActions, SwitchesKeepTheSelection) {
    const LightChange muted = done(kPanel, Action::MuteLight);
    EXPECT_EQ(muted.name, "Mute of Panel");
    EXPECT_EQ(muted.next.mix.muted, std::vector{kPanel});
    EXPECT_EQ(muted.selected, kPanel);
    document_ = muted.next;
    EXPECT_TRUE(done(kPanel, Action::MuteLight).next.mix.muted.empty());
    EXPECT_EQ(done(kSun, Action::SoloLight).next.mix.solo, std::vector{kSun});
}

TEST_F(LightActions, FourStepsOfStrengthAreTwice) {
    for (int i = 0; i < 4; ++i)
        document_ = done(kPanel, Action::LightStrength, 1).next;
    EXPECT_NEAR(document_.edits.materials[1].emission.r, 4.0f, 1e-4f);
    for (int i = 0; i < 4; ++i)
        document_ = done(kPanel, Action::LightStrength, -1).next;
    EXPECT_NEAR(document_.edits.materials[1].emission.r, 2.0f, 1e-4f);
}

TEST_F(LightActions, OnlyLightsWithoutGeometryAreCopiedAndDeleted) {
    for (const Action action : {Action::DuplicateLight, Action::DeleteLight}) {
        const auto changed = changedLight(document_, source(kPanel), action, 0);
        ASSERT_TRUE(std::holds_alternative<std::string>(changed));
        EXPECT_EQ(std::get<std::string>(changed),
                  "Panel: only lights without geometry can be copied and deleted");
    }
    const LightChange copied = done(kBulb, Action::DuplicateLight);
    EXPECT_EQ(copied.next.edits.lights.size(), 3u);
    ASSERT_TRUE(copied.selected);
    EXPECT_NE(*copied.selected, kBulb) << "the copy is selected";
    const LightChange deleted = done(kBulb, Action::DeleteLight);
    EXPECT_EQ(deleted.next.edits.lights.size(), 1u);
    EXPECT_EQ(deleted.selected, std::nullopt);
}

TEST_F(LightActions, ASceneHasOneSky) {
    EXPECT_FALSE(addedLight(document_, kAddSky, {}));
    document_.edits.sky.radiance = glm::vec3(0.0f);
    const std::optional<LightChange> sky = addedLight(document_, kAddSky, {});
    ASSERT_TRUE(sky);
    EXPECT_EQ(sky->name, "Add sky");
    EXPECT_EQ(sky->selected, kSun);
    EXPECT_GT(sky->next.edits.sky.radiance.r, 0.0f);
    const std::optional<LightChange> point = addedLight(document_, static_cast<int>(LightType::Point), {});
    ASSERT_TRUE(point);
    EXPECT_EQ(point->name, "Add " + point->next.edits.lights.back().name);
    EXPECT_EQ(point->selected, (LightKey{LightKey::Kind::Lamp, 2, 0}));
}

TEST_F(LightActions, APictureOfTheSkyHasAFactor) {
    LightChange change = skyWithPicture(document_, "sky.hdr");
    EXPECT_EQ(change.next.edits.sky.file, "sky.hdr");
    EXPECT_EQ(change.next.edits.sky.radiance, glm::vec3(1.0f)) << "it was a radiance";
    change.next.edits.sky.radiance = glm::vec3(0.5f);
    EXPECT_EQ(skyWithPicture(change.next, "other.hdr").next.edits.sky.radiance, glm::vec3(0.5f))
        << "it was a factor already";
    EXPECT_FALSE(skyWithoutPicture(document_, {}));
    const std::optional<LightChange> plain = skyWithoutPicture(change.next, {});
    ASSERT_TRUE(plain);
    EXPECT_EQ(plain->next.edits.sky.file, "");
    EXPECT_EQ(plain->next.edits.sky.radiance, makeSky({}, {}).radiance);
}

TEST_F(LightActions, TheBoardGoesRound) {
    EXPECT_EQ(lightBeside(sources_, std::nullopt, 1), kPanel);
    EXPECT_EQ(lightBeside(sources_, std::nullopt, -1), kSun);
    EXPECT_EQ(lightBeside(sources_, kPanel, 1), kBulb);
    EXPECT_EQ(lightBeside(sources_, kPanel, -1), kSun);
    EXPECT_EQ(lightBeside(sources_, kSun, 1), kPanel);
    EXPECT_EQ(lightBeside({}, kSun, 1), std::nullopt);
}

TEST_F(LightActions, AMutedLightIsDark) {
    EXPECT_EQ(shiningScene(document_, sources_, {}, {}).materials[1].emission, glm::vec3(2.0f));
    document_.mix.muted = {kPanel};
    EXPECT_EQ(shiningScene(document_, sources_, {}, {}).materials[1].emission, glm::vec3(0.0f));
    EXPECT_EQ(shiningScene(document_, sources_, {}, {}).sky.radiance, glm::vec3(3.0f));
    document_.mix.muted = {kSun};
    EXPECT_EQ(shiningScene(document_, sources_, {}, {}).sky.radiance, glm::vec3(0.0f));
}

TEST_F(LightActions, AloneAMutedLightShines) {
    document_.mix.muted = {kPanel};
    const ShiningScene alone = shiningScene(document_, sources_, kPanel, {});
    EXPECT_EQ(alone.materials[1].emission, glm::vec3(2.0f));
    EXPECT_EQ(alone.sky.radiance, glm::vec3(0.0f));
}

TEST_F(LightActions, AGroupIsLookedAtWhole) {
    const LightGroup rest{{{LightKey::Kind::Group, 0, 0}, "rest", glm::vec3(1.0f)},
                          {source(kPanel), source(kBulb)}};
    EXPECT_EQ(shiningScene(document_, sources_, kBulb, {rest}).materials[1].emission, glm::vec3(2.0f));
    EXPECT_EQ(shiningScene(document_, sources_, kBulb, {rest}).sky.radiance, glm::vec3(0.0f));
    document_.mix.muted = {kPanel};
    EXPECT_EQ(shiningScene(document_, sources_, kBulb, {rest}).materials[1].emission, glm::vec3(0.0f));
}

} // namespace
} // namespace relume
