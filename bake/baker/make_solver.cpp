#include "bake/baker/make_solver.h"

#include "assets/base/log.h"
#include "bake/layers/layer_memory.h"
#include "bake/layers/layer_solver.h"
#include "bake/links/link_memory.h"
#include "bake/links/link_solver.h"
#include "bake/pairs/pair_memory.h"
#include "bake/pairs/pair_solver.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

// Bits and links may take this share of the free device memory if nothing else is said.
constexpr double kLinkMemoryShare = 1.0 / 3.0;
// Layers may take this share.
constexpr double kLayerShare = 1.0 / 3.0;
// All of a solver's memory, its caches included, may take this share: the driver needs some of its own.
constexpr double kMostShare = 0.9;

// Says how much memory caches may take where the settings do not: their share, but no more than the solver's
// own buffers leave.
void shareMemory(const SolverInput& input, SolverSettings& settings) {
    SolverSettings bare = settings;
    bare.cache.kind = CacheSettings::Kind::None;
    const SolverExtent extent = extentOf(input.patches, input.scene.sky, input.device.info().software());
    const auto free = static_cast<double>(input.device.freeMemory());
    const auto own = static_cast<double>(solverBytes(extent, bare).device);
    const double left = std::max(0.0, kMostShare * free - own) / (settings.layers.on ? 2 : 1);
    if (settings.cache.bytes == 0)
        settings.cache.bytes = static_cast<uint64_t>(std::min(kLinkMemoryShare * free, left));
    if (settings.layers.bytes == 0)
        settings.layers.bytes = static_cast<uint64_t>(std::min(kLayerShare * free, left));
}

} // namespace

Spill mostSpill(const SolverSettings& settings) {
    if (isPairMethod(settings.method)) return Spill::None;
    return settings.links.footprint ? Spill::Links : kMostSpill;
}

SolverExtent extentOf(const PatchSet& patches, const Sky& sky, bool software) {
    const uint64_t size = patches.scene.size;
    return {.chunkCount = patches.chunkCount(),
            .texels = size * size,
            .software = software,
            .skyPixels = sky.pixels.size(),
            .skyRows = sky.height};
}

MadeSolver makeSolver(const SolverInput& input, const SolverSettings& settings, const LayerCarry* carry) {
    ASSERT(input.ranks.alone() || (!isPairMethod(settings.method) && !settings.layers.on));
    SolverSettings complete = settings;
    shareMemory(input, complete);
    if (isPairMethod(settings.method)) {
        const vk::MemoryOwner owner(kPairsOwner);
        return {.solver = std::make_unique<PairSolver>(input, complete)};
    }
    if (settings.layers.on) {
        const vk::MemoryOwner owner(kLayersOwner);
        const std::string tooMany =
            layerProblem(input.scene, input.patches, complete.layers.bytes, complete.layers.lights);
        if (!settings.layers.optional || tooMany.empty()) {
            auto layers = std::make_unique<LayerSolver>(input, complete, carry);
            LayerSolver* const known = layers.get();
            return {.solver = std::move(layers), .layers = known};
        }
        spdlog::warn("all lights are baked as one: {}", tooMany);
    }
    const vk::MemoryOwner owner(kLinksOwner);
    return {.solver = std::make_unique<LinkSolver>(input, complete)};
}

SpilledBytes solverBytes(const SolverExtent& extent, const SolverSettings& settings) {
    if (isPairMethod(settings.method)) return {.device = pairSolverBytes(extent, settings)};
    if (!settings.layers.on) return linkSolverBytes(extent, settings);
    const SpilledBytes layers = layerSolverBytes(extent, settings);
    if (!settings.layers.optional) return layers;
    const SpilledBytes links = linkSolverBytes(extent, settings);
    return {std::max(layers.device, links.device), std::max(layers.host, links.host)};
}

} // namespace relume
