#include "bake/layers/composite_report.h"

#include "assets/base/portions.h"
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

namespace {

// The scale turns a patch's w into how far it is off relative to its light.
struct LocalScale {
    double deviation = 0; // 0: nothing is off
    float least = 1e-30f; // light that is as good as none [cd/m^2]

    double of(const glm::vec4& light) const { return deviation * light.w / std::max(meanOf(light), least); }
};

LocalScale scaleOf(WorkerPool& pool, std::span<const glm::vec4> light, std::span<const shader::Patch> patches,
                   double error) {
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
    if (!(all.light > 0) || !(all.square > 0)) return {};
    return {.deviation = error * (all.light / all.count) / std::sqrt(all.square / all.count),
            .least = static_cast<float>(std::max(kLocalFloor * medianLight(all.lights), 1e-30))};
}

LocalError noiseOf(WorkerPool& pool, std::span<const glm::vec4> light, std::span<const shader::Patch> patches,
                   const LocalScale& scale) {
    if (!(scale.deviation > 0)) return {0, 0, 0, 0};
    const std::vector<Deviations> parts =
        overSlices<Deviations>(pool, patches, [&](size_t i, Deviations& part) {
            ++part.bins[shader::binOf(static_cast<float>(scale.of(light[i])), shader::kLeastErrorOctave,
                                      shader::kErrorBinsPerOctave, shader::kErrorBins)];
        });
    std::vector<double> deviations(shader::kErrorBins);
    for (const Deviations& part : parts)
        for (size_t bin = 0; bin < deviations.size(); ++bin)
            deviations[bin] += part.bins[bin];
    return normalErrorOf(deviations);
}

} // namespace

LocalError localErrorOf(WorkerPool& pool, std::span<const glm::vec4> light,
                        std::span<const shader::Patch> patches, double error) {
    return noiseOf(pool, light, patches, scaleOf(pool, light, patches, error));
}

LocalError localErrorOf(WorkerPool& pool, std::span<const glm::vec4> light,
                        std::span<const shader::Patch> patches, double error, std::span<const double> bias) {
    const LocalScale scale = scaleOf(pool, light, patches, error);
    std::vector<ChunkSquares> chunks(bias.size());
    runPortions(pool, chunks.size(), kSlice / shader::kChunk, [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) {
            double inverse = 0; // sum of squares of what light is relative to, inverted
            for (size_t i = c * shader::kChunk; i < (c + 1) * shader::kChunk; ++i) {
                if (!shader::patchIsShown(patches[i].flags)) continue;
                const double off = scale.of(light[i]), own = std::max(meanOf(light[i]), scale.least);
                chunks[c].texels += 1;
                chunks[c].noise += off * off;
                inverse += 1.0 / (own * own);
            }
            if (chunks[c].texels > 0) chunks[c].bias = bias[c] * inverse / chunks[c].texels;
        }
    });
    return withBias(pool, noiseOf(pool, light, patches, scale), chunks);
}

namespace {

// Returns the bias of smoothing of the layers' sum for each chunk, as localErrorOf() takes it; empty where no
// layer knows its own. `alike` is as of Composite: biases have as much in common as errors.
std::vector<double> biasOf(std::span<Layer* const> layers, double alike) {
    std::vector<double> bias;
    for (const Layer* layer : layers) {
        const glm::dvec3 weight(layer->source.weight);
        // The bias of the mean of R, G and B is a third of that of the three together, if they go alike.
        const double share = alike * glm::dot(weight, weight) / 3.0 / 3.0;
        bias.resize(std::max(bias.size(), layer->sketch.bias.size()), 0.0);
        for (size_t c = 0; c < layer->sketch.bias.size(); ++c)
            bias[c] += share * layer->sketch.bias[c];
    }
    return bias;
}

} // namespace

void CompositeReport::tell(const Layers& layers, SolverProgress& progress, bool weighedAnew) {
    local_.reset();
    worths_.clear();
    if (!weighedAnew && wantsLocalError() && schedule_.areTogether(layers)) measure(layers);
    const CompositeLocal local{.error = local_ ? local_->p95 : 1.0, .worths = worths_};
    schedule_.apportion(layers, weighedAnew, local_ ? &local : nullptr);
    const LayerSchedule::Told told =
        schedule_.told(layers, local_ ? std::optional(local_->p95) : std::nullopt);
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
    const double square = composite.error * composite.error - composite.iteration * composite.iteration -
                          composite.bias * composite.bias;
    const std::vector<double> bias = biasOf(shining, composite.alike);
    WorkerPool& pool = kit_.input.device.workers();
    const std::vector<glm::vec4>& light = mixer_.light(layers);
    const std::vector<shader::Patch>& patches = kit_.input.patches.scene.patches;
    const double error = std::sqrt(std::max(0.0, square));
    local_ = bias.empty() ? localErrorOf(pool, light, patches, error)
                          : localErrorOf(pool, light, patches, error, bias);
    const double asked = kit_.settings.localError;
    if (asked > 0 && local_->p95 > asked) worths_ = worthsOf(layers, error);
}

// Asks the device what the variances of each layer are worth where they are. The mixer has mixed the
// composite.
std::vector<CompositeLocal::Worth> CompositeReport::worthsOf(const Layers& layers, double error) const {
    const vk::Device& device = kit_.input.device;
    const LocalScale scale =
        scaleOf(device.workers(), mixer_.light(layers), kit_.input.patches.scene.patches, error);
    const LayerPass::WorthWork work{.composite = mixer_.composite(),
                                    .deviation = static_cast<float>(scale.deviation),
                                    .least = scale.least,
                                    .aim = static_cast<float>(local_->p95)};
    const vk::Buffer sums(
        device,
        {.size = layers.size() * sizeof(glm::vec4), .memory = vk::Memory::Host, .name = "worths of layers"});
    VkCommandBuffer cmd = kit_.commands.begin();
    for (size_t i = 0; i < layers.size(); ++i) {
        sums.as<glm::vec4>()[i] = glm::vec4(0.0f);
        if (!layers[i]->shines() || !layers[i]->has()) continue;
        pass_.recordWorth(cmd, kit_.input.light, *layers[i], work, kit_.buffers.chunkSums);
        vk::barrier(cmd);
        chunkSums_.record(cmd, {.values = kit_.buffers.chunkSums.address(),
                                .sums = sums.address() + i * sizeof(glm::vec4),
                                .chunkCount = kit_.chunkCount(),
                                .width = 4});
        vk::barrier(cmd);
    }
    kit_.run(cmd);
    const auto mean = [](double worth, double variance) { return variance > 0 ? worth / variance : 0.0; };
    std::vector<CompositeLocal::Worth> worths;
    for (const glm::vec4& sum : std::span(sums.as<glm::vec4>(), layers.size()))
        worths.push_back({mean(sum.x, sum.z), mean(sum.y, sum.w)});
    return worths;
}

} // namespace relume
