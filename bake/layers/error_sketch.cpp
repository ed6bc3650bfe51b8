#include "bake/layers/error_sketch.h"

#include <algorithm>
#include <atomic>
#include <numeric>

namespace relume {

namespace {

// So many products and biases are kept: all of some hundred layers. Beyond these it begins anew.
constexpr size_t kMostKept = 8192;

glm::dvec3 product(const ErrorSketch& a, const ErrorSketch& b) {
    glm::dvec3 sum(0.0);
    for (size_t k = 0; k < std::min(a.entries.size(), b.entries.size()); ++k)
        sum += glm::dvec3(a.entries[k]) * glm::dvec3(b.entries[k]);
    return sum;
}

template<typename Key, typename Value, typename Make>
Value keptOr(std::map<Key, Value>& kept, const Key& key, const Make& make) {
    const auto known = kept.find(key);
    if (known != kept.end()) return known->second;
    if (kept.size() >= kMostKept) kept.clear();
    return kept.emplace(key, make()).first->second;
}

} // namespace

uint64_t newSketchNumber() {
    static std::atomic<uint64_t> last = 0;
    return ++last;
}

glm::dvec3 SketchProducts::of(const ErrorSketch& a, const ErrorSketch& b) {
    if (a.number == 0 || b.number == 0) return product(a, b);
    return keptOr(products_, std::pair(std::min(a.number, b.number), std::max(a.number, b.number)),
                  [&] { return product(a, b); });
}

double SketchProducts::biasOf(const ErrorSketch& sketch) {
    const auto sum = [&] { return std::accumulate(sketch.bias.begin(), sketch.bias.end(), 0.0); };
    return sketch.number == 0 ? sum() : keptOr(biases_, sketch.number, sum);
}

ErrorSketch sketchOf(WorkerPool& pool, std::span<const shader::Patch> patches, const glm::vec4* sums) {
    using shader::kChunk, shader::kReplicates, shader::kSketchParts, shader::kSketchStride;
    ErrorSketch sketch{std::vector<glm::vec3>(kSketchEntries, glm::vec3(0.0f))};
    pool.run(kSketchStride, [&](uint32_t first) {
        for (size_t chunk = first; chunk < patches.size() / kChunk; chunk += kSketchStride) {
            for (uint32_t lane = 0; lane < kChunk; ++lane) {
                const size_t index = chunk * kChunk + lane;
                if (!shader::patchIsShown(patches[index].flags)) continue;
                glm::vec3 value[kReplicates], mean(0.0f);
                for (uint32_t q = 0; q < kReplicates; ++q)
                    mean += value[q] = glm::vec3(sums[q * patches.size() + index]);
                mean *= 1.0f / static_cast<float>(kReplicates);
                const uint32_t part = lane / (kChunk / kSketchParts);
                glm::vec3* entries = &sketch.entries[(first * kSketchParts + part) * kReplicates];
                const float sign = shader::sketchSign(static_cast<uint32_t>(index));
                for (uint32_t q = 0; q < kReplicates; ++q)
                    entries[q] += sign * (value[q] - mean);
            }
        }
    });
    return sketch;
}

} // namespace relume
