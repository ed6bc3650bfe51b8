#include "bake/baker/make_solver.h"

#include "assets/base/log.h"
#include "bake/layers/layer_solver.h"
#include "bake/links/link_solver.h"
#include "bake/pairs/pair_solver.h"

namespace relume {
namespace {

// Bits and links may take this share of the free device memory if nothing else is said.
constexpr double kLinkMemoryShare = 1.0 / 3.0;
// Layers may take this share.
constexpr double kLayerShare = 1.0 / 3.0;

} // namespace

std::unique_ptr<Solver> makeSolver(const SolverInput& input, const SolverSettings& settings) {
    SolverSettings complete = settings;
    if (complete.cache.bytes == 0)
        complete.cache.bytes =
            static_cast<uint64_t>(kLinkMemoryShare * static_cast<double>(input.device.freeMemory()));
    if (complete.layers.bytes == 0)
        complete.layers.bytes =
            static_cast<uint64_t>(kLayerShare * static_cast<double>(input.device.freeMemory()));
    if (isPairMethod(settings.method)) return std::make_unique<PairSolver>(input, complete);
    if (settings.layers.on) {
        const std::string tooMany = LayerSolver::problem(input.scene, input.patches, complete.layers.bytes);
        if (!settings.layers.optional || tooMany.empty())
            return std::make_unique<LayerSolver>(input, complete);
        spdlog::warn("all lights are baked as one: {}", tooMany);
    }
    return std::make_unique<LinkSolver>(input, complete);
}

uint64_t solverBytes(uint32_t chunkCount, bool software, const SolverSettings& settings) {
    if (!isPairMethod(settings.method)) return LinkSolver::bytes(chunkCount, software, settings);
    return PairSolver::bytes(chunkCount, software, settings);
}

} // namespace relume
