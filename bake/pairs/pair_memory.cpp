#include "bake/pairs/pair_memory.h"

#include "bake/direct/lamp_light.h"
#include "bake/pairs/pair_plan.h"
#include "bake/pairs/pair_senders.h"

namespace relume {
namespace {

SenderKind kindOf(const SolverSettings& settings) {
    if (settings.method == Method::Pure) return SenderKind::Patches;
    const bool drawn = settings.method == Method::MonteCarlo && !settings.transport.rtrad;
    return drawn ? SenderKind::Drawn : SenderKind::List;
}

// Returns how many senders a list has at most. Of charts a texel wide, windows have as many as their edge has
// texels; of compact ones they have the square of that.
uint64_t mostSenders(const SolverExtent& extent, const SolverSettings& settings) {
    if (extent.senders) return *extent.senders;
    const uint64_t texels = settings.method == Method::Adaptive ? 1 : settings.pairs.window;
    const uint64_t senders = extent.patches() / texels;
    return (senders + shader::kChunk - 1) / shader::kChunk * shader::kChunk;
}

uint64_t lampBytes(const SolverExtent& extent, const SolverSettings& settings) {
    if (settings.transport.rtrad) return LampLight::tableBytes({}, 0, 0);
    const LightExtent lights = extent.lights.value_or(LightExtent{});
    const uint64_t tables =
        LampLight::tableBytes({lights.extended, lights.points}, extent.skyPixels, extent.skyRows);
    const uint32_t rays =
        extent.lights
            ? LampLight::groupRays({extent.lights->extended, extent.lights->points}, kPairLampRays, false)
            : LampLight::kMostGroupRays;
    if (rays == 0) return tables;
    return extent.patches() * sizeof(glm::vec4) * (shader::kReplicates + 1) +
           LampLight::bytes(extent.chunkCount, extent.software, rays) + tables;
}

} // namespace

uint64_t pairSenderBytes(const SolverExtent& extent, const SolverSettings& settings) {
    if (!isPairMethod(settings.method) || settings.method == Method::Pure) return 0;
    return PairSenders::bytes(mostSenders(extent, settings), extent.patches(), kindOf(settings));
}

uint64_t pairSolverBytes(const SolverExtent& extent, const SolverSettings& settings) {
    const SenderKind kind = kindOf(settings);
    const bool patchesSend = kind == SenderKind::Patches;
    const uint64_t senders = patchesSend ? 0 : mostSenders(extent, settings);
    // A quad-tree may grow as far as there are patches: its super-blocks are counted for the most.
    const uint64_t columns =
        patchesSend || settings.method == Method::Adaptive ? extent.chunkCount : senders / shader::kChunk;
    const uint64_t supers = PairPlan::superBlocks(
        {.rows = extent.chunkCount, .columns = static_cast<uint32_t>(columns), .symmetric = patchesSend});
    const bool bothEnds = patchesSend && settings.transport.rtrad;
    const uint64_t live = settings.live ? extent.patches() * sizeof(glm::vec4) : 0;
    const uint64_t counters = 2 * shader::kRayCounters * sizeof(uint32_t);
    return PairBuffers::bytes(supers, kind, bothEnds, extent.software) + pairSenderBytes(extent, settings) +
           live + counters + lampBytes(extent, settings);
}

} // namespace relume
