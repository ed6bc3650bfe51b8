#include "bake/links/link_schedule.h"

#include "bake/gather/sample_plan.h"

#include <algorithm>

namespace relume {
namespace {

// The error is looked at again when so much of the sample passes that it seems to need are done (variance
// falls as 1 / rounds or faster), and when their number has doubled.
constexpr double kCheckShare = 0.6, kCheckGrowth = 2.0;

} // namespace

uint32_t LinkSchedule::roundsWanted() const {
    const uint32_t limit = rules_.samples > 0 ? rules_.samples : kMaxSamplesOfPatch;
    return (limit + rules_.linksOfRound - 1) / rules_.linksOfRound;
}

// Each direction stands for its share of the whole result. Where the error decides how many there will be, it
// is that of what is there so far: the mean over sample passes of something that falls as 1 / rounds falls to
// nothing, too.
uint32_t LinkSchedule::footprintSamples(const LinkState& state) const {
    return rules_.linksOfRound * (rules_.samples > 0 ? roundsWanted() : state.linkRounds + 1);
}

uint32_t LinkSchedule::nextCheck(const LinkState& state, double error) const {
    const double off = error / rules_.error;
    const double growth = std::min(kCheckGrowth, kCheckShare * off * off);
    return std::max(state.rounds() + 1, static_cast<uint32_t>(growth * state.rounds()));
}

bool LinkSchedule::wantsDirect(const LinkState& state) const {
    if (directDone(state)) return false;
    if (state.directRounds == 0 || linksDone(state)) return true;
    if (state.linkRounds == 0) return false;
    if (rules_.samples > 0) return state.directRounds <= state.linkRounds;
    return gainOfRound({.rounds = state.directAtCheck,
                        .variance = state.directVariance,
                        .costOfRound = rules_.directCost},
                       state.directRounds) > gainOfRound({.rounds = state.linksAtCheck,
                                                          .variance = state.indirectVariance,
                                                          .costOfRound = rules_.linkCost},
                                                         state.linkRounds);
}

bool LinkSchedule::isLastBounce(const LinkState& state) const {
    // Hybrid's first pass is its direct light.
    const uint32_t bounces = rules_.hybrid ? rules_.passes - 1 : rules_.passes;
    if (rules_.passes > 0) return state.bounce + 1 >= bounces;
    return state.linkRounds > 0 || (state.bounce > 0 && state.last);
}

bool LinkSchedule::hasConverged(const LinkState& state) const {
    const double aim = rules_.error > 0 ? kIterationShare * rules_.error : kLeastIterationError;
    return state.series.error <= aim || state.bounce + 1 >= kMostBounces;
}

} // namespace relume
