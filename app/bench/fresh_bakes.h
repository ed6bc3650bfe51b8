#pragma once

#include <memory>
#include <vector>

#include "app/bench/edits_report.h"
#include "app/bench/light_difference.h"
#include "bake/baker/baker.h"

namespace relume {

/// Bakes one scene from nothing, one bake after the other, under any lights.
class FreshBakes {
public:
    /// Makes the baker. Throws Error.
    FreshBakes(const vk::Device& device, const Scene& scene, WorldMesh mesh, const BakeSettings& settings);

    const PatchSet& patches() const { return baker_->patches(); }
    PatchLight light(const std::vector<Light>& lights, const SolverSettings& settings);
    /// Returns the light while neither materials nor sky shine.
    PatchLight lightOfNothingElse(const std::vector<Light>& lights, const SolverSettings& settings);
    /// Returns the light of a bake in layers under `before`, then weighed like `after`, which differs in
    /// intensity and colour.
    PatchLight weighedLight(const std::vector<Light>& before, const std::vector<Light>& after,
                            const SolverSettings& settings);
    /// Measures error over time, where only step() counts as time and looking at the light does not.
    FreshBake measure(const std::vector<Light>& lights, const SolverSettings& settings,
                      const PatchLight& reference);

private:
    SceneEdits under(const std::vector<Light>& lights) const;
    PatchLight bake(const SceneEdits& edits, const SolverSettings& settings);

    Scene scene_;      // which the baker edits
    SceneEdits start_; // of the scene, as it came
    std::unique_ptr<Baker> baker_;
};

} // namespace relume
