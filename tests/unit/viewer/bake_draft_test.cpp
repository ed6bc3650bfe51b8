// These tests say what becomes of settings that wait in the Bake panel.
#include "app/viewer/state/bake_draft.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

constexpr uint64_t kFirstScene = 1, kNextScene = 2;
constexpr uint32_t kGoodSize = 64, kBadSize = 4; // sizes of a lightmap [texels]

Document documentOf(size_t lights) {
    Document document;
    document.bake.size = 2 * kGoodSize;
    document.edits.lights.resize(lights);
    return document;
}

TEST(BakeDraft, WhatWaitsTakesNoEditBack) {
    BakeDraft draft;
    Document document = documentOf(0);
    draft.follow(document, kFirstScene, false);
    draft.bake.size = kBadSize;
    EXPECT_FALSE(draft.settle(document));
    EXPECT_TRUE(draft.waits());
    EXPECT_FALSE(draft.problem().empty());
    document = documentOf(1); // a light is added meanwhile
    document.mix.muted = {{LightKey::Kind::Lamp, 0, 0}};
    draft.follow(document, kFirstScene, false);
    EXPECT_EQ(draft.bake.size, kBadSize) << "it is typed on";
    draft.bake.size = kGoodSize;
    const std::optional<Document> next = draft.settle(document);
    ASSERT_TRUE(next);
    EXPECT_FALSE(draft.waits());
    EXPECT_EQ(next->bake.size, kGoodSize);
    EXPECT_EQ(next->edits.lights.size(), 1u);
    EXPECT_EQ(next->mix, document.mix);
}

TEST(BakeDraft, FollowsTheDocumentUnlessAControlIsHeld) {
    BakeDraft draft;
    Document document = documentOf(0);
    draft.follow(document, kFirstScene, false);
    EXPECT_EQ(draft.bake.size, document.bake.size);
    document.bake.size = kGoodSize;
    document.lightmap.dilate = 7;
    draft.follow(document, kFirstScene, true);
    EXPECT_NE(draft.bake.size, kGoodSize);
    draft.follow(document, kFirstScene, false);
    EXPECT_EQ(draft.bake.size, kGoodSize);
    EXPECT_EQ(draft.lightmap.dilate, 7u);
}

TEST(BakeDraft, AnotherSceneHasSettingsOfItsOwn) {
    BakeDraft draft;
    draft.follow(documentOf(0), kFirstScene, false);
    draft.bake.size = kBadSize;
    EXPECT_FALSE(draft.settle(documentOf(0)));
    Document other = documentOf(3);
    other.bake.size = kGoodSize;
    draft.follow(other, kNextScene, true);
    EXPECT_FALSE(draft.waits());
    EXPECT_EQ(draft.bake.size, kGoodSize);
}

TEST(BakeDraft, WhatWaitsIsGivenUp) {
    BakeDraft draft;
    draft.follow(documentOf(0), kFirstScene, false);
    draft.bake.size = kBadSize;
    EXPECT_FALSE(draft.settle(documentOf(0)));
    draft.drop();
    draft.follow(documentOf(0), kFirstScene, false);
    EXPECT_EQ(draft.bake.size, documentOf(0).bake.size);
}

} // namespace
} // namespace relume
