#include "bake/gather/host_resolve.h"

#include "assets/base/portions.h"
#include "bake/base/host_lanes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace relume {
namespace {

using shader::kChunk;
using shader::kReplicates;
using shader::Patch;

using Replicates = std::array<Float4, kReplicates>; // R, G, B and 0

[[gnu::always_inline]] inline void mean(Float4& out, const Replicates& v) {
    out = 0.25f * (v[0] + v[1] + v[2] + v[3]);
}

float sumOfSquares(const Float4& v) {
    const Float4 squares = v * v;
    return squares[0] + squares[1] + squares[2];
}

// Returns what spread() of lib/replicates.glsl does.
float spread(const Replicates& v) {
    Float4 middle, sum{};
    mean(middle, v);
    for (const Float4& one : v)
        sum += (one - middle) * (one - middle);
    return (sum[0] + sum[1] + sum[2]) / static_cast<float>(kReplicates * (kReplicates - 1));
}

// A patch's indirect light in each replicate: as it was found, smoothed, and how far smoothing moves it.
struct Indirect {
    Replicates raw{}, smoothed{}, moved{};

    // The scales lead from sums over links, and from what they are when smoothed, to their means; where there
    // are no links nobody has made sums.
    Indirect(const HostSmoothing& work, size_t index, bool smooths, float scale, float rowScale) {
        if (scale == 0.0f && !smooths) return;
        const size_t count = size_t{work.chunkCount} * kChunk;
        for (size_t q = 0; q < kReplicates; ++q) {
            load(raw[q], work.sums[q * count + index]);
            raw[q] *= scale;
            smoothed[q] = raw[q];
            if (!smooths) continue;
            load(smoothed[q], work.rows[q * count + index]);
            smoothed[q] *= rowScale;
            moved[q] = smoothed[q] - raw[q];
        }
    }
};

// Tells whether the patch's texel is its own; else it stands for a whole thin chart, and is not smoothed.
bool isSmoothed(const HostSmoothing& work, size_t index) {
    return work.reach > 0 && work.texelToPatch[shader::patchTexel(work.patches[index].flags)] == index;
}

void resolveLayerChunk(const LayerResolve& work, uint32_t chunk, shader::ResolveSums& indirectSums,
                       glm::vec4& resultSums) {
    for (size_t index = size_t{chunk} * kChunk, end = index + kChunk; index < end; ++index) {
        const bool smooths = isSmoothed(work.smoothing, index);
        const Indirect v(work.smoothing, index, smooths, work.scale, work.scale);
        Float4 indirect, move;
        mean(indirect, v.smoothed);
        mean(move, v.moved);
        indirect = indirect > 0.0f ? indirect : Float4{}; // weights of both signs may end a little below
        const float variance = spread(v.smoothed);
        const glm::vec4& direct = work.direct[index];
        const glm::vec3 light = glm::vec3(direct) + glm::vec3(indirect[0], indirect[1], indirect[2]);
        work.result[index] = glm::vec4(light, std::sqrt((direct.w + variance) / 3.0f));
        if (!shader::patchIsShown(work.smoothing.patches[index].flags)) continue;
        indirectSums.light += indirect[0] + indirect[1] + indirect[2];
        indirectSums.indirect += variance;
        indirectSums.raw += smooths ? spread(v.raw) : variance;
        indirectSums.bias += smooths ? sumOfSquares(move) - spread(v.moved) : 0.0f;
        indirectSums.count += 1.0f;
        resultSums += glm::vec4(light.r + light.g + light.b, direct.w, 1.0f, 0.0f);
    }
}

float channelMean(const Float4& v) {
    return (v[0] + v[1] + v[2]) / 3.0f;
}

// Returns what contrasts() of resolve.comp does.
glm::vec3 contrasts(const Replicates& v) {
    const float a = channelMean(v[0]), b = channelMean(v[1]), c = channelMean(v[2]), d = channelMean(v[3]);
    return 0.25f * glm::vec3(a + b - c - d, a - b + c - d, a - b - c + d);
}

struct Bins {
    std::array<uint32_t, shader::kLightBins> lights{};
    std::array<uint32_t, shader::kErrorBins> errors{};
};

// Resolves chunks of a link solver, and counts their texels.
class LinkResolver {
public:
    explicit LinkResolver(const LinkResolve& work) : work_(work) {}

    void run(uint32_t chunk, Bins& bins) const {
        const HostSmoothing& smoothing = work_.smoothing;
        const glm::vec2 scales =
            smoothing.scales ? smoothing.scales[chunk] : glm::vec2(work_.scale, work_.directScale);
        const float rowScale = smoothing.scales ? 1.0f : work_.scale; // else rows are of means
        shader::ResolveSums sums{};
        shader::LocalSums local{};
        for (size_t index = size_t{chunk} * kChunk, end = index + kChunk; index < end; ++index) {
            const bool smooths = isSmoothed(smoothing, index);
            const Indirect indirect(smoothing, index, smooths, scales.x, rowScale);
            const Replicates direct = directOf(index, scales.y);
            Float4 light, own;
            mean(light, direct);
            mean(own, indirect.smoothed);
            light += own;
            light = light > 0.0f ? light : Float4{}; // weights of both signs may end a little below
            const float directVariance = spread(direct), variance = spread(indirect.smoothed);
            work_.result[index] = {light[0], light[1], light[2],
                                   std::sqrt((directVariance + variance) / 3.0f)};
            if (!shader::patchIsShown(smoothing.patches[index].flags)) continue;
            Float4 move;
            mean(move, indirect.moved);
            sums.light += light[0] + light[1] + light[2];
            sums.direct += directVariance;
            sums.indirect += variance;
            sums.raw += smooths ? spread(indirect.raw) : variance;
            sums.bias += smooths ? sumOfSquares(move) - spread(indirect.moved) : 0.0f;
            sums.count += 1.0f;
            count(channelMean(light), direct, indirect, bins, local);
        }
        work_.sums[chunk] = sums;
        work_.local[chunk] = local;
    }

private:
    Replicates directOf(size_t index, float scale) const {
        Replicates direct{};
        for (size_t q = 0; q < kReplicates && work_.directSums; ++q) {
            load(direct[q], work_.directSums[q * work_.smoothing.chunkCount * kChunk + index]);
            direct[q] *= scale;
        }
        return direct;
    }

    // Takes note of the light of a texel that is shown, and of how far it is off, as localTerm() of
    // resolve.comp does.
    void count(float light, const Replicates& direct, const Indirect& indirect, Bins& bins,
               shader::LocalSums& local) const {
        const float relativeTo = std::max({light, work_.floor, 1e-30f});
        ++bins.lights[shader::binOf(light, shader::kLeastLightOctave, shader::kLightBinsPerOctave,
                                    shader::kLightBins)];
        const glm::vec3 directOff = contrasts(direct), off = contrasts(indirect.smoothed),
                        moves = contrasts(indirect.moved);
        for (int k = 0; k < 3; ++k)
            ++bins.errors[shader::binOf(std::abs(directOff[k] + off[k]) / relativeTo,
                                        shader::kLeastErrorOctave, shader::kErrorBinsPerOctave,
                                        shader::kErrorBins)];
        Float4 moved;
        mean(moved, indirect.moved);
        const float move = channelMean(moved), square = relativeTo * relativeTo;
        local.direct += glm::dot(directOff, directOff) / (3.0f * square);
        local.indirect += glm::dot(off, off) / (3.0f * square);
        local.bias += (move * move - glm::dot(moves, moves) / 3.0f) / square;
        // Replicates know nothing of each other, so the mean of this product is what they have in common.
        float fourth = 1.0f;
        for (const Float4& one : indirect.moved)
            fourth *= channelMean(one) / relativeTo;
        local.fourth += fourth;
    }

    const LinkResolve& work_;
};

} // namespace

LayerResolveSums resolveLayer(WorkerPool& pool, const LayerResolve& work) {
    const uint32_t chunks = work.smoothing.chunkCount;
    if (work.smoothing.reach > 0) smoothOnHost(pool, work.smoothing);
    LayerResolveSums sums{std::vector<shader::ResolveSums>(chunks),
                          std::vector<glm::vec4>(chunks, glm::vec4(0.0f))};
    pool.run(chunks, [&](uint32_t chunk) {
        resolveLayerChunk(work, chunk, sums.indirect[chunk], sums.result[chunk]);
    });
    return sums;
}

void resolveLinks(WorkerPool& pool, const LinkResolve& work) {
    constexpr size_t kLeast = 64, kMostPortions = 256; // bins are 7 kB per portion
    const size_t chunks = work.smoothing.chunkCount;
    const size_t portion = std::max(kLeast, (chunks + kMostPortions - 1) / kMostPortions);
    const std::span<const uint8_t> wanted = work.smoothing.chunks;
    if (work.smoothing.reach > 0) smoothOnHost(pool, work.smoothing);
    std::vector<Bins> counts((chunks + portion - 1) / portion);
    const LinkResolver resolver(work);
    runPortions(pool, chunks, portion, [&](size_t begin, size_t end) {
        for (size_t chunk = begin; chunk < end; ++chunk)
            if (wanted.empty() || wanted[chunk] != 0)
                resolver.run(static_cast<uint32_t>(chunk), counts[begin / portion]);
    });
    std::fill_n(work.lightBins, shader::kLightBins, 0);
    std::fill_n(work.errorBins, shader::kErrorBins, 0);
    for (const Bins& bins : counts) {
        std::transform(bins.lights.begin(), bins.lights.end(), work.lightBins, work.lightBins, std::plus());
        std::transform(bins.errors.begin(), bins.errors.end(), work.errorBins, work.errorBins, std::plus());
    }
}

} // namespace relume
