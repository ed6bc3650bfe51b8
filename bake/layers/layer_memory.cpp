#include "bake/layers/layer_memory.h"

#include <algorithm>

#include "bake/direct/emitter_light.h"
#include "bake/direct/lamp_light.h"
#include "bake/gather/link_cache.h"
#include "bake/layers/error_sketch.h"
#include "bake/layers/layer_lights.h"

namespace relume {
namespace {

// A tile's patches belong to at most so many objects, in the mean.
constexpr uint64_t kPartsOfTile = 8;
// Two buffers take turns in a bounce (LayerBounces).
constexpr uint64_t kTurns = 2;

} // namespace

SpilledBytes layerSolverBytes(const SolverExtent& extent, const SolverSettings& settings) {
    constexpr uint32_t kPoints = LayerLights::kPoints;
    const uint64_t count = extent.patches(), chunks = extent.chunkCount;
    const uint32_t polygons = extent.lights ? extent.lights->polygonsOfOne : EmitterLight::kAllOfLight;
    const LightExtent lights = extent.lights.value_or(LightExtent{});
    // Analytic lights have a group each while there is room for layers of all of them.
    const uint32_t one = lights.extended > 0 || (lights.points > 0 && settings.links.allOver)
                             ? kPoints
                             : std::min(lights.points, 1u);
    const uint32_t rays = extent.lights ? one : LampLight::kMostGroupRays;
    const uint64_t direct =
        EmitterLight::bytes(extent.chunkCount, extent.software, {.links = kPoints, .lightByLight = true},
                            polygons) +
        LampLight::bytes(extent.chunkCount, extent.software, rays) +
        LampLight::tableBytes({lights.extended, lights.points}, extent.skyPixels, extent.skyRows);
    const uint32_t links =
        linksOfSamplePass(static_cast<uint32_t>(count), settings.links.samples, extent.software);
    // One batch of links that are not kept is there, nothing else for links.
    const LinkBuffers::Desc desc{.direct = true, .smooth = settings.links.smooth, .spill = settings.spill};
    const uint64_t staging =
        LinkCache::mostBytes({.chunkCount = extent.chunkCount,
                              .links = links,
                              .batch = linkBatchChunks(extent.chunkCount, extent.software)});
    const uint64_t parts = count * sizeof(uint32_t) + kPartsOfTile * chunks * sizeof(glm::uvec2);
    const bool onCpu = extent.software && !settings.transport.deviceGather;
    // A GPU tells a sketch of the error, which is read back.
    const uint64_t sketch = onCpu ? 0 : kSketchEntries * sizeof(glm::vec3);
    // It counts the composite's texels, too, where that is wanted at all (CompositeReport).
    const bool counts = !onCpu && (!settings.live || settings.localError > 0);
    const uint64_t bins = counts ? shader::kBinCopies * shader::kBinsOfCopy * sizeof(uint32_t) : 0;
    const uint64_t sums =
        chunks * (sizeof(shader::ResolveSums) + sizeof(glm::vec4)) + shader::kRayCounters * sizeof(uint32_t);
    const uint64_t back = std::max(sums, onCpu ? 0 : kLevelSumsAt + chunks * sizeof(shader::ResolveSums));
    const uint64_t bounces = onCpu ? 0 : kTurns * (count * sizeof(glm::uvec2) + chunks * sizeof(glm::vec4));
    // The composite, and where somebody watches the sum of the layers that do not change.
    const uint64_t mixed = (settings.live ? 2 : 1) * count * sizeof(glm::vec4);
    SpilledBytes bytes = LinkBuffers::bytes(extent, desc, 0);
    bytes.device += direct + staging + parts + back + sketch + bins + bounces + mixed;
    return bytes;
}

} // namespace relume
