#pragma once

#include <array>

#include "bake/base/shader_types.h"
#include "bake/direct/penumbra.h"
#include "bake/direct/point_trace.h"
#include "bake/surface/light_buffers.h"
#include "bake/trace/chunk_starts.h"

namespace relume {

/// What sampling and gathering of lights in loops of C++ works with, be they mesh lights or analytic ones,
/// for devices whose memory is the CPU's own. Pointers are to what the lights have in their buffers; per
/// patch: padding included.
struct HostPoints {
    const shader::Patch* patches = nullptr;
    const shader::PatchCover* covers = nullptr; // where samples start; nullptr: at patches' own points
    glm::vec4* targets = nullptr;               // [chunk - firstChunk][targetCount][64], as in LampPush
    const uint32_t* bits = nullptr;             // which of them are seen, as in SegmentPush
    const uint32_t* parts = nullptr;            // per patch
    glm::uvec2* penumbra =
        nullptr;                 // per part, shaders/lib/light/penumbra.glsl; nullptr: all patches take part
    glm::vec4* sums = nullptr;   // [kReplicates][patchCount], added to
    bool newSums = false;        // nothing is in the sums yet
    glm::vec4* direct = nullptr; // per patch: the mean so far
    const uint32_t* chunks = nullptr; // which chunks are meant from firstChunk on; nullptr: those
    uint32_t firstChunk = 0, chunkCount = 0;
    uint32_t targetCount = 0;              // of the group, per patch
    uint32_t samplePass = 0, together = 1; // as of EmitterSamplesPush
    uint32_t patchCount = 0;
    float scale = 1; // from the sum of all sums to the mean

    size_t firstPatch(uint32_t chunk) const {
        return size_t{chunks ? chunks[firstChunk + chunk] : firstChunk + chunk} * shader::kChunk;
    }
    /// Returns the chunk's row of 64 targets.
    glm::vec4* targetsOf(uint32_t chunk, uint32_t target) const {
        return targets + (size_t{chunk} * targetCount + target) * shader::kChunk;
    }
    /// Returns the chunk's row of 64 words that hold the target's bit.
    const uint32_t* bitsOf(uint32_t chunk, uint32_t target) const;
    /// Returns how many of these sample passes the patch takes, as
    /// shaders/lib/light/penumbra_sample_passes.glsl does.
    uint32_t takenSamplePasses(size_t patch) const;
    /// Returns where the patch's samples start.
    shader::TexelSpread spreadOf(size_t patch) const;
    /// Notes in the first sample pass which lights a patch's points have reached and not reached, a bit each.
    void noteLights(size_t patch, uint32_t reached, uint32_t hidden) const;
};
HostPoints hostPoints(const LightBuffers& light, const SegmentWork& segments, uint32_t together,
                      const Penumbra* penumbra, const PointsOnCpu& on);

/// Holds a chunk by component.
struct PatchLanes {
    using Lane = ChunkStarts::Lane;
    ChunkStarts::Points middle, at; // the middle of where samples start; where the sample does
    std::array<ChunkStarts::Points, shader::kSpreadPoints> spread; // where light that is curved has its mean
    Lane nx, ny, nz, sx, sy, sz;                                   // normals and shading normals
    Lane offset, size;                                             // size: of shader::TexelSpread
    std::array<uint32_t, shader::kChunk> key, sends; // sends: 1 where the patch also takes part, else 0
    std::array<uint32_t, shader::kChunk> taken;      // sample passes
    bool unalike = false;                            // some take not all sample passes

    /// Returns where the samples of patch i start, but for its size.
    shader::TexelSpread spreadAt(uint32_t i) const {
        const glm::vec3 own = middle.at(i);
        return {own, spread[0].at(i) - own, spread[2].at(i) - own, size[i]};
    }
    /// Loads the chunk that begins with this patch. Returns whether any patch takes part.
    bool load(const HostPoints& work, size_t first);
};

/// Holds a row of targets by component.
struct TargetLanes {
    PatchLanes::Lane x, y, z, w;

    void store(glm::vec4* targets) const;
    /// Does so, and makes those 0 whose patches do not take this one of the sample passes.
    void store(glm::vec4* targets, const PatchLanes& lanes, uint32_t samplePass);
};

/// What a patch has gathered in a sample pass.
struct HostGathered {
    std::array<glm::vec3, shader::kReplicates> value{}; // of each replicate
    uint32_t reached = 0, hidden = 0;                   // bits of lights, by which penumbrae are found

    /// Takes note that a light was reached or hidden, of which this is the number in its group.
    void note(size_t light, bool isReached, bool isHidden);
    static uint32_t bitOf(size_t light);
};
/// Tells whether the patch has anything to gather; else its new sums are zero with this call.
bool takesLight(const HostPoints& work, size_t patch);
/// Adds what the patch has gathered to its sums.
void addGathered(const HostPoints& work, size_t patch, const HostGathered& gathered);

} // namespace relume
