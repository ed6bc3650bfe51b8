#include "assets/base/phase_clock.h"

#include <gtest/gtest.h>

#include <vector>

namespace relume {
namespace {

double sumOf(const std::vector<PhaseTime>& phases, double PhaseTime::*what) {
    double sum = 0;
    for (const PhaseTime& phase : phases)
        sum += phase.*what;
    return sum;
}

/// Works until this process has used so much more CPU time [s].
void burn(double seconds) {
    const double start = cpuSeconds();
    while (cpuSeconds() - start < seconds) {
    }
}

TEST(PhaseClock, PartsFollowEachOther) {
    std::vector<PhaseTime> phases;
    const auto start = Clock::now();
    const double cpu = cpuSeconds();
    PhaseClock clock(phases);
    burn(0.02);
    clock.end("first");
    burn(0.01);
    clock.end("second");
    burn(0.01);
    clock.end("first");
    const double whole = secondsSince(start), wholeCpu = cpuSeconds() - cpu;
    ASSERT_EQ(phases.size(), 2u);
    EXPECT_EQ(phases[0].name, "first");
    EXPECT_EQ(phases[1].name, "second");
    EXPECT_GE(phases[0].cpuSeconds, 0.03);
    EXPECT_GE(phases[1].cpuSeconds, 0.01);
    EXPECT_LE(sumOf(phases, &PhaseTime::seconds), whole);
    EXPECT_LE(sumOf(phases, &PhaseTime::cpuSeconds), wholeCpu + 1e-6);
    EXPECT_NEAR(sumOf(phases, &PhaseTime::cpuSeconds), wholeCpu, 0.01);
}

TEST(PhaseClock, LeavesOutWhatIsBetween) {
    std::vector<PhaseTime> phases;
    PhaseClock clock(phases);
    burn(0.05);
    clock.restart();
    clock.end("nothing");
    EXPECT_LT(phases.at(0).cpuSeconds, 0.03);
}

TEST(PhaseClock, OtherMakesTheSumTheWhole) {
    std::vector<PhaseTime> phases = {{"read", 1.0, 2.0}, {"write", 0.5, 0.25}};
    addOther(phases, 2.0, 3.0);
    ASSERT_EQ(phases.size(), 3u);
    EXPECT_EQ(phases[2].name, "other");
    EXPECT_DOUBLE_EQ(sumOf(phases, &PhaseTime::seconds), 2.0);
    EXPECT_DOUBLE_EQ(sumOf(phases, &PhaseTime::cpuSeconds), 3.0);
    std::vector<PhaseTime> rounded = {{"read", 1.001, 1.0}};
    addOther(rounded, 1.0, 1.0);
    EXPECT_EQ(rounded[1].seconds, 0.0);
    EXPECT_EQ(secondsOf(phases, "write"), 0.5);
    EXPECT_EQ(secondsOf(phases, "nosuchpart"), 0.0);
}

TEST(PhaseClock, KnowsWhenTheProcessBegan) {
    const double before = processSeconds();
    EXPECT_GT(before, 0.0);
    const auto start = Clock::now();
    burn(0.05);
    const double passed = processSeconds() - before, clock = secondsSince(start);
    EXPECT_GE(passed, 0.05 - 1e-3);
    EXPECT_LE(passed, clock + 1e-3);
}

} // namespace
} // namespace relume
