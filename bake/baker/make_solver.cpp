#include "bake/baker/make_solver.h"

#include "assets/base/log.h"
#include "bake/baker/host_room.h"
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

// Beside a GPU links may take this share of the host's free memory, too, and layers as much: the rest is for
// other programs.
constexpr double kHostShare = 1.0 / 4.0;

SolverRoom roomFor(const SolverInput& input, const SolverSettings& settings) {
    SolverSettings bare = settings;
    bare.cache.kind = CacheSettings::Kind::None;
    const bool software = input.device.info().software();
    return {.device = input.device.freeMemory(),
            .host = freeHostMemory().value_or(0),
            .own = solverBytes(extentOf(input.patches, input.scene.sky, software), bare),
            .shared = input.device.info().sharesMemory()};
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

void shareMemory(const SolverRoom& room, SolverSettings& settings) {
    const double host =
        kHostShare * std::max(0.0, static_cast<double>(room.host) - static_cast<double>(room.own.host));
    const auto free = static_cast<double>(room.device);
    const double unused = kMostShare * free - static_cast<double>(room.own.device);
    const double left = std::max(0.0, unused) / (settings.layers.on ? 2 : 1);
    const auto share = [&](uint64_t& bytes, uint64_t& deviceBytes, double shareOfDevice, bool spills) {
        spills = spills && !room.shared;
        const bool given = bytes > 0;
        const auto onDevice = static_cast<uint64_t>(given ? left : std::min(shareOfDevice * free, left));
        if (!given) bytes = onDevice + (spills ? static_cast<uint64_t>(host) : 0);
        if (deviceBytes == 0) deviceBytes = spills ? std::min(bytes, onDevice) : bytes;
    };
    CacheSettings& cache = settings.cache;
    share(cache.bytes, cache.deviceBytes, kLinkMemoryShare, !isPairMethod(settings.method));
    share(settings.layers.bytes, settings.layers.deviceBytes, kLayerShare, true);
}

MadeSolver makeSolver(const SolverInput& input, const SolverSettings& settings, const LayerCarry* carry) {
    ASSERT(input.ranks.alone() || !settings.layers.on);
    SolverSettings complete = settings;
    shareMemory(roomFor(input, settings), complete);
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
