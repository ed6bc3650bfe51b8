// What comes next, as LayerSchedule decides on it: which job, of which layer, with which others.
#include "tests/unit/layer_facts.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

ScheduleRules onCpu(ScheduleRules rules) {
    rules.together = false;
    return rules;
}

// Tells which layers come along as "1 3".
std::string companionsOf(const ScheduleRules& rules, const LayerSchedule::Layers& layers, size_t index = 0) {
    const LayerSchedule schedule(rules);
    apportion(rules, layers);
    std::string text;
    for (const size_t i : schedule.companions(layers, index, schedule.targetOf(*layers[index])))
        text += (text.empty() ? "" : " ") + std::to_string(i);
    return text;
}

struct Turn {
    const char* name;
    ScheduleRules rules;
    ScheduleState state;
    const char* step; // with a layer that has converged and one without direct light, which is off
};

ScheduleRules linksOfPass(ScheduleRules rules, uint32_t links) {
    rules.linksOfSamplePass = links;
    return rules;
}

const Turn kTurns[] = {
    {"NothingIsLeft", viewerRules(), Now(), "done"},
    {"NothingIsLeftOffline", offlineRules(), Now(), "done"},
    {"AJobGoesOn", viewerRules(), Now().makingFirstLevel(), "continue"},
    {"ALaterLevelGoesOn", viewerRules(), Now().makingLaterLevel(), "continue"},
    {"TheSumGoesOn", viewerRules(), Now().makingSum(), "continue"},
    {"TheSumGoesOnWhereItIsDueAgain", viewerRules(), Now().makingSum().sumDue(), "continue"},
    {"TheSumIsMade", viewerRules(), Now().sumDue(), "sum"},
    {"TheSumIsMadeAgain", viewerRules(), Now().sumDue().sumShown(), "sum"},
    {"WhatIsShownIsNotMadeAgain", viewerRules(), Now().sumShown(), "done"},
    {"LinksFollow", viewerRules(), Now().relinking(0), "relink"},
    {"LinksOfTheSumFollowFirst", viewerRules(), Now().relinking(3).sumDue(), "relink"},
    {"LinksOfTheSumFollowBesideAJob", viewerRules(), Now().relinking(3).makingFirstLevel(), "relink"},
    {"LinksOfTheSumFollowBesideTheSum", viewerRules(), Now().relinking(0).makingSum(), "relink"},
    {"OtherLinksWaitForTheSum", viewerRules(), Now().relinking(4).sumDue(), "sum"},
    {"OtherLinksWaitForAJob", viewerRules(), Now().relinking(4).makingLaterLevel(), "continue"},
    {"OtherLinksWaitForTheSumUnderWay", viewerRules(), Now().relinking(9).makingSum(), "continue"},
    {"OtherLinksFollowThen", viewerRules(), Now().relinking(4), "relink"},
    {"OtherLinksFollowWhileTheSumIsShown", viewerRules(), Now().relinking(4).sumShown(), "relink"},
    {"OfflineAllLinksFollowFirst", offlineRules(), Now().relinking(4).sumDue(), "relink"},
    {"OfflineAllLinksFollowBesideAJob", offlineRules(), Now().relinking(99).makingFirstLevel(), "relink"},
    {"ASumOfOnePassHasTheFirst", linksOfPass(viewerRules(), 64), Now().relinking(0).sumDue(), "relink"},
    {"ASumOfOnePassNeedsNoOther", linksOfPass(viewerRules(), 64), Now().relinking(1).sumDue(), "sum"},
    {"ASumHasAPassAtLeast", linksOfPass(viewerRules(), 256), Now().relinking(0).sumDue(), "relink"},
};

class NextStep : public testing::TestWithParam<Turn> {};

TEST_P(NextStep, Is) {
    const LayerSchedule::Layers layers =
        layersOf(at(8, 8).converged(), fresh().switchedOff(), lit(2).outdated().switchedOff());
    EXPECT_EQ(stepOf(GetParam().rules, layers, GetParam().state), GetParam().step);
}

INSTANTIATE_TEST_SUITE_P(States, NextStep, testing::ValuesIn(kTurns), CaseName());

TEST(JobsAreDropped, OnlyForTheSum) {
    EXPECT_TRUE(LayerSchedule::drops(Now().sumDue().makingFirstLevel()));
    EXPECT_TRUE(LayerSchedule::drops(Now().sumDue().makingLaterLevel()));
    EXPECT_FALSE(LayerSchedule::drops(Now().makingFirstLevel()));
    EXPECT_FALSE(LayerSchedule::drops(Now().makingLaterLevel().sumShown().notSeen()));
}

TEST(JobsAreDropped, NeverWhereTheyAreTheSumItself) {
    EXPECT_FALSE(LayerSchedule::drops(Now().sumDue().makingSum()));
    EXPECT_FALSE(LayerSchedule::drops(Now().sumDue()));
}

TEST(NextLayer, WithoutLayersNothingIsToDo) {
    EXPECT_EQ(stepOf(viewerRules(), {}), "done");
    EXPECT_EQ(stepOf(offlineRules(), {}), "done");
}

TEST(NextLayer, WhatShowsNothingYetComesFirst) {
    EXPECT_EQ(stepOf(viewerRules(), layersOf(at(2, 2).off(0.9).weighing(100), fresh())), "layer 1 to 2+2");
    EXPECT_EQ(stepOf(onCpu(offlineRules()), layersOf(at(2, 2).off(0.9).weighing(100), fresh())),
              "layer 1 to 2+2");
}

TEST(NextLayer, OfThoseTheFirstInOrder) {
    EXPECT_EQ(stepOf(viewerRules(), layersOf(at(2, 2), fresh(), fresh().weighing(9))), "layer 1 to 2+2");
}

TEST(NextLayer, WhatIsOffIsNotMade) {
    EXPECT_EQ(stepOf(viewerRules(), layersOf(fresh().switchedOff(), fresh())), "layer 1 to 2+2");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(at(2, 2).off(0.9).switchedOff(), at(8, 8).converged())), "done");
    EXPECT_EQ(stepOf(offlineRules(), layersOf(fresh().switchedOff())), "done");
}

TEST(NextLayer, ADarkGroupIsNotMade) {
    EXPECT_EQ(stepOf(viewerRules(), layersOf(fresh().group().switchedOff())), "done");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(fresh().group().switchedOff(), at(8, 8).converged()),
                     Now().sumShown()),
              "done");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(fresh().group())), "layer 0 to 2+2");
}

TEST(NextLayer, OneColourIsEnoughToShine) {
    for (const glm::vec3 weight : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)})
        EXPECT_EQ(stepOf(viewerRules(), layersOf(fresh().weighing(weight))), "layer 0 to 2+2");
}

TEST(NextLayer, WhatHasConvergedStays) {
    EXPECT_EQ(stepOf(onCpu(viewerRules()), layersOf(at(2, 2).off(0.9).converged(), at(2, 2).noise(1, 0))),
              "layer 1 to 16+2");
}

TEST(NextLayer, TheWorstComesNext) {
    const ScheduleRules rules = onCpu(offlineRules());
    EXPECT_EQ(stepOf(rules, layersOf(at(2, 2).off(0.02), at(4, 4).off(0.03), at(6, 6).off(0.025))),
              "layer 1 to 32+24");
    EXPECT_EQ(stepOf(rules, layersOf(at(2, 2).off(0.04), at(4, 4).off(0.03))).substr(0, 7), "layer 0");
}

TEST(NextLayer, OfTheWeightTheStrongestColourCounts) {
    const ScheduleRules rules = onCpu(offlineRules());
    EXPECT_EQ(stepOf(rules, layersOf(at(2, 2), at(2, 2).weighing(1.5f))).substr(0, 7), "layer 1");
    EXPECT_EQ(stepOf(rules, layersOf(at(2, 2), at(2, 2).weighing({0.5f, 0.5f, 1.2f}))).substr(0, 7),
              "layer 1");
    EXPECT_EQ(stepOf(rules, layersOf(at(2, 2), at(2, 2).weighing({0.9f, 0.9f, 0.9f}))).substr(0, 7),
              "layer 0");
}

TEST(NextLayer, TheLightThatItBringsCounts) {
    const ScheduleRules rules = onCpu(offlineRules());
    EXPECT_EQ(stepOf(rules, layersOf(at(2, 2), at(2, 2).shedding(2))).substr(0, 7), "layer 1");
    EXPECT_EQ(stepOf(rules, layersOf(at(2, 2).off(0.05), at(2, 2).off(0.02).shedding(2))).substr(0, 7),
              "layer 0");
}

TEST(NextLayer, OfEqualOnesTheFirst) {
    EXPECT_EQ(stepOf(onCpu(offlineRules()), layersOf(at(2, 2), at(2, 2))).substr(0, 7), "layer 0");
}

TEST(NextLayer, WhatAddsNothingIsFinishedTooLast) {
    EXPECT_EQ(stepOf(onCpu(offlineRules()), layersOf(at(2, 2).shedding(0), at(2, 2))).substr(0, 7),
              "layer 1");
    EXPECT_EQ(stepOf(onCpu(offlineRules()), layersOf(at(2, 2).shedding(0))).substr(0, 7), "layer 0");
}

TEST(NextLayer, WhatComesBackHasItsLevel) {
    EXPECT_EQ(stepOf(viewerRules(), layersOf(lit(16).redo({16, 8}))), "layer 0 to 16+8");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(fresh().redo({16, 8}, {2, 16}))), "layer 0 to 2+2");
}

TEST(Companions, AreThoseThatWantAsManyLinks) {
    EXPECT_EQ(companionsOf(offlineRules(), layersOf(fresh(), lit(2), fresh())), "1 2");
    EXPECT_EQ(companionsOf(offlineRules(), layersOf(fresh(), lit(2), fresh()), 1), "0 2");
    EXPECT_EQ(companionsOf(offlineRules(),
                           layersOf(at(2, 2).noise(0, 1), at(4, 2).noise(0, 1), at(2, 4).noise(0, 1))),
              "1");
}

TEST(Companions, NeedNotWantAsMuchDirectLight) {
    EXPECT_EQ(companionsOf(offlineRules(), layersOf(lit(16).redo({16, 8}), fresh().redo({4, 8}))), "1");
}

TEST(Companions, OnTheCpuThereAreNone) {
    EXPECT_EQ(companionsOf(onCpu(offlineRules()), layersOf(fresh(), fresh())), "");
    EXPECT_EQ(companionsOf(onCpu(viewerRules()), layersOf(fresh(), fresh())), "");
}

TEST(Companions, InAViewerThereAreSomeToo) {
    EXPECT_EQ(companionsOf(viewerRules(), layersOf(fresh(), fresh())), "1");
}

TEST(Companions, NoneThatHasConverged) {
    EXPECT_EQ(companionsOf(offlineRules(), layersOf(lit(16).redo({16, 8}), lit(2).redo({16, 8}).converged())),
              "");
}

TEST(Companions, NoneWhoseDirectLightIsDirty) {
    EXPECT_EQ(companionsOf(offlineRules(),
                           layersOf(fresh(), lit(2).outdated(), lit(2).beside(), lit(2).begun(), fresh())),
              "4");
}

TEST(Companions, NoneThatIsOff) {
    EXPECT_EQ(companionsOf(offlineRules(), layersOf(fresh(), fresh().switchedOff(), fresh())), "2");
}

TEST(Companions, ADarkGroupIsNoneButAGroupThatShinesIs) {
    EXPECT_EQ(companionsOf(offlineRules(), layersOf(fresh(), fresh().group().switchedOff(), fresh().group())),
              "2");
}

TEST(Companions, HastyOnesAreWithHastyOnes) {
    const auto layers = [] { return layersOf(fresh(), lit(8).redo({8, 2}), fresh(), lit(4).redo({4, 2})); };
    EXPECT_EQ(companionsOf(offlineRules(), layers(), 0), "2");
    EXPECT_EQ(companionsOf(offlineRules(), layers(), 1), "3");
}

TEST(Companions, AreMoreThanLanesSoThatThoseThatAreReadyCanBeChosen) {
    EXPECT_EQ(companionsOf(offlineRules(), layersOf(fresh(), fresh(), fresh(), fresh(), fresh(), fresh(),
                                                    fresh(), fresh(), fresh(), fresh())),
              "1 2 3 4 5 6 7 8 9");
}

TEST(DirectLightFirst, OfAllThatBounceTogether) {
    EXPECT_EQ(stepOf(offlineRules(), layersOf(fresh(), fresh(), fresh())), "direct light of 0 to 2+2");
    EXPECT_EQ(stepOf(offlineRules(), layersOf(lit(2), fresh(), fresh())), "direct light of 1 to 2+2");
    EXPECT_EQ(stepOf(offlineRules(), layersOf(lit(2), lit(2), fresh())), "direct light of 2 to 2+2");
    EXPECT_EQ(stepOf(offlineRules(), layersOf(lit(2), lit(2), lit(2))), "layer 0 to 2+2");
}

TEST(DirectLightFirst, TheOneThatLeadsGoesAhead) {
    EXPECT_EQ(stepOf(offlineRules(), layersOf(fresh().redo({4, 8}), at(2, 2), fresh().redo({4, 8}))),
              "direct light of 0 to 4+8");
    EXPECT_EQ(stepOf(offlineRules(), layersOf(at(4, 4).noise(0, 1).off(0.02), lit(2).redo({8, 24}),
                                              at(4, 4).noise(0, 1).off(0.02).switchedOff())),
              "direct light of 1 to 8+24");
}

TEST(DirectLightFirst, HalfOfItIsNotEnough) {
    EXPECT_EQ(stepOf(offlineRules(), layersOf(lit(1), lit(2))), "direct light of 0 to 2+2");
    EXPECT_EQ(stepOf(offlineRules(), layersOf(lit(2), lit(1))), "direct light of 1 to 2+2");
}

TEST(DirectLightFirst, EachHasThatOfItsOwnLevel) {
    EXPECT_EQ(stepOf(offlineRules(), layersOf(lit(4).redo({4, 8}), lit(4).redo({16, 8}))),
              "direct light of 1 to 16+8");
    EXPECT_EQ(stepOf(offlineRules(), layersOf(lit(16).redo({16, 8}), lit(4).redo({4, 8}))),
              "layer 0 to 16+8");
}

TEST(DirectLightFirst, NotForOneAlone) {
    EXPECT_EQ(stepOf(offlineRules(), layersOf(fresh())), "layer 0 to 2+2");
    EXPECT_EQ(stepOf(offlineRules(), layersOf(fresh(), fresh().switchedOff(), at(8, 8).converged())),
              "layer 0 to 2+2");
    EXPECT_EQ(stepOf(offlineRules(), layersOf(fresh(), lit(4).redo({4, 8}))), "layer 0 to 2+2");
}

TEST(DirectLightFirst, NotOnTheCpu) {
    EXPECT_EQ(stepOf(onCpu(offlineRules()), layersOf(fresh(), fresh())), "layer 0 to 2+2");
}

TEST(DirectLightFirst, NotWhereNothingBounces) {
    const ScheduleRules rules{.passes = 1, .together = true};
    EXPECT_EQ(stepOf(rules, layersOf(fresh(), fresh())), "layer 0 to 2+0");
    EXPECT_EQ(stepOf({.passes = 2, .together = true}, layersOf(fresh(), fresh())),
              "direct light of 0 to 2+2");
}

TEST(DirectLightFirst, AViewerIsInHasteForTheFirstLevels) {
    EXPECT_EQ(stepOf(viewerRules(), layersOf(fresh(), fresh())), "layer 0 to 2+2");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(at(2, 2), fresh(), fresh())), "layer 1 to 2+2");
}

TEST(DirectLightFirst, AViewerIsNotInHasteForLaterLevels) {
    EXPECT_EQ(stepOf(viewerRules(), layersOf(at(2, 2).noise(1, 1).rays({16}), at(2, 2).rays({16}))),
              "direct light of 0 to 16+12");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(at(2, 2).rays({16}).lit(16), at(2, 2).rays({16}))),
              "direct light of 1 to 16+12");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(at(2, 2).rays({16}).lit(16), at(2, 2).rays({16}).lit(16))),
              "layer 0 to 16+12");
}

TEST(DirectLightFirst, EightBounceTogether) {
    const auto tenWithout = [](size_t dark) {
        LayerSchedule::Layers layers;
        for (size_t i = 0; i < 10; ++i)
            layers.push_back(i == dark ? fresh().make() : lit(2).make());
        return layers;
    };
    EXPECT_EQ(stepOf(offlineRules(), tenWithout(7)), "direct light of 7 to 2+2");
    EXPECT_EQ(stepOf(offlineRules(), tenWithout(8)), "layer 0 to 2+2");
    EXPECT_EQ(stepOf(offlineRules(), tenWithout(9)), "layer 0 to 2+2");
}

TEST(DirectLightFirst, TheSameLayersGiveTheSameStep) {
    const LayerSchedule schedule(offlineRules());
    const LayerSchedule::Layers layers = layersOf(lit(2), fresh(), at(2, 2));
    EXPECT_EQ(textOf(schedule.next(layers, Now())), textOf(schedule.next(layers, Now())));
}

} // namespace
} // namespace relume
