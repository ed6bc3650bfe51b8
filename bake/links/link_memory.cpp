#include "bake/links/link_memory.h"

#include <algorithm>

#include "bake/direct/emitter_light.h"
#include "bake/direct/lamp_light.h"
#include "bake/gather/link_cache.h"
#include "bake/links/footprint.h"

namespace relume {
namespace {

/// Holds what the direct light of a link method takes.
struct DirectNeeds {
    bool any = false;   // there is direct light
    bool lamps = false; // there is that of analytic lights
    uint64_t bytes = 0;
};

uint64_t lampTableBytes(const SolverExtent& extent) {
    const LightExtent lights = extent.lights.value_or(LightExtent{});
    return LampLight::tableBytes({lights.extended, lights.points}, extent.skyPixels, extent.skyRows);
}

DirectNeeds directNeeds(const SolverExtent& extent, bool meshLights, uint32_t links, bool allOver) {
    const uint32_t polygons = extent.lights ? extent.lights->polygons : EmitterLight::kAllEmitters;
    const uint32_t rays =
        extent.lights ? LampLight::groupRays({extent.lights->extended, extent.lights->points}, links, allOver)
                      : LampLight::kMostGroupRays;
    const uint64_t emitters =
        EmitterLight::bytes(extent.chunkCount, extent.software, {.links = links}, meshLights ? polygons : 0);
    const uint64_t lamps = LampLight::bytes(extent.chunkCount, extent.software, rays);
    const bool any = rays > 0 || (meshLights && polygons > 0);
    return {.any = any, .lamps = rays > 0, .bytes = emitters + lamps + lampTableBytes(extent)};
}

} // namespace

bool samplesPerChunk(const SolverSettings& settings, bool software) {
    const bool wanted = settings.error > 0 || settings.localError > 0;
    return software && wanted && settings.links.perChunk && settings.passes == 0 &&
           settings.links.indirectScale == 1;
}

bool directApart(const SolverSettings& settings) {
    const bool wanted = settings.error > 0 || settings.localError > 0;
    return wanted && !settings.links.uniform && settings.links.samples == 0 && settings.passes == 0 &&
           settings.links.indirectScale == 1;
}

SpilledBytes linkSolverBytes(const SolverExtent& extent, const SolverSettings& settings) {
    const uint64_t count = extent.patches();
    const bool hybrid = settings.method == Method::Hybrid;
    // The last chunk may be padding but for one patch.
    const auto least = static_cast<uint32_t>(count - std::min<uint64_t>(count, shader::kChunk - 1));
    const uint32_t links = linksOfSamplePass(least, settings.links.samples, extent.software);
    const DirectNeeds direct = directNeeds(extent, hybrid, links, settings.links.allOver);
    const LinkBuffers::Desc desc{.direct = direct.any,
                                 .smooth = hybrid && settings.links.smooth,
                                 .local = true,
                                 .notes = direct.lamps && samplesPerChunk(settings, extent.software),
                                 .carries = settings.passes == 0,
                                 .spill = settings.spill};
    // Charts a texel wide have so many receivers; those of compact ones are fewer.
    const uint32_t scale = settings.links.indirectScale;
    const uint64_t receivers = scale > 1 ? extent.receivers.value_or(count / scale) : 0;
    LinkCache::Desc cache{.chunkCount = receivers > 0 ? static_cast<uint32_t>(receivers / shader::kChunk)
                                                      : extent.chunkCount,
                          .links = links,
                          .batch = linkBatchChunks(extent.chunkCount, extent.software),
                          .oneSamplePass = true};
    if (settings.cache.keepsLinks())
        cache.bytes = settings.cache.bytes > 0 ? settings.cache.bytes : UINT64_MAX;
    // Every node has two children or more, so there are fewer of them than patches; in compact charts a third
    // as many.
    const uint64_t nodes = settings.links.footprint ? extent.nodes.value_or(count) : 0;
    const uint64_t packed =
        extent.software && !settings.transport.deviceGather ? 0 : (count + nodes) * sizeof(glm::uvec2);
    SpilledBytes undo;
    if (settings.live && !desc.smooth)
        undo.add(shader::kReplicates * count * sizeof(glm::vec4), Spill::Links, settings.spill);
    // Radiance with nodes is made beside the one without, which goes before the rest comes.
    const uint64_t radiance = nodes * sizeof(glm::vec4);
    const uint64_t before = settings.links.footprint ? count * sizeof(glm::vec4) : 0;
    const uint32_t samples = std::max(links, settings.links.samples);
    const uint64_t disc = settings.links.directions == DirectionSet::Lec
                              ? uint64_t{samples} / shader::kReplicates * sizeof(glm::vec2)
                              : 0;
    SpilledBytes bytes = LinkBuffers::bytes(extent, desc, receivers);
    bytes.device += direct.bytes + LinkCache::mostBytes(cache) +
                    (nodes > 0 ? Footprints::bytes(count, nodes) : 0) + radiance +
                    std::max(before, packed + undo.device + disc);
    // These are the host's, which is the device's own where the device is the CPU.
    bytes.device += shader::kRayCounters * sizeof(uint32_t) + extent.chunkCount * sizeof(uint32_t);
    bytes.host += undo.host;
    return bytes;
}

} // namespace relume
