// These tests say what keys change of how the scene is looked at, and what is answered to them.
#include "app/viewer/state/feedback.h"
#include "app/viewer/state/picture_area.h"
#include "app/viewer/state/view_actions.h"
#include "app/viewer/state/views.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

TEST(ViewActions, ExposureByHandBeginsWithTheAutomaticOne) {
    ViewState view;
    EXPECT_EQ(changeView(view, Action::Brighter, 0, 2.0f), "exposure +2.25 EV");
    EXPECT_EQ(changeView(view, Action::Darker, 0, 9.0f), "exposure +2.00 EV") << "not with the picture's";
    EXPECT_EQ(changeView(view, Action::AutomaticExposure, 0, 2.0f), "");
    EXPECT_EQ(view.exposure, std::nullopt);
    changeView(view, Action::AutomaticExposure, 0, 3.0f);
    EXPECT_EQ(view.exposure, 3.0f) << "off, it stays as it is";
}

TEST(ViewActions, FiltersAndTonesComeRound) {
    ViewState view;
    const LightmapFilter first = view.filter;
    EXPECT_NE(changeView(view, Action::NextFilter, 0, 0), "");
    EXPECT_NE(view.filter, first);
    for (size_t i = 1; i < filterNames().size(); ++i)
        changeView(view, Action::NextFilter, 0, 0);
    EXPECT_EQ(view.filter, first);
    const std::string told = changeView(view, Action::NextTone, 0, 0);
    EXPECT_EQ(told, "tone mapping: " + toneNames()[static_cast<size_t>(view.tone)]);
}

TEST(ViewActions, OnlyLightOfTheSceneIsCompared) {
    ViewState view;
    EXPECT_TRUE(comparesLight(view));
    for (const char* name : {"albedo", "pos", "ligIn", "error", "layer", "voxels", "emission"}) {
        changeView(view, Action::View, static_cast<int>(viewIndex(name)), 0);
        EXPECT_FALSE(comparesLight(view)) << name;
    }
    changeView(view, Action::View, static_cast<int>(viewIndex("lighting")), 0);
    EXPECT_TRUE(comparesLight(view));
    changeView(view, Action::UvTexture, 0, 0);
    EXPECT_FALSE(comparesLight(view)) << "a flat lightmap";
}

TEST(PictureArea, ItsUpperLeftEdgesBelongToIt) {
    const PictureArea area{{10, 20}, {30, 40}};
    EXPECT_TRUE(area.has({10, 20}));
    EXPECT_TRUE(area.has({39.9, 59.9}));
    EXPECT_FALSE(area.has({40, 30}));
    EXPECT_FALSE(area.has({30, 60}));
    EXPECT_FALSE(area.has({9.9, 30}));
    EXPECT_EQ(area.aspect(), 0.75f);
    EXPECT_EQ(PictureArea{}.aspect(), 1.0f);
}

// Draws all that is due.
void drawAll(Feedback& feedback) {
    while (feedback.pacer().due(0).any)
        feedback.pacer().drawn({true, true}, 0, 0.01);
    feedback.sceneDrawn();
}

TEST(Feedback, TheUserWaitsForTheExposureAfterAChangeOfTheirsOnly) {
    Feedback feedback(false);
    drawAll(feedback);
    feedback.followExposure(true);
    EXPECT_FALSE(feedback.pacer().due(0).scene) << "new light alone may wait";
    drawAll(feedback);
    feedback.sceneChanged();
    EXPECT_TRUE(feedback.sceneIsChanged());
    feedback.sceneDrawn();
    feedback.followExposure(true);
    EXPECT_TRUE(feedback.pacer().due(0).scene);
    drawAll(feedback);
    feedback.followExposure(false);
    feedback.followExposure(true);
    EXPECT_FALSE(feedback.pacer().due(0).scene) << "it had settled in between";
}

TEST(Feedback, ShowsErrorsOfTheLogOnce) {
    const LogBuffer log;
    Feedback feedback(false);
    spdlog::warn("a warning");
    spdlog::error("an error");
    feedback.followLog(log);
    feedback.followLog(log);
    ASSERT_EQ(feedback.messages().shown().size(), 1u);
    EXPECT_EQ(feedback.messages().shown().front().text, "an error");
    EXPECT_TRUE(feedback.messages().shown().front().bad);
    drawAll(feedback);
    feedback.expireMessages(feedback.now() + 1e6);
    EXPECT_TRUE(feedback.messages().shown().empty());
    EXPECT_TRUE(feedback.pacer().due(0).any) << "the window without it";
}

} // namespace
} // namespace relume
