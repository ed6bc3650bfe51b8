#pragma once

#include <optional>
#include <span>

#include "assets/base/worker_pool.h"
#include "bake/base/chunk_sums.h"
#include "bake/base/local_error.h"
#include "bake/layers/composite.h"
#include "bake/layers/layer_mixer.h"
#include "bake/layers/layer_schedule.h"

namespace relume {

/// Returns the local error of the composite. `light` holds a patch's light and how large its error may be
/// beside those of others (vec4: R, G, B, and what is proportional to the standard error), `patches` tells
/// which ones are shown and where in a lightmap of `size` x `size` texels, and `error` is the relRMSE of the
/// whole that comes from samples: it says how large all these errors are. They are taken to be normally
/// distributed. All is 0 where nothing is off, and 1 where nothing is lit. `bias` is that of smoothing: it
/// holds for each chunk the sum over its patches of the square of what the mean of R, G and B is off by it,
/// as it was estimated [(cd/m^2)^2]; empty: there is none.
LocalError localErrorOf(WorkerPool& pool, std::span<const glm::vec4> light,
                        std::span<const shader::Patch> patches, uint32_t size, double error,
                        std::span<const double> bias = {});

/// Has the schedule decide how far layers go, and tells how far the composite is off. Its local error takes a
/// pass over all patches: it is measured where it plays a part, but not while somebody turns a light up and
/// down.
class CompositeReport {
public:
    using Layers = LayerSchedule::Layers;

    CompositeReport(LinkKit& kit, const LayerSchedule& schedule, const LayerPass& pass, LayerMixer& mixer)
        : kit_(kit), schedule_(schedule), pass_(pass), mixer_(mixer), chunkSums_(kit.input.device) {}

    /// Decides anew. It is to be called whenever a level has changed and, as `weighedAnew`, when weights
    /// have, or which layers there are.
    void tell(const Layers& layers, SolverProgress& progress, bool weighedAnew = false);
    /// Measures the local error before a bake ends, where that was left out, and decides anew. Tells whether
    /// it has.
    bool tellAtEnd(const Layers& layers, SolverProgress& progress);
    /// Returns the standard error over the w of `light`, the sum of the layers as they are: their errors may
    /// have much in common, which w does not know. It is 1 while a layer is missing.
    double deviation(const Layers& layers, std::span<const glm::vec4> light);

private:
    bool wantsLocalError() const { return !kit_.settings.live || kit_.settings.localError > 0; }
    void measure(const Layers& layers);
    std::vector<CompositeLocal::Worth> worthsOf(const Layers& layers,
                                                const LayerPass::LocalWork& local) const;

    LinkKit& kit_;
    const LayerSchedule& schedule_;
    const LayerPass& pass_;
    LayerMixer& mixer_;
    ChunkSumPass chunkSums_;
    SketchProducts products_;
    std::optional<LocalError> local_;           // of the composite as it is now; none: not measured
    std::vector<CompositeLocal::Worth> worths_; // where it is off too far; else empty
};

} // namespace relume
