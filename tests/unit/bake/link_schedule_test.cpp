// What a link solver does next, as a pure function of its state.
#include "bake/links/link_schedule.h"

#include "bake/gather/sample_plan.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

constexpr LinkRules kRules{.hybrid = true,
                           .hasDirect = true,
                           .linksOfSamplePass = 16,
                           .error = 0.01,
                           .directCost = 4,
                           .linkCost = 16};

LinkRules with(void (*change)(LinkRules&)) {
    LinkRules rules = kRules;
    change(rules);
    return rules;
}

LinkState after(uint32_t direct, uint32_t links) {
    LinkState state;
    state.directSamplePasses = state.directAtCheck = direct;
    state.linkSamplePasses = state.linksAtCheck = links;
    return state;
}

} // namespace

TEST(LinkSchedule, DirectLightComesFirstThenLinks) {
    const LinkSchedule schedule(kRules);
    EXPECT_TRUE(schedule.wantsDirect(after(0, 0)));
    EXPECT_FALSE(schedule.wantsDirect(after(1, 0)));
}

TEST(LinkSchedule, WhereNothingShinesDirectlyThereAreLinksAlone) {
    const LinkSchedule schedule(with([](LinkRules& r) { r.hasDirect = false; }));
    EXPECT_FALSE(schedule.wantsDirect(after(0, 0)));
    EXPECT_FALSE(schedule.wantsDirect(after(0, 5)));
}

// One more sample pass takes v n / m^2 of a variance v that n of them left, m being those by now: 4 of 16 for
// a quarter of the cost outweighs 8 of 32 at equal sample passes, and no longer once direct light has had
// more.
TEST(LinkSchedule, ThenComesWhatLowersTheVarianceMoreForItsCost) {
    const LinkSchedule schedule(kRules);
    LinkState state = after(4, 4);
    state.directChoice = 4;
    state.linkChoice = 8;
    EXPECT_TRUE(schedule.wantsDirect(state)); // 4 / (4 * 4) > 8 / (4 * 16)
    state.directChoice = 1.9;
    EXPECT_FALSE(schedule.wantsDirect(state)); // 1.9 / 16 < 8 / 64
    state.directChoice = 4;
    state.directSamplePasses = 6;
    EXPECT_FALSE(schedule.wantsDirect(state)); // 4 * 4 / (36 * 4) < 8 / 64
    state.linkSamplePasses = 8;
    EXPECT_TRUE(schedule.wantsDirect(state)); // 8 * 4 / (64 * 16)
}

// The variances are of the error that is farther off what is asked for, each relative to that.
TEST(LinkSchedule, GoesByTheErrorThatIsFartherOff) {
    const LinkSchedule both(with([](LinkRules& r) { r.localError = 0.05; }));
    EXPECT_TRUE(both.choosesLocally(0.02, 0.2));
    EXPECT_FALSE(both.choosesLocally(0.02, 0.09));
    EXPECT_FALSE(LinkSchedule(kRules).choosesLocally(0.02, 0.2)) << "any local error will do";
    const LinkSchedule local(with([](LinkRules& r) {
        r.error = 0;
        r.localError = 0.05;
    }));
    EXPECT_TRUE(local.choosesLocally(0.02, 0.01));
}

// Apart, direct light comes by plans: with checks and where the sample passes of links are on the ladder.
TEST(LinkSchedule, DirectLightOfChunksIsPlannedNowAndThen) {
    const LinkSchedule schedule(with([](LinkRules& r) { r.directApart = true; }));
    EXPECT_TRUE(schedule.plansApart());
    EXPECT_FALSE(LinkSchedule(kRules).plansApart());
    LinkState state = after(4, 4);
    state.apart.on = true;
    state.directChoice = 100;
    state.linkChoice = 8;
    EXPECT_FALSE(schedule.wantsDirect(state)) << "not of all chunks";
    state.apart.planned = 4;
    EXPECT_FALSE(schedule.plansDirect(state)) << "the check has done so";
    state.linkSamplePasses = 5;
    EXPECT_FALSE(schedule.plansDirect(state));
    state.linkSamplePasses = 6;
    EXPECT_TRUE(schedule.plansDirect(state)) << "on the ladder";
}

// A texel that touches a lamp needs more samples than others may have; a number of them that was asked for
// holds for everyone.
TEST(LinkSchedule, ChunksMayHaveMoreDirectLightThanLinks) {
    const LinkRules apart = with([](LinkRules& r) { r.directApart = true; });
    const LinkSchedule schedule(apart);
    EXPECT_EQ(schedule.samplePassesWanted(), kMaxSamplesOfPatch / 16);
    EXPECT_EQ(schedule.directRules(after(64, 64)).most, kMaxDirectSamplePasses);
    EXPECT_GE(kMaxDirectSamplePasses, 16 * schedule.samplePassesWanted());
    LinkRules few = apart;
    few.samples = 256;
    EXPECT_EQ(LinkSchedule(few).directRules(after(4, 4)).most, 16u);
}

// A quarter of two variances of 8 may be left, 4: links that fall to a ninth leave 8 / 9 of that.
TEST(LinkSchedule, DirectLightMayLeaveWhatLinksDoNot) {
    const LinkSchedule schedule(with([](LinkRules& r) { r.localError = 0.05; }));
    LinkState state = after(4, 4);
    state.directChoice = state.linkChoice = 8;
    EXPECT_NEAR(schedule.directShare(state, 2.0, 0.15), (4 - 8 / 9.0) / 8, 1e-12) << "links fall to a ninth";
    EXPECT_NEAR(schedule.directShare(state, 2.0, 0.05), 0.25, 1e-12) << "both fall alike";
    state.directChoice = 0;
    EXPECT_EQ(schedule.directShare(state, 2.0, 0.15), 1.0);
}

// Links read direct light, and what is wrong with that no replicate tells: it gets better now and then even
// where its own error is nothing.
TEST(LinkSchedule, LinksNeverReadTheDirectLightOfFewSamplesForLong) {
    const LinkSchedule schedule(kRules);
    LinkState state = after(1, 63);
    state.linkChoice = 8;
    EXPECT_FALSE(schedule.wantsDirect(state));
    state.linkSamplePasses = 64;
    EXPECT_TRUE(schedule.wantsDirect(state));
    state.directSamplePasses = 2;
    EXPECT_FALSE(schedule.wantsDirect(state));
}

TEST(LinkSchedule, WithANumberOfSamplesBothTakeTurns) {
    const LinkSchedule schedule(with([](LinkRules& r) { r.samples = 64; }));
    EXPECT_EQ(schedule.samplePassesWanted(), 4u);
    EXPECT_FALSE(schedule.wantsDirect(after(1, 0)));
    EXPECT_TRUE(schedule.wantsDirect(after(1, 1)));
    EXPECT_FALSE(schedule.wantsDirect(after(2, 1)));
    EXPECT_TRUE(schedule.wantsDirect(after(3, 4))) << "links are done";
    EXPECT_FALSE(schedule.isDone(after(3, 4)));
    EXPECT_TRUE(schedule.isDone(after(4, 4)));
}

TEST(LinkSchedule, SamplePassesHoldWholeNumbersOfDirections) {
    EXPECT_EQ(LinkSchedule(with([](LinkRules& r) { r.samples = 33; })).samplePassesWanted(), 3u);
    EXPECT_EQ(LinkSchedule(kRules).samplePassesWanted(), 4096u) << "65536 in all";
}

TEST(LinkSchedule, OfOnePassHybridHasDirectLightAlone) {
    const LinkSchedule hybrid(with([](LinkRules& r) { r.passes = 1; }));
    EXPECT_TRUE(hybrid.directAlone());
    EXPECT_TRUE(hybrid.hasSolution(after(1, 0)));
    EXPECT_TRUE(hybrid.wantsDirect(after(5, 0)));
    EXPECT_TRUE(hybrid.isDone(after(4096, 0)));
    const LinkSchedule directional(with([](LinkRules& r) { r.passes = 1, r.hybrid = false; }));
    EXPECT_FALSE(directional.directAlone());
    EXPECT_FALSE(directional.hasSolution(after(1, 0)));
    EXPECT_TRUE(directional.hasSolution(after(1, 1)));
}

TEST(LinkSchedule, NothingIsShownBeforeWhatIsSeenHasLight) {
    using Stage = LinkState::Stage;
    LinkState state = after(0, 0);
    EXPECT_FALSE(LinkSchedule::hasFirstLight(state, true)) << "nothing has begun";
    for (const Stage stage : {Stage::Direct, Stage::Links}) {
        state.stage = stage;
        EXPECT_FALSE(LinkSchedule::hasFirstLight(state, false));
        EXPECT_TRUE(LinkSchedule::hasFirstLight(state, true));
    }
    state.bounce = 1; // all patches have the first one
    EXPECT_TRUE(LinkSchedule::hasFirstLight(state, false));
    EXPECT_TRUE(LinkSchedule::hasFirstLight(after(1, 0), false));
}

TEST(LinkSchedule, BouncesAreCountedOrFollowedUntilTheyHaveConverged) {
    LinkState state = after(1, 0);
    const LinkSchedule converging(kRules);
    EXPECT_FALSE(converging.isLastBounce(state));
    EXPECT_TRUE(converging.converges(state));
    state.last = true; // of the sample pass before
    EXPECT_FALSE(converging.isLastBounce(state)) << "a new sample pass begins";
    state.bounce = 3;
    EXPECT_TRUE(converging.isLastBounce(state));
    EXPECT_TRUE(converging.isLastBounce(after(1, 1))) << "later sample passes need one";

    const LinkSchedule hybrid(with([](LinkRules& r) { r.passes = 3; })); // one is direct light
    state = after(1, 2);
    EXPECT_FALSE(hybrid.isLastBounce(state));
    EXPECT_FALSE(hybrid.converges(after(1, 0)));
    state.bounce = 1;
    EXPECT_TRUE(hybrid.isLastBounce(state));
    const LinkSchedule directional(with([](LinkRules& r) { r.passes = 3, r.hybrid = false; }));
    EXPECT_FALSE(directional.isLastBounce(state));
}

TEST(LinkSchedule, BouncesHaveConvergedAtAShareOfTheErrorOrAtTheLimit) {
    const LinkSchedule schedule(kRules);
    LinkState state = after(1, 0);
    state.series.localError = kLocalIterationAim;
    state.series.error = 0.00021;
    EXPECT_FALSE(schedule.hasConverged(state));
    state.series.error = 0.00019;
    EXPECT_TRUE(schedule.hasConverged(state));
    state.series.localError = 1.01 * kLocalIterationAim;
    EXPECT_FALSE(schedule.hasConverged(state)) << "of patches' own light more is to come";
    state.series.localError = 0;
    const LinkSchedule exact(with([](LinkRules& r) { r.error = 0; }));
    EXPECT_FALSE(exact.hasConverged(state));
    state.series.error = 0.00009;
    EXPECT_TRUE(exact.hasConverged(state));
    state.series.error = 1;
    state.bounce = kMostBounces - 1;
    EXPECT_TRUE(exact.hasConverged(state));
}

TEST(LinkSchedule, TheErrorIsFoundAgainWhenItMayHaveFallenEnough) {
    const LinkSchedule schedule(kRules);
    EXPECT_FALSE(schedule.wantsCheck(after(0, 0)));
    EXPECT_TRUE(schedule.wantsCheck(after(1, 1)));
    LinkState state = after(50, 50);
    state.directChoice = 0.2; // each takes as much away for its cost
    state.linkChoice = 0.8;
    EXPECT_EQ(schedule.nextCheck(state, 10.0), 200u) << "at twice as many, however far it is";
    EXPECT_EQ(schedule.nextCheck(state, 1.25), 134u) << ".6 of 57 that it still seems to need";
    EXPECT_EQ(schedule.nextCheck(state, 1.005), 101u);
    // Direct light has 0.2 at the check, of which 0.15 are settled apart from what links do.
    state.apart = {.on = true, .settled = 0.15};
    EXPECT_EQ(schedule.nextCheck(state, 1.25), 122u) << ".6 of the 37 of links that it still seems to need";
    EXPECT_EQ(schedule.nextCheck(state, 0.9), 101u) << "what is told is reached: at once, and not before now";
    state.apart = {};
    LinkState uneven = after(4, 96);
    uneven.directChoice = 0.9;
    uneven.linkChoice = 0.1;
    EXPECT_EQ(schedule.nextCheck(uneven, 1.25), 101u) << "two more of direct light take a third of it away";
    state.nextCheck = 101;
    EXPECT_FALSE(schedule.wantsCheck(state));
    state.linkSamplePasses = 51;
    EXPECT_TRUE(schedule.wantsCheck(state));
    EXPECT_FALSE(LinkSchedule(with([](LinkRules& r) { r.error = 0; })).wantsCheck(state));
}

TEST(LinkSchedule, ADirectionStandsForItsShareOfTheWholeResult) {
    EXPECT_EQ(LinkSchedule(kRules).footprintSamples(after(1, 3)), 64u) << "this sample pass included";
    const LinkSchedule counted(with([](LinkRules& r) { r.samples = 100; }));
    EXPECT_EQ(counted.footprintSamples(after(1, 3)), 112u);
}

} // namespace relume
