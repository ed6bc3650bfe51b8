#include "app/viewer/state/bake_badge.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

using State = BakeBadge::State;
using Phase = BakeStatus::Phase;

class Badge : public testing::Test {
protected:
    Badge() {
        status_.phase = Phase::Baking;
        status_.bake = 3;
        status_.progress.error = 0.05;
        map_.bake = 3;
        map_.complete = true;
    }
    BakeBadge of(uint64_t newest = 3) const {
        return bakeBadge(
            {.status = status_, .map = shown_, .newestBake = newest, .edit = "Move Lamp", .seconds = 2.04});
    }

    BakeStatus status_;
    PublishedMap map_;
    const PublishedMap* shown_ = &map_;
};

TEST_F(Badge, LightOfBeforeAnEditIsStale) {
    EXPECT_EQ(of(4).state, State::Stale) << "the bake has not begun with it";
    EXPECT_EQ(of(4).text, "stale: Move Lamp, 2.0 s");
    status_.bake = 4;
    EXPECT_EQ(of(4).state, State::Stale) << "what is shown is of before";
    map_.bake = 4;
    EXPECT_EQ(of(4).state, State::Refining);
    status_.phase = Phase::Preparing;
    EXPECT_EQ(of(4).state, State::Stale);
    status_.phase = Phase::Baking;
    shown_ = nullptr;
    EXPECT_EQ(of(4).state, State::Stale);
}

TEST_F(Badge, SaysWhichLightsAreStale) {
    status_.stale = {"light 'Lamp' moved"};
    EXPECT_EQ(of().state, State::Stale) << "the bake knows of the edit, the picture shows it not";
    EXPECT_EQ(of().text, "stale: light 'Lamp' moved, 2.0 s");
    EXPECT_EQ(of(4).text, "stale: Move Lamp, 2.0 s") << "of an edit before that one";
    status_.stale.insert(status_.stale.end(), 2, "light 'Spot' has another form");
    EXPECT_EQ(of().text, "stale: light 'Lamp' moved and 2 more, 2.0 s");
    const BakeBadge first =
        bakeBadge({.status = status_, .map = shown_, .newestBake = 3, .edit = "", .seconds = 2.04});
    EXPECT_EQ(first.state, State::Refining) << "a scene that was just opened";
}

TEST_F(Badge, TellsErrorAndTime) {
    EXPECT_EQ(of().text, "refining, error 0.05, 2.0 s");
    status_.progress.localError95 = 0.083;
    EXPECT_EQ(of().text, "refining, error 0.05, local 0.083, 2.0 s");
    status_.progress.error = 1.0; // not known yet
    EXPECT_EQ(of().text, "refining, 2.0 s");
    status_.phase = Phase::Paused;
    EXPECT_EQ(of().text, "paused, 2.0 s");
}

TEST_F(Badge, OnlyACompleteMapOfADoneBakeHasConverged) {
    status_.phase = Phase::Done;
    EXPECT_EQ(of().text, "converged, error 0.05, 2.0 s");
    map_.complete = false;
    EXPECT_EQ(of().state, State::Refining);
}

TEST_F(Badge, WithoutABakeThereIsNone) {
    status_.phase = Phase::Failed;
    EXPECT_EQ(of().state, State::None);
    EXPECT_EQ(of().text, "");
    status_.phase = Phase::Done;
    EXPECT_EQ(of(0).state, State::None);
}

} // namespace
} // namespace relume
