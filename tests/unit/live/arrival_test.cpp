// These tests say when a scene that was read takes the place of one that is edited.
#include "app/live/arrival.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

using Step = Arrival::Step;

TEST(Arrival, ASceneComesWhereNothingWasEditedSince) {
    Arrival arrival;
    arrival.ask(7);
    EXPECT_EQ(arrival.decide(7, true), Step::Comes) << "the user was asked about these edits before";
    EXPECT_EQ(arrival.decide(8, false), Step::Comes) << "taken back, or saved";
    EXPECT_FALSE(arrival.waits());
}

TEST(Arrival, ASceneWaitsForTheAnswerWhereEditsWouldBeLost) {
    for (const bool comes : {true, false}) {
        Arrival arrival;
        arrival.ask(7);
        EXPECT_EQ(arrival.decide(8, true), Step::Waits);
        EXPECT_TRUE(arrival.waits());
        arrival.answer(comes);
        EXPECT_FALSE(arrival.waits());
        EXPECT_EQ(arrival.decide(8, true), comes ? Step::Comes : Step::IsRefused);
    }
}

TEST(Arrival, ASaveOfTheEditsLetsItCome) {
    Arrival arrival;
    arrival.ask(7);
    EXPECT_EQ(arrival.decide(8, true), Step::Waits);
    EXPECT_EQ(arrival.decide(8, false), Step::Comes);
    EXPECT_FALSE(arrival.waits());
}

TEST(Arrival, TheNextSceneIsAskedAboutAnew) {
    Arrival arrival;
    arrival.ask(7);
    EXPECT_EQ(arrival.decide(8, true), Step::Waits);
    arrival.answer(true);
    arrival.ask(8);
    EXPECT_EQ(arrival.decide(9, true), Step::Waits);
}

} // namespace
} // namespace relume
