#pragma once

#include <memory>
#include <span>

#include "assets/base/worker_pool.h"
#include "bake/base/chunk_dispatch.h"
#include "bake/gather/coarse_patches.h"
#include "bake/solver/solver.h"
#include "bake/solver/solver_extent.h"
#include "bake/surface/light_buffers.h"
#include "bake/vk/program.h"

namespace relume {

/// Returns the directions per patch that one sample pass takes: so many that a batch fills the device, but no
/// more than are asked for. samples is the number of directions per patch in all, 0 for what the error needs.
uint32_t linksOfSamplePass(uint32_t patches, uint32_t samples, bool software);

/// Returns how many of so many chunks a batch of links has at most.
uint32_t linkBatchChunks(uint32_t chunks, bool software);
/// LinkBuffers::local holds copies of bins of light and of errors, and from here on a LocalSums per chunk
/// [bytes].
constexpr uint64_t kLocalSumsAt = shader::kBinCopies * shader::kBinsOfCopy * sizeof(uint32_t);

/// The buffers of the link methods. "Sums" hold each replicate's samples by themselves:
/// vec4[kReplicates][patches].
struct LinkBuffers {
    vk::Buffer patchChart, texelToPatch;
    vk::Buffer packed; // uvec2 per entry of the light's radiance, made by whoever owns both: what links read
    vk::Buffer linkSums, directSums;
    vk::Buffer direct;        // vec4 per patch, the mean
    vk::Buffer carried;       // vec4 per patch: light of links that later ones read (carriedShare)
    vk::Buffer notes;         // uvec2 per chunk, of lights (lib/light/light_notes.glsl)
    vk::Buffer distances;     // vec2 per patch, along rows and columns [m], where there is smoothing
    vk::Buffer rows, result;  // of smoothing, and its outcome
    vk::Buffer chunkSums;     // per chunk, read back
    vk::Buffer sums;          // or over all of them
    vk::Buffer local;         // of local error, read back: bins, LocalSums
    vk::Buffer scales;        // vec2 per chunk, where chunks have sample passes of their own
    vk::Buffer rays;          // uint[kRayCounters]
    uint32_t batchChunks = 0; // at most in one submit
    uint32_t size = 0;        // lightmap edge [texels]
    // These are there where links are followed from fewer patches than there are.
    vk::Buffer receivers, taps, neighbours; // Patch, CoarseTaps, CoarseNeighbours
    vk::Buffer coarseDistances;             // as distances, per receiver
    vk::Buffer coarseSums;                  // vec4[kReplicates][receivers], of one bounce
    uint32_t receiverCount = 0;             // padding included; 0: all patches are receivers

    struct Desc {
        bool direct = false; // direct light is sampled
        bool smooth = false;
        bool local = false;   // local error is told
        bool notes = false;   // chunks take notes of lights
        bool carries = false; // sample passes start from those before
        Spill spill = Spill::None;
        const CoarsePatches* coarse = nullptr; // bytes() takes their number instead
    };
    LinkBuffers(const vk::Device& device, const PatchSet& patches, const Desc& desc);
    /// Returns their bytes. Whoever makes `packed` counts it.
    static SpilledBytes bytes(const SolverExtent& extent, const Desc& desc, uint64_t receivers);
};

/// Returns how far smoothing looks [texels], 0 for not at all. sigma is its width [texels].
uint32_t smoothingReach(float sigma);
/// Returns the share of a sample pass's light in what later ones read, it being number `samplePasses` from 1.
/// The first one goes over its few links again and again, which leaves an error of its own in their light: a
/// share of 1 / samplePasses would let it fade with the power 1 - q of the number of passes only, q being how
/// much of the light bounces on.
float carriedShare(uint32_t samplePasses);
/// Returns the sum over all chunks.
shader::ResolveSums sumsOf(std::span<const shader::ResolveSums> chunks);
glm::dvec4 sumsOf(std::span<const glm::vec4> chunks);

/// Gathers light over links: the mean of what the links' patches send goes to ligOut, together with direct
/// light. Where only receivers of a coarser grid have links, it first goes to coarseSums, which were cleared
/// before, then by interpolation to ligOut. On a software device host_links.h gathers.
class LinkGatherPass {
public:
    LinkGatherPass(const vk::Device& device, const TransportSettings& settings)
        : pool_(device.info().software() && !settings.deviceGather ? &device.workers() : nullptr),
          pack_(pool_ ? vk::ComputeProgram() : vk::ComputeProgram(device, "pack")),
          gather_(pool_ ? vk::ComputeProgram() : vk::ComputeProgram(device, "links")),
          distance_(device, "link_distance"), interpolate_(device, "interpolate"),
          compose_(device, "compose"), carry_(device, "carry") {}
    struct Work {
        const vk::Buffer* links = nullptr;
        uint64_t linksOffset = 0;           // of range.first [links]
        VkDeviceAddress nodes = 0;          // PyramidNode[], for recordDistances: links may be nodes
        uint32_t samples = 0;               // per patch
        glm::vec3 sky{0.0f};                // radiance that kLinkSky brings [cd/m^2]
        const vk::Buffer* direct = nullptr; // vec4 per patch, added to ligOut
        bool output = true;                 // to ligOut
        bool accumulate = false;            // add to linkSums
        bool newSums = false;               // nothing is in these yet; on the host only
        bool distances = false;             // for recordInterpolate: those of recordDistances are spread, too
        ChunkRange range;
        VkDeviceAddress address() const { return links->address() + linksOffset * sizeof(uint32_t); }
    };
    /// Tells whether record gathers at once, on the host; what it reads must be there by then.
    bool onCpu() const { return pool_ != nullptr; }
    WorkerPool& pool() const { return *pool_; } // where it gathers on the host
    /// Makes radiance, without emission, after a bounce from ligIn to ligOut that the host gathered. full and
    /// changes are as HostSend has them.
    void sendOnCpu(const LightBuffers& light, float reflectivity, const std::vector<uint8_t>& full,
                   glm::vec4* changes, bool isFirst = false) const;
    /// Begins on the host, before any bounce: makes ligIn that of `first`, and radiance from it.
    void startOnCpu(const LightBuffers& light, float reflectivity, const std::vector<uint8_t>& full,
                    const vk::Buffer& first) const;
    /// Makes packed from the light's radiance.
    void recordPack(VkCommandBuffer cmd, const LightBuffers& light, const LinkBuffers& buffers) const;
    void record(VkCommandBuffer cmd, const LightBuffers& light, const LinkBuffers& buffers,
                const Work& work) const;
    /// Makes the distances of these links' ends, for smoothing.
    void recordDistances(VkCommandBuffer cmd, const LightBuffers& light, const LinkBuffers& buffers,
                         const Work& work) const;
    /// Spreads what all links of a bounce have brought to the patches of work.range, with work.samples links
    /// each.
    void recordInterpolate(VkCommandBuffer cmd, const LightBuffers& light, const LinkBuffers& buffers,
                           const Work& work) const;
    /// Makes ligIn of direct light (vec4 per patch, nullptr for none) and the mean of `samples` links; with
    /// `scales` each chunk has as many as these say.
    void recordCompose(VkCommandBuffer cmd, const LightBuffers& light, const LinkBuffers& buffers,
                       const vk::Buffer* direct, uint32_t samples, const vk::Buffer* scales = nullptr,
                       const SomeChunks& chunks = {}) const;
    /// Mixes this share of what a sample pass has brought to ligOut, less direct light, into what is carried;
    /// with 0 makes ligIn of direct light and what is carried.
    void recordCarry(VkCommandBuffer cmd, const LightBuffers& light, const LinkBuffers& buffers,
                     const vk::Buffer* direct, float share, const SomeChunks& chunks = {}) const;
    /// Makes direct what it was after so many sample passes, or those that `scales` say.
    void recordDirectMean(VkCommandBuffer cmd, const LightBuffers& light, const LinkBuffers& buffers,
                          uint32_t samplePasses, const vk::Buffer* scales = nullptr) const;

private:
    void gatherOnCpu(const LightBuffers& light, const LinkBuffers& buffers, const Work& work) const;

    WorkerPool* pool_; // the device's; nullptr: shaders gather
    vk::ComputeProgram pack_, gather_, distance_, interpolate_, compose_, carry_;
};

/// Makes sums over chunks: of what a bounce changed, and of the result with its errors.
class ResolvePass {
public:
    /// Without `resolves` only record() is left out: the CPU makes results (host_resolve.h).
    ResolvePass(const vk::Device& device, bool resolves)
        : change_(device, "change"), coarse_(device, "coarse_error"),
          smooth_(resolves ? vk::ComputeProgram(device, "smooth") : vk::ComputeProgram()),
          resolve_(resolves ? vk::ComputeProgram(device, "resolve") : vk::ComputeProgram()) {}
    /// Compares ligOut with ligIn: makes a vec4 per chunk in chunkSums, as ChangePush has it.
    void recordChange(VkCommandBuffer cmd, const LightBuffers& light, const LinkBuffers& buffers,
                      const SomeChunks& chunks = {}, bool isFirst = false) const;
    /// Compares receivers of a coarser grid with their neighbours: makes a vec4 per chunk of theirs in
    /// chunkSums. samples is the number of links per receiver in linkSums.
    void recordCoarse(VkCommandBuffer cmd, const LightBuffers& light, const LinkBuffers& buffers,
                      uint32_t samples) const;
    struct Work {
        uint32_t samples = 0;             // links per patch in linkSums
        uint32_t directSamplePasses = 0;  // in directSums; 0: no direct light
        float sigma = 0;                  // of smoothing [texels], 0: none
        const vk::Buffer* sums = nullptr; // in place of linkSums
        bool scaled = false;              // chunks have as many samples as LinkBuffers::scales say
        bool local = false;               // makes LinkBuffers::local
        float floor = 0;                  // as of SmoothPush
        // The chunks that are smoothed along rows, and those that the result is made of, which read no other
        // ones' rows; nothing: all.
        SomeChunks rows = {}, chunks = {};
    };
    /// Makes result, and ResolveSums per chunk in chunkSums (sumsOf).
    void record(VkCommandBuffer cmd, const LightBuffers& light, const LinkBuffers& buffers,
                const Work& work) const;

private:
    vk::ComputeProgram change_, coarse_, smooth_, resolve_;
};

} // namespace relume
