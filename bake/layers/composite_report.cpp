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

float meanOf(const glm::vec4& light) {
    return (light.r + light.g + light.b) / 3.0f;
}

// Sums over texels that are shown, and counts of them by their light.
struct Shown {
    double count = 0, light = 0, square = 0; // square: of w
    std::vector<uint32_t> lights;            // [kLightBins]
};

// The scale turns a patch's w into how far it is off relative to its light.
struct LocalScale {
    double deviation = 0; // 0: nothing is off
    float least = 1e-30f; // light that is as good as none [cd/m^2]

    double of(const glm::vec4& light) const { return deviation * light.w / std::max(meanOf(light), least); }
};

// Counts of texels by how far they are off, and sums over them for each chunk.
struct Deviations {
    std::vector<double> bins;         // [kErrorBins]
    std::vector<ChunkSquares> chunks; // without the bias
    std::vector<double> squares;      // of how far off the light is, not relative to it, per chunk
};

LayerPass::LocalWork workOf(const vk::Buffer& composite, const LocalScale& scale, uint32_t size) {
    return {composite, static_cast<float>(scale.deviation), scale.least, size};
}

LocalScale scaleOf(const Shown& all, double error) {
    if (!(all.light > 0) || !(all.square > 0)) return {};
    return {.deviation = error * (all.light / all.count) / std::sqrt(all.square / all.count),
            .least = static_cast<float>(std::max(kLocalFloor * medianLight(all.lights), 1e-30))};
}

// Takes the bias of smoothing along, where there is any. In a chunk at the edge of a pool of light it lies
// where noise does: were it the same in all of its texels, that would be many times a dark one's own light.
LocalError localErrorOf(WorkerPool& pool, Deviations off, std::span<const double> bias) {
    const LocalError noise = normalErrorOf(off.bins);
    if (bias.empty()) return noise;
    for (size_t c = 0; c < std::min(bias.size(), off.chunks.size()); ++c)
        if (off.squares[c] > 0) off.chunks[c].bias = bias[c] * off.chunks[c].noise / off.squares[c];
    return withBias(pool, noise, off.chunks);
}

// Slices are the same however many threads there are, so that sums round alike.
constexpr size_t kSlice = 4096;
static_assert(kSlice % shader::kChunk == 0);

// Calls function(first patch, patches, slice) for each chunk of so many patches in all.
template<typename Part, typename Function>
std::vector<Part> overSlices(WorkerPool& pool, size_t patches, Function&& function) {
    std::vector<Part> parts((patches + kSlice - 1) / kSlice);
    pool.run(static_cast<uint32_t>(parts.size()), [&](uint32_t k) {
        const size_t end = std::min(patches, (size_t{k} + 1) * kSlice);
        for (size_t first = size_t{k} * kSlice; first < end; first += shader::kChunk)
            function(first, std::min<size_t>(shader::kChunk, end - first), parts[k]);
    });
    return parts;
}

Shown shownOf(WorkerPool& pool, std::span<const glm::vec4> light, std::span<const shader::Patch> patches) {
    struct Slice {
        double light = 0, square = 0, count = 0;
        std::array<uint32_t, shader::kLightBins> lights{};
    };
    const auto add = [&](size_t first, size_t count, Slice& slice) {
        for (size_t i = first; i < first + count; ++i) {
            if (!shader::patchIsShown(patches[i].flags)) continue;
            const float own = meanOf(light[i]);
            slice.light += own;
            slice.square += double{light[i].w} * light[i].w;
            slice.count += 1;
            ++slice.lights[shader::binOf(own, shader::kLeastLightOctave, shader::kLightBinsPerOctave,
                                         shader::kLightBins)];
        }
    };
    const std::vector<Slice> slices = overSlices<Slice>(pool, patches.size(), add);
    Shown all{.lights = std::vector<uint32_t>(shader::kLightBins, 0)};
    for (const Slice& slice : slices) {
        all.light += slice.light;
        all.square += slice.square;
        all.count += slice.count;
        for (size_t bin = 0; bin < all.lights.size(); ++bin)
            all.lights[bin] += slice.lights[bin];
    }
    return all;
}

// Returns the square of how far each of these texels of a chunk is off relative to its light, as the mean
// over itself and those next to it: in the edge of a shadow few of a lamp's points are seen, and the
// replicates of many a texel agree by chance. layer_local.comp does the same.
std::array<double, shader::kChunk> squaresOf(std::span<const glm::vec4> light,
                                             std::span<const shader::Patch> patches, uint32_t size,
                                             const LocalScale& scale) {
    std::array<double, shader::kChunk> own{}, mean{};
    std::array<uint32_t, shader::kChunk> texels{};
    for (size_t i = 0; i < patches.size(); ++i) {
        const double off = scale.of(light[i]);
        own[i] = off * off;
        texels[i] =
            shader::patchIsShown(patches[i].flags) ? shader::patchTexel(patches[i].flags) : shader::kNoTexel;
    }
    for (size_t i = 0; i < patches.size(); ++i) {
        uint32_t count = 0;
        const size_t end = std::min<size_t>(patches.size(), i + shader::kTileReach + 1);
        for (size_t k = i - std::min<size_t>(i, shader::kTileReach); k < end; ++k) {
            if (!shader::texelsTouch(texels[i], texels[k], size)) continue;
            mean[i] += own[k];
            ++count;
        }
        mean[i] /= std::max(count, 1u);
    }
    return mean;
}

Deviations deviationsOf(WorkerPool& pool, std::span<const glm::vec4> light,
                        std::span<const shader::Patch> patches, uint32_t size, const LocalScale& scale) {
    const size_t chunks = (patches.size() + shader::kChunk - 1) / shader::kChunk;
    Deviations all{std::vector<double>(shader::kErrorBins, 0.0), std::vector<ChunkSquares>(chunks),
                   std::vector<double>(chunks, 0.0)};
    struct Bins {
        std::array<uint32_t, shader::kErrorBins> bins{};
    };
    const auto add = [&](size_t first, size_t count, Bins& part) {
        const auto squares =
            squaresOf(light.subspan(first, count), patches.subspan(first, count), size, scale);
        ChunkSquares& chunk = all.chunks[first / shader::kChunk];
        for (size_t i = 0; i < count; ++i) {
            if (!shader::patchIsShown(patches[first + i].flags)) continue;
            const double absolute = scale.deviation * light[first + i].w;
            ++part.bins[shader::binOf(static_cast<float>(std::sqrt(squares[i])), shader::kLeastErrorOctave,
                                      shader::kErrorBinsPerOctave, shader::kErrorBins)];
            chunk.texels += 1;
            chunk.noise += squares[i];
            all.squares[first / shader::kChunk] += absolute * absolute;
        }
    };
    const std::vector<Bins> parts = overSlices<Bins>(pool, patches.size(), add);
    for (const Bins& part : parts)
        for (size_t bin = 0; bin < all.bins.size(); ++bin)
            all.bins[bin] += part.bins[bin];
    return all;
}

} // namespace

LocalError localErrorOf(WorkerPool& pool, std::span<const glm::vec4> light,
                        std::span<const shader::Patch> patches, uint32_t size, double error,
                        std::span<const double> bias) {
    const LocalScale scale = scaleOf(shownOf(pool, light, patches), error);
    return localErrorOf(pool, deviationsOf(pool, light, patches, size, scale), bias);
}

namespace {

// Has the device count a composite that is there.
class DeviceCounts {
public:
    DeviceCounts(LinkKit& kit, const LayerPass& pass, const vk::Buffer& composite)
        : kit_(kit), pass_(pass), composite_(composite),
          bins_(kit.input.device,
                {.size = uint64_t{kBins} * sizeof(uint32_t), .name = "counts of the composite's texels"}) {}

    Shown shown(const ChunkSumPass& chunkSums) const {
        const vk::Buffer sums(kit_.input.device, {.size = sizeof(glm::vec4),
                                                  .memory = vk::Memory::Host,
                                                  .name = "sums of the composite's texels"});
        count({}, [&](VkCommandBuffer cmd) {
            vk::barrier(cmd);
            chunkSums.record(cmd, {.values = kit_.buffers.chunkSums.address(),
                                   .sums = sums.address(),
                                   .chunkCount = kit_.chunkCount(),
                                   .width = 4});
        });
        const glm::vec4 sum = *sums.as<glm::vec4>();
        return {.count = sum.x, .light = sum.y, .square = sum.z, .lights = binsFrom(0, shader::kLightBins)};
    }

    // Sums of each chunk are told where they are wanted.
    Deviations deviations(const LocalScale& scale, bool byChunk) const {
        constexpr double kNothing = 1e-30; // is counted as not off
        count({.deviation = std::max(scale.deviation, kNothing), .least = scale.least},
              [](VkCommandBuffer) {});
        const std::vector<uint32_t> counts = binsFrom(shader::kLightBins, shader::kErrorBins);
        Deviations all{.bins = {counts.begin(), counts.end()}};
        if (!byChunk) return all;
        const auto sums =
            vk::readBuffer<glm::vec4>(kit_.input.device, kit_.buffers.chunkSums, kit_.chunkCount());
        for (const glm::vec4& sum : sums) {
            all.chunks.push_back({.texels = sum.x, .noise = sum.y});
            all.squares.push_back(scale.deviation * scale.deviation * sum.z);
        }
        return all;
    }

private:
    static constexpr uint32_t kBins = shader::kBinCopies * shader::kBinsOfCopy;

    template<typename Record>
    void count(const LocalScale& scale, const Record& recordMore) const {
        VkCommandBuffer cmd = kit_.commands.begin();
        pass_.recordLocal(cmd, kit_.input.light, workOf(composite_, scale, kit_.input.patches.scene.size),
                          bins_, kit_.buffers.chunkSums);
        recordMore(cmd);
        kit_.run(cmd);
    }

    // Returns the sums over all copies of these bins.
    std::vector<uint32_t> binsFrom(uint32_t first, uint32_t count) const {
        const auto all = vk::readBuffer<uint32_t>(kit_.input.device, bins_, kBins);
        std::vector<uint32_t> bins(count, 0);
        for (uint32_t copy = 0; copy < shader::kBinCopies; ++copy)
            for (uint32_t i = 0; i < count; ++i)
                bins[i] += all[copy * shader::kBinsOfCopy + first + i];
        return bins;
    }

    LinkKit& kit_;
    const LayerPass& pass_;
    const vk::Buffer& composite_;
    vk::Buffer bins_;
};

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
    schedule_.apportion(layers, weighedAnew, local_ ? &local : nullptr, &products_);
    const LayerSchedule::Told told =
        schedule_.told(layers, local_ ? std::optional(local_->p95) : std::nullopt, &products_);
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

namespace {

std::vector<Layer*> shiningOf(const CompositeReport::Layers& layers) {
    std::vector<Layer*> shining;
    for (const std::unique_ptr<Layer>& layer : layers)
        if (layer->shines()) shining.push_back(layer.get());
    return shining;
}

// Returns what of the composite's relRMSE comes from samples.
double sampledError(const Composite& composite) {
    const double square = composite.error * composite.error - composite.iteration * composite.iteration -
                          composite.bias * composite.bias;
    return std::sqrt(std::max(0.0, square));
}

} // namespace

double CompositeReport::deviation(const Layers& layers, std::span<const glm::vec4> light) {
    const std::vector<Layer*> shining = shiningOf(layers);
    if (!std::all_of(shining.begin(), shining.end(), [](const Layer* layer) { return layer->has(); }))
        return 1.0;
    const Composite composite = compositeOf(shining, &products_);
    WorkerPool& pool = kit_.input.device.workers();
    return scaleOf(shownOf(pool, light, kit_.input.patches.scene.patches), sampledError(composite)).deviation;
}

void CompositeReport::measure(const Layers& layers) {
    const std::vector<Layer*> shining = shiningOf(layers);
    const Composite composite = compositeOf(shining, &products_);
    const std::vector<double> bias = biasOf(shining, composite.alike);
    WorkerPool& pool = kit_.input.device.workers();
    const double error = sampledError(composite);
    const uint32_t size = kit_.input.patches.scene.size;
    LocalScale scale;
    if (kit_.gatherPass.onCpu()) {
        const std::vector<glm::vec4>& light = mixer_.light(layers);
        const std::vector<shader::Patch>& patches = kit_.input.patches.scene.patches;
        scale = scaleOf(shownOf(pool, light, patches), error);
        local_ = localErrorOf(pool, deviationsOf(pool, light, patches, size, scale), bias);
    } else {
        const DeviceCounts counts(kit_, pass_, mixer_.mixed(layers));
        scale = scaleOf(counts.shown(chunkSums_), error);
        local_ = localErrorOf(pool, counts.deviations(scale, !bias.empty()), bias);
    }
    const double asked = kit_.settings.localError;
    if (asked > 0 && local_->p95 > asked) worths_ = worthsOf(layers, workOf(mixer_.composite(), scale, size));
}

// Asks the device what the variances of each layer are worth where they are. The mixer has mixed the
// composite.
std::vector<CompositeLocal::Worth> CompositeReport::worthsOf(const Layers& layers,
                                                             const LayerPass::LocalWork& local) const {
    const vk::Device& device = kit_.input.device;
    const LayerPass::WorthWork work{.local = local, .aim = static_cast<float>(local_->p95)};
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
