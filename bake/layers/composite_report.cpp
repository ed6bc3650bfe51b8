#include "bake/layers/composite_report.h"
#include "bake/layers/composite.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace relume {
namespace {

// Slices are the same however many threads there are, so that sums round alike.
constexpr size_t kSlice = 4096;

struct Slice {
    double light = 0, square = 0, count = 0;
    std::array<uint32_t, shader::kLightBins> lights{};
};
struct Deviations {
    std::array<uint32_t, shader::kErrorBins> bins{};
};

float meanOf(const glm::vec4& light) {
    return (light.r + light.g + light.b) / 3.0f;
}

// Calls function(patch index, slice) for each patch that is shown.
template<typename Part, typename Function>
std::vector<Part> overSlices(WorkerPool& pool, std::span<const shader::Patch> patches, Function&& function) {
    std::vector<Part> parts((patches.size() + kSlice - 1) / kSlice);
    pool.run(static_cast<uint32_t>(parts.size()), [&](uint32_t k) {
        const size_t end = std::min(patches.size(), (size_t{k} + 1) * kSlice);
        for (size_t i = size_t{k} * kSlice; i < end; ++i)
            if (shader::patchIsShown(patches[i].flags)) function(i, parts[k]);
    });
    return parts;
}

} // namespace

LocalError localErrorOf(WorkerPool& pool, std::span<const glm::vec4> light,
                        std::span<const shader::Patch> patches, double error) {
    const std::vector<Slice> slices = overSlices<Slice>(pool, patches, [&](size_t i, Slice& slice) {
        const float own = meanOf(light[i]);
        slice.light += own;
        slice.square += double{light[i].w} * light[i].w;
        slice.count += 1;
        ++slice.lights[shader::binOf(own, shader::kLeastLightOctave, shader::kLightBinsPerOctave,
                                     shader::kLightBins)];
    });
    Slice all;
    for (const Slice& slice : slices) {
        all.light += slice.light;
        all.square += slice.square;
        all.count += slice.count;
        for (size_t bin = 0; bin < all.lights.size(); ++bin)
            all.lights[bin] += slice.lights[bin];
    }
    if (!(all.light > 0) || !(all.square > 0)) return {0, 0, 0, 0};
    const double scale = error * (all.light / all.count) / std::sqrt(all.square / all.count);
    const auto least = static_cast<float>(std::max(kLocalFloor * medianLight(all.lights), 1e-30));
    const std::vector<Deviations> parts =
        overSlices<Deviations>(pool, patches, [&](size_t i, Deviations& part) {
            const double deviation = scale * light[i].w / std::max(meanOf(light[i]), least);
            ++part.bins[shader::binOf(static_cast<float>(deviation), shader::kLeastErrorOctave,
                                      shader::kErrorBinsPerOctave, shader::kErrorBins)];
        });
    std::vector<double> deviations(shader::kErrorBins);
    for (const Deviations& part : parts)
        for (size_t bin = 0; bin < deviations.size(); ++bin)
            deviations[bin] += part.bins[bin];
    return normalErrorOf(deviations);
}

void CompositeReport::tell(const Layers& layers, SolverProgress& progress, bool weighedAnew) {
    local_.reset();
    if (!weighedAnew && wantsLocalError() && schedule_.areTogether(layers)) measure(layers);
    const std::optional<double> local = local_ ? std::optional(local_->p95) : std::nullopt;
    schedule_.apportion(layers, weighedAnew, local);
    const LayerSchedule::Told told = schedule_.told(layers, local);
    progress.error = told.error;
    progress.converged = told.converged;
    progress.localError95 = local_ ? local_->p95 : 1.0;
    progress.localError99 = local_ ? local_->p99 : 1.0;
}

bool CompositeReport::tellAtEnd(const Layers& layers, SolverProgress& progress) {
    if (local_ || !wantsLocalError() || !schedule_.areTogether(layers)) return false;
    tell(layers, progress);
    return true;
}

void CompositeReport::measure(const Layers& layers) {
    std::vector<Layer*> shining;
    for (const std::unique_ptr<Layer>& layer : layers)
        if (layer->shines()) shining.push_back(layer.get());
    const Composite composite = compositeOf(shining);
    const double square = composite.error * composite.error - composite.iteration * composite.iteration;
    local_ = localErrorOf(kit_.input.device.workers(), mixer_.light(layers), kit_.input.patches.scene.patches,
                          std::sqrt(std::max(0.0, square)));
}

} // namespace relume
