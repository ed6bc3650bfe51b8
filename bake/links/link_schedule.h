#pragma once

#include "bake/base/light_error.h"
#include "bake/base/bounce_convergence.h"
#include "bake/gather/chunk_plan.h"
#include "bake/gather/smoothing_width.h"
#include "bake/links/direct_plan.h"

namespace relume {

/// Tells of direct light whose sample passes are planned chunk by chunk.
struct DirectApart {
    bool on = false;      // from the first solution on
    uint32_t planned = 0; // sample passes of links when it was planned last
    double settled = 0;   // of LinkState::directChoice: of chunks that want no more
    double allowed = 0;   // variance that it may leave in the end, as DirectPlan::left() tells
};

/// Everything that decides what a link solver does next, except for the sums, the light and the order of
/// chunks. A checkpoint holds it byte by byte.
struct LinkState {
    enum class Stage : uint32_t { Plan, Direct, Links };
    Stage stage = Stage::Plan;
    // Finished, of the chunks that have most; of direct light apart, of those that have fewest.
    uint32_t directSamplePasses = 0, linkSamplePasses = 0;
    uint32_t passSamplePasses = 1; // that the pass under way takes
    uint32_t bounce = 0;           // of the current sample pass
    uint32_t nextCheck = 0;        // sample passes of both kinds before the next check
    bool last = false;             // this bounce is the sample pass's last one: it counts
    BounceSeries series;           // of the first sample pass, then its last bounce's own share
    // These are of the light, R, G and B of all patches together.
    double directVariance = 0, indirectVariance = 0, coarseVariance = 0;
    double light = 0, patches = 0; // likewise, of those that are shown
    double bias = 0;               // likewise, squares of what is left however many samples there are
    SmoothingWidth width;
    double directChoice = 0, linkChoice = 0; // variances, of any one unit, that the next sample pass goes by
    uint32_t directAtCheck = 0, linksAtCheck = 0; // sample passes behind these variances
    BounceConvergence convergence;                // of the first sample pass, then of the result
    bool scaled = false;                          // chunks have sample passes of their own, of both kinds
    DirectApart apart;
    double raysToLights = 0; // of a patch, in the last sample pass of direct light
    double median = 0;       // light of all texels [cd/m^2]
    double strictness = 1;   // what is asked for is planned with so many times less error

    uint32_t samplePasses() const { return directSamplePasses + linkSamplePasses; }
    /// Tells whether sums are of as many samples as each chunk has.
    bool hasScales() const { return scaled || apart.on; }
};

/// No sample pass has more bounces.
constexpr uint32_t kMostBounces = 256;

/// Holds what a schedule goes by for a whole bake.
struct LinkRules {
    bool hybrid = false;
    bool hasDirect = false; // rays go to lights
    uint32_t linksOfSamplePass = 16;
    uint32_t samples = 0;     // per patch, at most; 0: as many as the error needs
    uint32_t passes = 0;      // bounces of each sample pass; 0: until they have converged
    double error = 0.01;      // relRMSE to be reached; 0: any will do
    double localError = 0;    // local error to be reached; 0: any will do. With both 0 all samples are taken
    bool perChunk = false;    // chunks may have sample passes of their own
    bool directApart = false; // they may have those of direct light
    double directCost = 1, linkCost = 1; // of a sample pass of each kind, per patch and in one unit
    double passCost = 0;                 // that one of direct light of some chunks has besides
};

/// Decides what a link solver does next: a pure function of its state.
class LinkSchedule {
public:
    explicit LinkSchedule(const LinkRules& rules) : rules_(rules) {}

    /// Returns the sample passes of each kind at most.
    uint32_t samplePassesWanted() const;
    /// Returns how many directions share the result.
    uint32_t footprintSamples(const LinkState& state) const;
    /// Tells whether the error is to be found before the next sample pass.
    bool wantsCheck(const LinkState& state) const {
        return wantsError() && state.samplePasses() > 0 && state.samplePasses() >= state.nextCheck;
    }
    /// Tells whether an error decides when sampling ends.
    bool wantsError() const { return rules_.error > 0 || rules_.localError > 0; }
    /// Returns what was told over what is asked for, of the error that is farther off: 1 or less is enough.
    double excess(double error, double localError) const;
    /// Tells whether it is local error that is farther off.
    bool choosesLocally(double error, double localError) const {
        if (rules_.error <= 0 || rules_.localError <= 0) return rules_.localError > 0;
        return localError / rules_.localError >= error / rules_.error;
    }
    /// Returns the sample passes before the check after one that has told this excess.
    uint32_t nextCheck(const LinkState& state, double excess) const;
    /// Tells whether chunks get sample passes of their own from the first check on.
    bool perChunk() const { return rules_.perChunk; }
    /// Returns what sample passes of chunks are planned by.
    ChunkPlanRules planRules(const LinkState& state) const;
    /// Tells whether chunks get sample passes of direct light of their own, once there is a solution. All
    /// have as many of links, as what few of those bring would stay in later bounces, untold.
    bool plansApart() const { return rules_.directApart && rules_.hasDirect && !directAlone(); }
    /// Returns what these are planned by.
    DirectPlanRules directRules(const LinkState& state) const;
    /// Returns the share of directChoice that direct light may leave where the error, so many times what is
    /// asked for, is to be reached: links will have fallen as the local error has to by then, and direct
    /// light need not fall by more than the whole.
    double directShare(const LinkState& state, double excess, double localError) const;
    /// Holds what is planned after a check.
    struct PlannedApart {
        DirectApart apart;
        std::vector<uint32_t> wanted; // sample passes that each chunk is to have
    };
    /// Plans after a check whose error is so many times what is asked for, of which the plan has learned.
    PlannedApart apart(const LinkState& state, const DirectPlan& plan, std::span<const uint32_t> samplePasses,
                       double excess, double localError) const;
    /// Tells whether they are planned anew between checks: as what links take away becomes less, where the
    /// number of sample passes of links is one of the ladder (sample_plan.h).
    bool plansDirect(const LinkState& state) const;
    /// Returns how many sample passes of links follow so many at once, from the same light. Each next one
    /// would start from better light, which matters less the more there are.
    static uint32_t samplePassesAtOnce(uint32_t samplePasses) { return samplePasses / 16 + 1; }
    /// Tells whether all sample passes are made.
    bool isDone(const LinkState& state) const { return linksDone(state) && directDone(state); }
    /// Tells whether direct light comes next, of all patches: at first, then where it takes more away, for
    /// its cost, of the variance that is farther off what is asked for, and now and then in any case. Apart,
    /// it comes by plans, and here where links are done.
    bool wantsDirect(const LinkState& state) const;
    /// Tells whether there are sums of a sample pass in which every patch has its bounces.
    bool hasSolution(const LinkState& state) const {
        return state.linkSamplePasses > 0 || (directAlone() && state.directSamplePasses > 0);
    }
    /// Tells whether there is light to look at: of all patches, or of those that are seen, which come first
    /// and have theirs (`seenLit`).
    static bool hasFirstLight(const LinkState& state, bool seenLit) {
        return state.samplePasses() > 0 || state.bounce > 0 ||
               (seenLit && state.stage != LinkState::Stage::Plan);
    }
    /// Tells whether direct light is all that is asked for.
    bool directAlone() const { return rules_.hybrid && rules_.passes == 1; }
    /// Tells whether the bounce that begins is its sample pass's last one.
    bool isLastBounce(const LinkState& state) const;
    /// Tells whether bounces of the first sample pass are followed until they have converged.
    bool converges(const LinkState& state) const {
        return rules_.passes == 0 && state.linkSamplePasses == 0 && !state.last;
    }
    /// Tells whether these bounces have converged, so that the next one is the last.
    bool hasConverged(const LinkState& state) const;

private:
    bool linksDone(const LinkState& state) const {
        return state.linkSamplePasses >= samplePassesWanted() || directAlone();
    }
    bool directDone(const LinkState& state) const {
        return !rules_.hasDirect || state.directSamplePasses >= samplePassesWanted();
    }

    LinkRules rules_;
};

} // namespace relume
