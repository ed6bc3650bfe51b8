#include "bake/baker/edit_decision.h"

#include <algorithm>

namespace relume {
namespace {

bool sameColours(const std::vector<Material>& a, const std::vector<Material>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Material& x, const Material& y) {
        return x.baseColor == y.baseColor && x.emission == y.emission;
    });
}

// Tells whether the difference between the materials can be followed without making patches anew: these
// depend on what is masked, and only a double-sided surface that shines has patches on its back.
bool sameForPatches(const std::vector<Material>& a, const std::vector<Material>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Material& x, const Material& y) {
        const bool shines = x.emission != glm::vec3(0.0f), shone = y.emission != glm::vec3(0.0f);
        return x.baseColor.a == y.baseColor.a && (shines == shone || !x.doubleSided);
    });
}

bool samePlacements(const std::vector<Instance>& instances, const std::vector<Placement>& placements) {
    return std::equal(instances.begin(), instances.end(), placements.begin(), placements.end(),
                      [](const Instance& instance, const Placement& placement) {
                          return Placement{instance.transform, instance.hidden} == placement;
                      });
}

} // namespace

SceneDifference differenceBetween(const Scene& baked, const SceneEdits& wanted) {
    const SkySettings& sky = baked.sky;
    return {.lights = wanted.lights != baked.lights || wanted.sky != sky,
            .colours = !sameColours(wanted.materials, baked.materials),
            .objects = !samePlacements(baked.instances, wanted.placements),
            .patches = wanted.sky.file != sky.file || !sameForPatches(wanted.materials, baked.materials) ||
                       wanted.placements.size() != baked.instances.size()};
}

Applied decideEdit(const SceneDifference& difference, const BakeReadiness& readiness) {
    if (!readiness.follows) return Applied::NeedsNewBake;
    if (!difference.any()) return Applied::Now;
    if (!readiness.fits || difference.patches) return Applied::NeedsNewBake;
    const bool waits = difference.colours || difference.objects;
    return waits && !readiness.atRest ? Applied::Later : Applied::Now;
}

} // namespace relume
