// These are the decisions about the maps of a bake: which one comes next, and how it reaches the screen.
#include "app/live/bake_inspection.h"
#include "app/live/map_decision.h"
#include "app/live/map_slots.h"
#include "assets/base/error.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

constexpr LightMapState kNewLight{.solved = true, .newer = true, .kept = KeptLight::Whole};

TEST(LightMapDecision, NothingIsDrawnWithoutLight) {
    EXPECT_EQ(decideLightMap({}), LightMapStep::None);
    EXPECT_EQ(decideLightMap({.newer = true, .edited = true, .drawn = true}), LightMapStep::None);
}

TEST(LightMapDecision, LightThatIsKeptStaysUntilThereIsASolution) {
    LightMapState state = kNewLight;
    EXPECT_EQ(decideLightMap(state), LightMapStep::None);
    state.complete = true;
    EXPECT_EQ(decideLightMap(state), LightMapStep::Draw);
    state = kNewLight;
    state.kept = KeptLight::None;
    EXPECT_EQ(decideLightMap(state), LightMapStep::Draw);
}

TEST(LightMapDecision, AFirstGlanceStaysUntilThereAreBounces) {
    LightMapState state = kNewLight;
    state.kept = KeptLight::Glance;
    state.bounced = false; // direct light alone, of some lights
    EXPECT_EQ(decideLightMap(state), LightMapStep::None);
    state.bounced = true;
    EXPECT_EQ(decideLightMap(state), LightMapStep::Draw);
}

TEST(LightMapDecision, AnEditIsDrawnEvenIfTheLightStays) {
    EXPECT_EQ(decideLightMap({.solved = true, .complete = true, .drawn = true}), LightMapStep::None);
    EXPECT_EQ(decideLightMap({.solved = true, .complete = true, .edited = true, .drawn = true}),
              LightMapStep::Draw);
}

TEST(LightMapDecision, LightComesBackAfterAnotherQuantity) {
    EXPECT_EQ(decideLightMap({.drawn = true, .otherOnScreen = true}), LightMapStep::ShowAgain);
    EXPECT_EQ(decideLightMap({.otherOnScreen = true}), LightMapStep::None) << "there was none";
    LightMapState state = kNewLight;
    state.drawn = state.otherOnScreen = true;
    EXPECT_EQ(decideLightMap(state), LightMapStep::ShowAgain) << "that of the bake before";
    state.complete = true;
    EXPECT_EQ(decideLightMap(state), LightMapStep::Draw);
}

TEST(InspectedMapDecision, WhatIsAskedComesAtOnce) {
    EXPECT_EQ(decideInspectedMap({.asked = true}), InspectedMapStep::Draw);
}

TEST(InspectedMapDecision, WhatChangesComesNowAndThen) {
    EXPECT_EQ(decideInspectedMap({}), InspectedMapStep::None);
    EXPECT_EQ(decideInspectedMap({.changed = true}), InspectedMapStep::Wait);
    EXPECT_EQ(decideInspectedMap({.changed = true, .secondsSince = kInspectSeconds}), InspectedMapStep::Draw);
    EXPECT_EQ(decideInspectedMap({.secondsSince = kInspectSeconds}), InspectedMapStep::None);
}

TEST(MapContents, LightAndErrorsFollowTheBakeAndColoursHaveNoUnit) {
    for (const MapContent content : {MapContent::LigIn, MapContent::Error, MapContent::Layer})
        EXPECT_TRUE(follows(content) && !isPlain(content));
    for (const MapContent content : {MapContent::Normal, MapContent::Material, MapContent::Seen})
        EXPECT_TRUE(isPlain(content) && !follows(content));
    EXPECT_TRUE(isPlain(MapContent::Leaves) && follows(MapContent::Leaves));
}

TEST(DisplayChoice, ImagesAreSharedWhereNothingIsInTheWay) {
    EXPECT_TRUE(chooseDisplay(DisplayMode::Auto, "").shared);
    EXPECT_TRUE(chooseDisplay(DisplayMode::Shared, "").shared);
    EXPECT_FALSE(chooseDisplay(DisplayMode::Copied, "").shared);
    EXPECT_EQ(chooseDisplay(DisplayMode::Auto, "").text, "shared (OpenGL and Vulkan use one device)");
}

TEST(DisplayChoice, TellsWhyTheyAreCopied) {
    EXPECT_EQ(chooseDisplay(DisplayMode::Copied, "reason").text, "copied (as asked for)");
    EXPECT_EQ(chooseDisplay(DisplayMode::Auto, "reason").text, "copied (reason)");
    EXPECT_FALSE(chooseDisplay(DisplayMode::Auto, "reason").shared);
    EXPECT_EQ(chooseAfterRefusal(DisplayMode::Auto).text, "copied (OpenGL did not take the images)");
}

TEST(DisplayChoice, ThrowsWhereTheyMustBeSharedAndCannot) {
    EXPECT_THROW(chooseDisplay(DisplayMode::Shared, "reason"), Error);
    EXPECT_THROW(chooseAfterRefusal(DisplayMode::Shared), Error);
}

} // namespace
} // namespace relume
