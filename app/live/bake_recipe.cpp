#include "app/live/bake_recipe.h"

#include "app/offline/bake_settings.h"
#include "assets/base/log.h"
#include "bake/trace/make_tracer.h"

#include <tuple>

namespace relume {
namespace {

// Tells whether a bake with these settings can have a layer for each light.
bool canHaveLayers(const SolverSettings& s) {
    return s.method == Method::Hybrid && !s.transport.rtrad && s.links.indirectScale == 1 &&
           !s.links.footprint && s.links.directions == DirectionSet::Sobol;
}

// Returns the settings that a baker is made of beside its solver.
auto preparationOf(const BakeSettings& s) {
    const TransportSettings& t = s.solver.transport;
    return std::tuple(s.size, s.conservative, s.tracer, s.voxels.resolution, s.voxels.ratio, t.rtrad,
                      t.reflectivity);
}

} // namespace

BakeSettings bakeable(BakeSettings typed, double batchMs) {
    typed.solver.batchMs = batchMs;
    typed.solver.live = true;
    typed.solver.layers.on = typed.solver.layers.on && canHaveLayers(typed.solver);
    typed.solver.layers.optional = true;
    return typed;
}

bool differOnlyInEdits(const BakeRecipe& baked, const BakeRecipe& wanted) {
    BakeSettings settings = wanted.settings;
    settings.solver.layers = baked.settings.solver.layers;
    const CacheSettings &cache = settings.solver.cache, &before = baked.settings.solver.cache;
    return wanted.surfaces == baked.surfaces &&
           describeSettings(settings) == describeSettings(baked.settings) &&
           settings.tracer == baked.settings.tracer && cache.kind == before.kind &&
           cache.bytes == before.bytes && wanted.rings == baked.rings;
}

bool samePatches(const BakeSettings& a, const BakeSettings& b) {
    return preparationOf(a) == preparationOf(b);
}

std::string settingsProblem(const BakeSettings& settings) {
    const SolverSettings& solver = settings.solver;
    const auto power = [](uint32_t value, uint32_t most) {
        return value > 0 && value <= most && (value & (value - 1)) == 0;
    };
    if (settings.size < 8 || settings.size > Baker::kMaxSize)
        return fmt::format("a lightmap's edge is from 8 to {} texels", Baker::kMaxSize);
    if (solver.transport.rtrad && !isPairMethod(solver.method))
        return fmt::format("RTRad's preset has no {} method: choose another one", methodName(solver.method));
    if (!solver.transport.rtrad && solver.transport.distanceFactor != 1.0f)
        return "the distance factor has a meaning in RTRad's preset only: set it to 1";
    if (!power(solver.pairs.window, 32)) return "a window is a power of two up to 32 texels wide";
    if (!power(solver.pairs.node, 64) || solver.pairs.node < 2)
        return "a node is a power of two from 2 to 64 texels wide";
    if (settings.tracer == TracerKind::Voxel && settings.voxels.ratio != 1)
        return "a share of senders through voxels needs another tracer beside them";
    if (!(solver.transport.reflectivity >= 0 && solver.transport.reflectivity <= 10))
        return "the reflectivity is from 0 to 10";
    if (solver.passes > Solver::kMaxPasses) return fmt::format("at most {} passes", Solver::kMaxPasses);
    return "";
}

} // namespace relume
