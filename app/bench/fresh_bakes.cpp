#include "app/bench/fresh_bakes.h"

#include "app/bench/edited_bake.h"
#include "app/offline/solve.h"
#include "app/text/stopwatch.h"
#include "assets/base/error.h"

namespace relume {
namespace {

// A bake is looked at whenever it has taken this much longer than at the last look: that is finer than the
// times that are told, and makes few looks in all.
constexpr double kLookEvery = 1.05;

} // namespace

FreshBakes::FreshBakes(const vk::Device& device, const Scene& scene, WorldMesh mesh,
                       const BakeSettings& settings)
    : scene_(scene), start_(editsOf(scene)),
      baker_(std::make_unique<Baker>(device, scene_, std::move(mesh), settings)) {}

SceneEdits FreshBakes::under(const std::vector<Light>& lights) const {
    SceneEdits edits = start_;
    edits.lights = lights;
    return edits;
}

PatchLight FreshBakes::bake(const SceneEdits& edits, const SolverSettings& settings) {
    baker_->restart(edits, settings);
    bakeToEnd(baker_->solver());
    return baker_->solver().light();
}

PatchLight FreshBakes::light(const std::vector<Light>& lights, const SolverSettings& settings) {
    return bake(under(lights), settings);
}

PatchLight FreshBakes::lightOfNothingElse(const std::vector<Light>& lights, const SolverSettings& settings) {
    SceneEdits edits = under(lights);
    for (Material& material : edits.materials)
        material.emission = glm::vec3(0.0f);
    edits.sky.radiance = glm::vec3(0.0f);
    return bake(edits, settings);
}

PatchLight FreshBakes::weighedLight(const std::vector<Light>& before, const std::vector<Light>& after,
                                    const SolverSettings& settings) {
    ASSERT(settings.layers.on);
    light(before, settings);
    const Applied applied = baker_->apply({.scene = under(after), .mix = {}});
    ASSERT(applied == Applied::Now);
    bakeToEnd(baker_->solver());
    return baker_->solver().light();
}

FreshBake FreshBakes::measure(const std::vector<Light>& lights, const SolverSettings& settings,
                              const PatchLight& reference) {
    baker_->restart(under(lights), settings);
    Solver& solver = baker_->solver();
    FreshBake bake;
    Stopwatch watch;
    double next = 0; // [s]
    while (!solver.done()) {
        watch([&] { solver.step(); });
        stopIfInterrupted();
        if (!solver.done() && (!solver.passBoundary() || watch.seconds < next)) continue;
        next = kLookEvery * watch.seconds;
        bake.curve.push_back({.seconds = watch.seconds,
                              .layer = {},
                              .composite = compareLight(patches(), solver.light(), reference).relRmse,
                              .told = {}});
    }
    bake.seconds = watch.seconds;
    bake.compositeError = bake.curve.empty() ? 0.0 : bake.curve.back().composite;
    bake.seconds5 = secondsTo(bake.curve, 0.05, false);
    bake.seconds2 = secondsTo(bake.curve, 0.02, false);
    bake.rays = solver.progress().rays;
    return bake;
}

} // namespace relume
