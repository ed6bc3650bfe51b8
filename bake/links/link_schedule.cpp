#include "bake/links/link_schedule.h"

#include "bake/base/batch_rate.h"
#include "bake/base/shader_types.h"
#include "bake/gather/sample_plan.h"

#include <algorithm>

namespace relume {
namespace {

// The error is looked at again when this share of the sample passes that it still seems to need are done, and
// when their number has doubled at the latest.
constexpr double kCheckShare = 0.6, kCheckGrowth = 2.0;
// 95 % of normally distributed errors are within so many standard deviations.
constexpr double kDeviationsOf95 = 1.96;
// There are at most so many sample passes of links for one of direct light: links read direct light, and what
// few of its samples leave in there is no error that replicates tell.
constexpr uint32_t kMostLinksOfDirect = 32;
// Plans of direct light aim at this share of the variance that is allowed, as variances are not known
// exactly.
constexpr double kAimOfPlans = 0.9;
// Samples are planned for at least this share of the variance that is allowed, whatever else is left.
constexpr double kLeastOfVariance = 0.25;

} // namespace

uint32_t LinkSchedule::samplePassesWanted() const {
    const uint32_t limit = rules_.samples > 0 ? rules_.samples : kMaxSamplesOfPatch;
    return (limit + rules_.linksOfSamplePass - 1) / rules_.linksOfSamplePass;
}

// Each direction stands for its share of the whole result. Where the error decides how many there will be, it
// is that of what is there so far: the mean over sample passes of something that falls as 1 / samplePasses
// falls to nothing, too.
uint32_t LinkSchedule::footprintSamples(const LinkState& state) const {
    return rules_.linksOfSamplePass *
           (rules_.samples > 0 ? samplePassesWanted() : state.linkSamplePasses + 1);
}

double LinkSchedule::excess(double error, double localError) const {
    return std::max(rules_.error > 0 ? error / rules_.error : 0.0,
                    rules_.localError > 0 ? localError / rules_.localError : 0.0);
}

ChunkPlanRules LinkSchedule::planRules(const LinkState& state) const {
    ChunkPlanRules plan{.directCost = std::max(1.0, kSegmentCost * state.raysToLights),
                        .linkCost = rules_.linkCost,
                        .mostSamplePasses = samplePassesWanted(),
                        .hasDirect = rules_.hasDirect && state.directSamplePasses > 0};
    plan.localError = rules_.localError * state.strictness / kDeviationsOf95;
    if (rules_.error > 0 && state.patches > 0) {
        const double mean = state.light / (3.0 * state.patches), iteration = state.series.error;
        const double square = std::max(0.0, rules_.error * rules_.error - iteration * iteration);
        const double all = square * mean * mean * 3.0 * state.patches;
        // What samples do not take away leaves less for them, but never nothing.
        plan.variance =
            state.strictness * state.strictness * std::max(kLeastOfVariance * all, all - state.bias);
    }
    return plan;
}

DirectPlanRules LinkSchedule::directRules(const LinkState& state) const {
    const double links = gainOfSamplePass({.samplePasses = state.linksAtCheck,
                                           .variance = state.linkChoice,
                                           .costOfSamplePass = rules_.linkCost},
                                          state.linkSamplePasses);
    return {.cost = std::max(1.0, kSegmentCost * state.raysToLights),
            .passCost = rules_.passCost,
            .linkGain = linksDone(state) ? 0.0 : links / std::max(1.0, state.patches),
            .allowed = kAimOfPlans * state.apart.allowed,
            .least = std::max(1u, state.linkSamplePasses / kMostLinksOfDirect),
            .most = rules_.samples > 0 ? samplePassesWanted() : kMaxDirectSamplePasses};
}

double LinkSchedule::directShare(const LinkState& state, double excess, double localError) const {
    if (!(state.directChoice > 0)) return 1.0;
    const double whole = 1.0 / (excess * excess), links = state.linkChoice / state.directChoice;
    const double fall = rules_.localError > 0 ? std::max(1.0, localError / rules_.localError) : 1.0;
    return std::max(whole, whole * (1.0 + links) - links / (fall * fall));
}

// Chunks that count for their neighbours, too, leave more than they have by themselves: so a share of that is
// allowed.
LinkSchedule::PlannedApart LinkSchedule::apart(const LinkState& state, const DirectPlan& plan,
                                               std::span<const uint32_t> samplePasses, double excess,
                                               double localError) const {
    LinkState now = state;
    const double left = plan.left(samplePasses);
    now.apart.on = true;
    now.apart.planned = state.linkSamplePasses;
    now.apart.allowed = directShare(state, excess, localError) * left;
    std::vector<uint32_t> wanted = plan.wanted(directRules(now), samplePasses);
    const double settled = plan.settled(wanted, samplePasses);
    now.apart.settled = left > 0 ? state.directChoice * settled / left : 0.0;
    return {now.apart, std::move(wanted)};
}

bool LinkSchedule::plansDirect(const LinkState& state) const {
    return linksDone(state) || (state.apart.planned != state.linkSamplePasses &&
                                onLadder(state.linkSamplePasses) == state.linkSamplePasses);
}

// The sample passes to come are those that this schedule will choose, and each kind's variance falls as one
// over their number. Apart, direct light that is not settled gets its sample passes as links get theirs.
uint32_t LinkSchedule::nextCheck(const LinkState& state, double excess) const {
    const auto variance = [&](const LinkState& at) {
        return state.directChoice * state.directAtCheck / std::max(1u, at.directSamplePasses) +
               state.linkChoice * state.linksAtCheck / std::max(1u, at.linkSamplePasses);
    };
    const uint32_t now = state.samplePasses();
    const double allowed = variance(state) / (excess * excess), farthest = (kCheckGrowth - 1.0) / kCheckShare;
    if (state.apart.on) {
        const double falls = std::max(0.0, variance(state) - state.apart.settled);
        const double left = allowed - state.apart.settled;
        const double more = left > 0 ? std::clamp(falls / left - 1.0, 0.0, farthest) : farthest;
        return now + std::max(1u, static_cast<uint32_t>(kCheckShare * more * state.linkSamplePasses));
    }
    LinkState ahead = state;
    while (variance(ahead) > allowed && ahead.samplePasses() - now < farthest * now && !isDone(ahead))
        ++(wantsDirect(ahead) ? ahead.directSamplePasses : ahead.linkSamplePasses);
    return now + std::max(1u, static_cast<uint32_t>(kCheckShare * (ahead.samplePasses() - now)));
}

bool LinkSchedule::wantsDirect(const LinkState& state) const {
    if (directDone(state)) return false;
    if (state.directSamplePasses == 0 || linksDone(state)) return true;
    if (state.linkSamplePasses == 0 || state.apart.on) return false;
    if (rules_.samples > 0) return state.directSamplePasses <= state.linkSamplePasses;
    if (state.directSamplePasses < state.linkSamplePasses / kMostLinksOfDirect) return true;
    return gainOfSamplePass({.samplePasses = state.directAtCheck,
                             .variance = state.directChoice,
                             .costOfSamplePass = rules_.directCost},
                            state.directSamplePasses) >
           gainOfSamplePass({.samplePasses = state.linksAtCheck,
                             .variance = state.linkChoice,
                             .costOfSamplePass = rules_.linkCost},
                            state.linkSamplePasses);
}

bool LinkSchedule::isLastBounce(const LinkState& state) const {
    // Hybrid's first pass is its direct light.
    const uint32_t bounces = rules_.hybrid ? rules_.passes - 1 : rules_.passes;
    if (rules_.passes > 0) return state.bounce + 1 >= bounces;
    return state.linkSamplePasses > 0 || (state.bounce > 0 && state.last);
}

bool LinkSchedule::hasConverged(const LinkState& state) const {
    const double asked = rules_.error > 0 ? rules_.error : rules_.localError;
    return state.series.isWithin(keptIterationAim(asked), kLocalIterationAim) ||
           state.bounce + 1 >= kMostBounces;
}

} // namespace relume
