#include "app/offline/solve.h"

#include "app/offline/progress.h"
#include "app/text/interrupt.h"
#include "assets/base/error.h"
#include "assets/base/log.h"

#include <algorithm>
#include <array>

namespace relume {
namespace {

// Returns how the bake stands: with link methods directions per patch, rays per second and error; with pair
// methods pass, percent, rays per second, error and the time left, which is that of this pass when only the
// error can end the bake.
std::string progressText(Solver& solver, const SolverSettings& settings) {
    const SolverProgress& p = solver.progress();
    if (!isPairMethod(settings.method)) {
        return fmt::format("{} directions per patch  {:.1f} Mrays/s  error {:.2g}", p.samples,
                           p.seconds > 0 ? static_cast<double>(p.rays) / p.seconds * 1e-6 : 0.0, p.error);
    }
    const double done = p.passes + p.passFraction, perPass = done > 0 ? p.seconds / done : 0.0;
    const bool counted = settings.passes > 0;
    const double left = perPass * (counted ? settings.passes - done : 1.0 - p.passFraction);
    std::string text = counted ? fmt::format("pass {}/{}", p.passes + 1, settings.passes)
                               : fmt::format("pass {}", p.passes + 1);
    text += fmt::format("  {:3.0f} %", 100.0 * p.passFraction);
    if (p.seconds > 0)
        text += fmt::format("  {:.1f} Mrays/s", static_cast<double>(solver.raysSoFar()) / p.seconds * 1e-6);
    if (p.passes >= 2) text += fmt::format("  error {:.2g}", p.error);
    return text + fmt::format("  {} left{}", formatDuration(left), counted ? "" : " in this pass");
}

// Does between two passes, on all ranks, what the first one's clock asks for, or a signal that any of them
// got. Without a file to save to nobody waits for the end of a pass.
void watchTogether(Solver& solver, SolveWatcher& watcher, Ranks& ranks) {
    const bool interrupted = InterruptGuard::requested();
    if (interrupted && !watcher.saves()) watcher.interrupt(solver);
    if (!solver.passBoundary()) return;
    std::array<uint64_t, 2> wishes = {interrupted ? 1u : 0u, ranks.speaks() && watcher.due() ? 1u : 0u};
    ranks.sum(wishes);
    if (wishes[0] + wishes[1] == 0) return;
    if (wishes[0] > 0) watcher.interrupt(solver);
    watcher.afterStep(solver);
}

} // namespace

void warnIfDark(const Scene& scene, const PatchSet& patches) {
    for (uint32_t i = 0; i < patches.count; ++i) {
        const bool emits =
            patches.emission[i].r > 0 || patches.emission[i].g > 0 || patches.emission[i].b > 0;
        if (emits && (patches.scene.patches[i].flags & shader::kPatchSends) != 0) return;
    }
    const bool lit = std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& light) {
        return light.intensity > 0.0f && light.color != glm::vec3(0.0f);
    });
    if (lit || scene.sky.shines()) return;
    spdlog::warn("{}: nothing that has lightmap UVs emits and no light shines, the lightmap will be black: "
                 "add a light "
                 "or give a material an emissive factor",
                 scene.path);
}

void solve(Solver& solver, const SolverSettings& settings, SolveWatcher& watcher, Ranks& ranks) {
    ProgressLine line;
    while (!solver.done()) {
        solver.step();
        if (solver.done()) break;
        if (ranks.alone()) {
            if (InterruptGuard::requested()) watcher.interrupt(solver);
            watcher.afterStep(solver);
        } else {
            watchTogether(solver, watcher, ranks);
        }
        if (line.due()) line.show(progressText(solver, settings));
    }
    if (solver.progress().converged || settings.error == 0) return;
    if (solver.progress().gridError > settings.error) {
        spdlog::warn(
            "the error is still {:.2g}, {:.2g} of it from --indirect-scale {}: choose a smaller one or "
            "raise --error",
            solver.progress().error, solver.progress().gridError, settings.links.indirectScale);
    } else if (!isPairMethod(settings.method) && settings.links.samples == 0) {
        spdlog::warn("the error is still {:.2g} after {} directions per patch: raise --error",
                     solver.progress().error, solver.progress().samples);
    } else if (isPairMethod(settings.method) && settings.passes == 0) {
        spdlog::warn(
            "the error is still {:.2g} after {} passes: lower the albedo or --reflectivity, or raise --error",
            solver.progress().error, solver.progress().passes);
    }
}

void failOnValidation(uint32_t messages) {
    if (messages > 0)
        throw Error(
            fmt::format("{} messages of the validation layers, see above: please report them", messages));
}

} // namespace relume
