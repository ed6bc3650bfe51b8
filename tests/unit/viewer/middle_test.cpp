// These tests say what stands in the middle of the window: the scene, the start page, or a card.
#include "app/viewer/state/middle.h"

#include "app/viewer/panels/tab_order.h"
#include "app/viewer/state/picture_notice.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

using Card = Middle::Card;
using Facts = Opening::Facts;

const OpenFailure kFailure{"/levels/bad.glb", "/levels/bad.glb: is no glTF: export it again"};

TEST(Middle, WithoutASceneTheStartPageIsThere) {
    Opening opening;
    EXPECT_EQ(opening.middle({}), (Middle{.startPage = true, .card = Card::None}));
    EXPECT_EQ(opening.middle({.scene = true}), Middle{});
    EXPECT_FALSE(opening.putAway({})) << "nothing is behind it";
}

TEST(Middle, AFirstSceneThatIsReadShowsItsProgressAtOnce) {
    Opening opening;
    opening.begin("room.glb", 7);
    EXPECT_EQ(opening.middle({.loading = true, .time = 7}), (Middle{false, Card::Opening}));
    EXPECT_EQ(opening.path(), "room.glb");
    opening.sceneCame();
    EXPECT_EQ(opening.middle({.scene = true, .time = 8}), Middle{});
    EXPECT_EQ(opening.path(), "");
}

TEST(Middle, OverASceneTheProgressShowsOnceItTakesLong) {
    Opening opening;
    opening.begin("town.glb", 10);
    EXPECT_EQ(opening.middle({.scene = true, .loading = true, .time = 10 + 0.9 * Opening::kPatience}),
              Middle{});
    EXPECT_EQ(opening.middle({.scene = true, .loading = true, .time = 10 + Opening::kPatience}),
              (Middle{false, Card::Opening}));
}

TEST(Middle, ASceneThatIsReadAnewShowsNoCard) {
    const Opening opening;
    EXPECT_EQ(opening.middle({.scene = true, .loading = true, .time = 100}), Middle{});
}

TEST(Middle, ASceneThatCannotBeDrawnIsToldWhereItWouldBeSeen) {
    Opening opening;
    const Facts facts{.scene = true, .time = 2};
    opening.begin("/levels/big.glb", 0);
    opening.sceneCame(); // it was read
    opening.fail({"/levels/big.glb", "/levels/big.glb: cannot be drawn: no memory", true});
    EXPECT_EQ(opening.middle(facts), (Middle{false, Card::Failure}));
    EXPECT_EQ(middleName(opening.middle(facts)), "failure over scene");
    EXPECT_TRUE(opening.putAway(facts));
    EXPECT_EQ(opening.middle(facts), Middle{}) << "it is baked behind the card";
}

TEST(Middle, AFailureStandsOverTheSceneOrTheStartPageUntilItIsPutAway) {
    for (const bool scene : {false, true}) {
        Opening opening;
        const Facts facts{.scene = scene, .time = 1};
        opening.begin(kFailure.path, 0);
        opening.fail(kFailure);
        EXPECT_EQ(opening.middle(facts), (Middle{!scene, Card::Failure}));
        ASSERT_TRUE(opening.failure());
        EXPECT_EQ(opening.failure()->message, kFailure.message);
        EXPECT_TRUE(opening.putAway(facts));
        EXPECT_EQ(opening.middle(facts), (Middle{!scene, Card::None}));
        EXPECT_FALSE(opening.putAway(facts));
    }
}

TEST(Middle, AnotherFileTakesTheFailureAway) {
    Opening opening;
    opening.fail(kFailure);
    opening.begin("good.glb", 0);
    EXPECT_EQ(opening.middle({.loading = true}), (Middle{false, Card::Opening}));
    EXPECT_FALSE(opening.failure());
    opening.fail(kFailure);
    opening.wantStart();
    EXPECT_EQ(opening.middle({.scene = true}), (Middle{true, Card::None}))
        << "its button leads to recent files";
}

TEST(Middle, AFailureOutlastsASceneThatIsReadAnew) {
    Opening opening;
    opening.fail(kFailure);
    EXPECT_EQ(opening.middle({.scene = true, .loading = true, .time = 9}), (Middle{false, Card::Failure}));
}

TEST(Middle, TheStartPageComesOverASceneAndGoes) {
    Opening opening;
    const Facts facts{.scene = true, .notice = "all is hidden"};
    opening.wantStart();
    EXPECT_EQ(opening.middle(facts), (Middle{true, Card::None})) << "a notice is about the picture behind it";
    EXPECT_TRUE(opening.putAway(facts));
    EXPECT_EQ(opening.middle(facts), (Middle{false, Card::Notice}));
    opening.wantStart();
    opening.begin("other.glb", 0);
    EXPECT_FALSE(opening.middle({.scene = true, .loading = true}).startPage) << "a file was chosen";
}

TEST(Middle, ANoticeThatWasPutAwayComesBackWithAnotherText) {
    Opening opening;
    const Facts hidden{.scene = true, .notice = "all is hidden"},
        failed{.scene = true, .notice = "no device"};
    EXPECT_EQ(opening.middle(hidden).card, Card::Notice);
    EXPECT_TRUE(opening.putAway(hidden));
    EXPECT_EQ(opening.middle(hidden).card, Card::None);
    EXPECT_EQ(opening.middle(failed).card, Card::Notice);
    opening.sceneCame();
    EXPECT_EQ(opening.middle(hidden).card, Card::Notice) << "it is another scene";
}

TEST(Middle, IsToldByName) {
    EXPECT_EQ(middleName({}), "scene");
    EXPECT_EQ(middleName({true, Card::None}), "start page");
    EXPECT_EQ(middleName({false, Card::Opening}), "opening over scene");
    EXPECT_EQ(middleName({true, Card::Failure}), "failure over start page");
    EXPECT_EQ(middleName({false, Card::Notice}), "notice over scene");
}

TEST(Middle, ALoadIsToldInWords) {
    EXPECT_EQ(loadingWords(""), "Reading the file") << "nothing was told yet";
    EXPECT_EQ(loadingWords("loading"), "Reading the file");
    EXPECT_EQ(loadingWords("unwrapping"), "Making lightmap UVs");
    EXPECT_EQ(loadingWords("what is not known"), "what is not known");
}

TEST(TabOrder, GoesRound) {
    EXPECT_EQ(ui::tabStop(-1, 1, 3), 0) << "the first, where none has the focus";
    EXPECT_EQ(ui::tabStop(-1, -1, 3), 2);
    EXPECT_EQ(ui::tabStop(0, 1, 3), 1);
    EXPECT_EQ(ui::tabStop(2, 1, 3), 0);
    EXPECT_EQ(ui::tabStop(0, -1, 3), 2);
    EXPECT_EQ(ui::tabStop(1, -7, 3), 0);
    EXPECT_EQ(ui::tabStop(1, 8, 3), 0);
    EXPECT_EQ(ui::tabStop(-1, 1, 0), -1) << "there is none";
}

PictureFacts seen() {
    return {.phase = BakeStatus::Phase::Baking, .objects = 3, .hidden = 1, .map = true};
}

TEST(PictureNotice, SaysNothingWhereThereIsSomethingToSee) {
    EXPECT_FALSE(pictureNotice(seen()));
    PictureFacts facts = seen();
    facts.map = false; // the scene is seen without light meanwhile
    EXPECT_FALSE(pictureNotice(facts));
    facts.hidden = 2;
    EXPECT_FALSE(pictureNotice(facts));
}

TEST(PictureNotice, ABakeThatCannotStartSaysWhy) {
    PictureFacts facts = seen();
    facts.phase = BakeStatus::Phase::Failed;
    facts.doing = "no Vulkan device: install a driver";
    ASSERT_TRUE(pictureNotice(facts));
    EXPECT_EQ(pictureNotice(facts)->text, facts.doing);
    EXPECT_FALSE(pictureNotice(facts)->mend);
}

TEST(PictureNotice, WhatIsHiddenCanBeShown) {
    PictureFacts facts = seen();
    facts.hidden = facts.objects;
    ASSERT_TRUE(pictureNotice(facts));
    EXPECT_EQ(pictureNotice(facts)->mend, Action::ShowObjects);
    facts.objects = facts.hidden = 0;
    ASSERT_TRUE(pictureNotice(facts));
    EXPECT_FALSE(pictureNotice(facts)->mend) << "there is nothing that could be shown";
    facts.flat = true;
    EXPECT_FALSE(pictureNotice(facts)) << "the lightmap is shown instead";
}

TEST(PictureNotice, AFlatPictureWaitsForALightmap) {
    PictureFacts facts = seen();
    facts.flat = true;
    EXPECT_FALSE(pictureNotice(facts));
    facts.map = false;
    ASSERT_TRUE(pictureNotice(facts));
    EXPECT_EQ(pictureNotice(facts)->mend, Action::UvTexture);
}

} // namespace
} // namespace relume
