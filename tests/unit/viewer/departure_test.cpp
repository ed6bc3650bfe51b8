// These tests say what becomes of the scene on screen when another one, or the end, is wanted.
#include "app/viewer/state/departure.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

using Answer = Departure::Answer;
using Closing = Departure::Closing;
using Goal = Departure::Goal;

const Goal kOther{"other.glb"}, kThird{"third.glb"}, kEnd{};

TEST(Departure, GoesAtOnceWhereNothingWouldBeLost) {
    Departure departure;
    EXPECT_EQ(departure.want(kOther, false), kOther);
    EXPECT_EQ(departure.closing(true), Closing::Asks) << "another scene is not the end";
    EXPECT_EQ(departure.want(kEnd, false), kEnd);
    EXPECT_EQ(departure.closing(true), Closing::Ends);
}

TEST(Departure, AWindowThatIsClosedAsksFirst) {
    const Departure departure;
    EXPECT_EQ(departure.closing(true), Closing::Asks);
    EXPECT_EQ(departure.closing(false), Closing::Ends);
}

TEST(Departure, CancelForgetsWhatWasWanted) {
    Departure departure;
    EXPECT_EQ(departure.want(kEnd, true), std::nullopt);
    EXPECT_EQ(departure.answer(Answer::Cancel), std::nullopt);
    EXPECT_EQ(departure.answer(Answer::Discard), std::nullopt) << "nothing is asked any more";
    EXPECT_EQ(departure.followSave(false, false), std::nullopt);
    EXPECT_EQ(departure.closing(true), Closing::Asks);
}

TEST(Departure, DiscardGoesAtOnce) {
    Departure departure;
    EXPECT_EQ(departure.want(kOther, true), std::nullopt);
    EXPECT_EQ(departure.answer(Answer::Discard), kOther);
    EXPECT_EQ(departure.want(kEnd, true), std::nullopt);
    EXPECT_EQ(departure.answer(Answer::Discard), kEnd);
    EXPECT_EQ(departure.closing(true), Closing::Ends) << "the edits are not wanted";
}

TEST(Departure, SaveGoesOnceTheSaveIsDone) {
    Departure departure;
    EXPECT_EQ(departure.want(kEnd, true), std::nullopt);
    EXPECT_EQ(departure.answer(Answer::Save), std::nullopt);
    EXPECT_EQ(departure.followSave(true, true), std::nullopt);
    EXPECT_EQ(departure.closing(true), Closing::Asks);
    EXPECT_EQ(departure.followSave(false, false), kEnd);
    EXPECT_EQ(departure.closing(true), Closing::Ends);
    EXPECT_EQ(departure.followSave(false, false), std::nullopt) << "it goes once";
}

TEST(Departure, ASaveThatWentWrongKeepsTheScene) {
    Departure departure;
    EXPECT_EQ(departure.want(kOther, true), std::nullopt);
    EXPECT_EQ(departure.answer(Answer::Save), std::nullopt);
    EXPECT_EQ(departure.followSave(false, true), std::nullopt) << "the edits are still there";
    EXPECT_EQ(departure.followSave(false, false), std::nullopt) << "a later save is none of its own";
}

TEST(Departure, AChoiceOfTheFileIsAGoalLikeOthers) {
    Departure departure;
    const Goal night{.scene = "file.glb", .choice = GltfChoice{.scene = "night", .variant = {}, .time = {}}};
    EXPECT_EQ(departure.want(night, false), night);
    EXPECT_EQ(departure.want(night, true), std::nullopt) << "edits are asked about";
    const std::optional<Goal> reached = departure.answer(Answer::Discard);
    ASSERT_TRUE(reached && reached->choice);
    EXPECT_EQ(reached->choice->scene, "night");
    EXPECT_EQ(departure.closing(true), Closing::Asks);
}

TEST(Departure, TheNewestWishCounts) {
    Departure departure;
    EXPECT_EQ(departure.want(kOther, true), std::nullopt);
    EXPECT_EQ(departure.want(kThird, true), std::nullopt);
    EXPECT_EQ(departure.answer(Answer::Save), std::nullopt);
    EXPECT_EQ(departure.want(kEnd, true), std::nullopt) << "while it saves";
    EXPECT_EQ(departure.answer(Answer::Save), std::nullopt);
    EXPECT_EQ(departure.followSave(false, false), kEnd);
    EXPECT_EQ(departure.followSave(false, false), std::nullopt);
}

} // namespace
} // namespace relume
