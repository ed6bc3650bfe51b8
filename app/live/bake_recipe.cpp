#include "app/live/bake_recipe.h"

#include "app/offline/bake_settings.h"

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

} // namespace relume
