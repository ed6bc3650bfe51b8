// These tests follow over time how far the light is behind the edits.
#include "app/viewer/state/light_progress.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

class FollowedLight : public testing::Test {
protected:
    FollowedLight() {
        bake(1);
        progress_.sceneCame(10.0);
    }
    void bake(uint64_t number) {
        status_.bake = map_.bake = number;
        status_.phase = BakeStatus::Phase::Baking;
        map_.complete = false;
    }
    void finish() {
        status_.phase = BakeStatus::Phase::Done;
        map_.complete = true;
    }
    bool update(uint64_t newest, double time) { return progress_.update(status_, &map_, newest, time); }
    bool shows(const std::string& text) const {
        return progress_.badge().text.find(text) != std::string::npos;
    }

    BakeStatus status_;
    PublishedMap map_;
    LightProgress progress_;
};

TEST_F(FollowedLight, TellsEachStateOnce) {
    EXPECT_TRUE(update(1, 11.0));
    EXPECT_FALSE(update(1, 12.0));
    EXPECT_TRUE(shows("refining, 2.0 s")) << progress_.badge().text;
    finish();
    EXPECT_TRUE(update(1, 13.0));
    EXPECT_TRUE(progress_.converged());
    EXPECT_FALSE(update(1, 20.0));
    EXPECT_TRUE(shows("3.0 s")) << "its clock stands: " << progress_.badge().text;
}

TEST_F(FollowedLight, AnEditMayBeAnsweredBetweenTwoLooks) {
    finish();
    EXPECT_TRUE(update(1, 11.0));
    progress_.edited("Move Lamp", false, 12.0);
    bake(2);
    finish();
    EXPECT_TRUE(update(2, 12.5)) << "it had converged before, and has again";
    EXPECT_FALSE(update(2, 13.0));
    EXPECT_TRUE(shows("0.5 s")) << progress_.badge().text;
}

TEST_F(FollowedLight, ADragCountsFromItsBeginning) {
    EXPECT_TRUE(update(1, 11.0));
    progress_.edited("Move Lamp", false, 12.0);
    progress_.edited("Move Lamp", true, 14.0);
    EXPECT_TRUE(update(2, 15.0));
    EXPECT_TRUE(shows("Move Lamp, 3.0 s")) << progress_.badge().text;
    progress_.edited("Turn Lamp", false, 15.0);
    EXPECT_FALSE(update(3, 16.0));
    EXPECT_TRUE(shows("Turn Lamp, 1.0 s")) << progress_.badge().text;
}

TEST_F(FollowedLight, AnotherSceneIsNotEdited) {
    progress_.edited("Move Lamp", false, 12.0);
    progress_.sceneCame(20.0);
    EXPECT_TRUE(update(2, 21.0));
    EXPECT_FALSE(shows("Move Lamp")) << progress_.badge().text;
    EXPECT_TRUE(shows("1.0 s")) << progress_.badge().text;
}

} // namespace
} // namespace relume
