#include "bake/layers/error_sketch.h"

namespace relume {

double ErrorSketch::square() const {
    double sum = 0;
    for (const glm::vec3& entry : entries)
        sum += glm::dot(glm::dvec3(entry), glm::dvec3(entry));
    return sum;
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
