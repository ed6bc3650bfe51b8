#pragma once

#include <map>
#include <span>
#include <utility>
#include <vector>

#include "assets/base/worker_pool.h"
#include "bake/base/shader_types.h"

namespace relume {

constexpr uint32_t kSketchEntries = shader::kSketchStride * shader::kSketchParts * shader::kReplicates;
// A GPU's sketch is read back behind sums, and the sums of each chunk behind it [bytes].
constexpr uint64_t kSketchAt = 256, kLevelSumsAt = kSketchAt + kSketchEntries * sizeof(glm::vec3);

/// The error of a layer's indirect light in a few numbers: how far each replicate is from their mean, summed
/// over patches that share an entry, each with a random sign. What two layers' sketches have in common (the
/// sum of the products of their entries) is in the mean what their errors have in common. Layers see through
/// the same links, so that this is much, but it is seldom all.
struct ErrorSketch {
    std::vector<glm::vec3> entries; // [group][replicate], as SketchPush has it
    // How far smoothing moves each chunk's light beyond what noise explains (ResolveSums::bias); empty:
    // nothing is smoothed, or it is not known.
    std::vector<float> bias;
    uint64_t number = 0; // another one for other contents (newSketchNumber); 0: nothing is kept of it

    bool empty() const { return entries.empty(); }
};

/// Returns a number that no sketch has had.
uint64_t newSketchNumber();

/// Finds what sketches have in common, and keeps it: weights change more often than they do, and how far any
/// mixture of layers is off hangs on these products alone.
class SketchProducts {
public:
    /// Returns the sums of the products of their entries, one for each channel.
    glm::dvec3 of(const ErrorSketch& a, const ErrorSketch& b);
    /// Returns the sum over all chunks of a sketch's bias.
    double biasOf(const ErrorSketch& sketch);

private:
    std::map<std::pair<uint64_t, uint64_t>, glm::dvec3> products_; // by their numbers
    std::map<uint64_t, double> biases_;
};

/// Makes the sketch of sums over links on the CPU, as shaders/layers/layer_sketch.comp does: patches has an
/// entry per patch, padding included, and sums are [kReplicates][patches].
ErrorSketch sketchOf(WorkerPool& pool, std::span<const shader::Patch> patches, const glm::vec4* sums);

} // namespace relume
