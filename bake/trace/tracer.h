#pragma once

#include <span>

#include "bake/surface/trace_scene.h"
#include "bake/vk/buffer.h"

namespace relume {

using SuperBlock = shader::SuperBlock;

/// Senders other than the patches themselves, as tracers read them, on the host and on the device.
struct SenderRuns {
    std::span<const shader::Sender> senders = {}; // padded to whole chunks
    std::span<const uint32_t> members = {};       // patch indices
    const vk::Buffer* senderBuffer = nullptr;
    const vk::Buffer* memberBuffer = nullptr;
};

/// Pairs of rows of receivers and columns of senders: units firstUnit .. firstUnit + unitCount - 1 of a table
/// of super-blocks. Unit u is block (r, c) = (u % 256 / 16, u % 16) of supers[u / 256], row chunk row * 16 +
/// r, column chunk column * 16 + c. Its bits are the kBlockWords words from u % 256 * kBlockWords of the
/// super-block's: bit j % 32 of word i * 2 + j / 32 is set when patch i of the row chunk and sender j of the
/// column chunk face and see each other. Columns are chunks of patches as rows are; then pairs are asked
/// once, i < j, so units behind the diagonal are skipped, and in a block with itself only i < j is set. Or
/// they are chunks of a sender list; then sender j is the patch that shader::drawMember picks for the row
/// chunk. Units are also skipped whose chunks do not exist, that are already known, or of which no column
/// chunk (without a list: neither chunk) sends.
struct OcclusionWork {
    std::span<const SuperBlock> supers = {};
    const vk::Buffer* superBuffer = nullptr; // the same on the device
    std::span<uint32_t* const> bits;         // where their bits are on the host, for tracers on the CPU
    uint32_t firstUnit = 0, unitCount = 0;
    const vk::Buffer* sends = nullptr; // uint32_t per column chunk, mapped where the tracer runs on the CPU
    const SenderRuns* senders = nullptr;
    // Without a list, rays start at the column's patches and bits go kSuperWords further: only RTRad's
    // intervals tell the ends apart.
    bool reversed = false;
    // A uint32_t[]: unit u adds its facing pairs to word SuperBlock::counters + u % kRayCounters, a ray each;
    // with embree some of these are settled for a whole block by an empty shaft.
    const vk::Buffer* rays = nullptr;
};

/// Says which neighbouring patches have all their directions in common: none; those in the same place of
/// their 4 x 4 texels; those of one chunk. Alone none have, either, nor do neighbours' directions complement
/// each other: it is for what is asked of patches one by one, and for what is no texel.
enum class Rotation : uint32_t {
    Patch = shader::kRotatePatch,
    Interleaved = shader::kRotateInterleaved,
    Tile = shader::kRotateTile,
    Alone = shader::kRotateAlone
};

/// Closest hits of cosine-distributed directions (shaders/lib/sampling.glsl) of some chunks: link of patch i
/// of chunk c for sample k goes to links[linksOffset + ((c - firstChunk) * sampleCount + (k - firstSample)) *
/// 64 + i].
struct ClosestWork {
    // Patches that stand in for the scene's; chunks are counted in them. Both are set, or none.
    const vk::Buffer* receivers = nullptr;        // on the device
    const shader::Patch* receiversHost = nullptr; // the same, for tracers that run on the CPU
    uint32_t firstChunk = 0, chunkCount = 0;
    uint32_t firstSample = 0, sampleCount = 0; // sampleCount: a multiple of 8
    Rotation rotation = Rotation::Patch;
    // glm::vec2[discCount] on the device (mapped where the tracer runs on the CPU): directions come from
    // these points of the unit disc, each in the middle of its ring (evenRings), instead of the Sobol
    // sequence.
    const vk::Buffer* disc = nullptr;
    uint32_t discCount = 0;
    const vk::Buffer* links = nullptr; // uint32_t[chunkCount * sampleCount * 64] and what lies before
    uint64_t linksOffset = 0;          // [links]
    // shader::PatchCover per patch of the scene (mapped where the tracer runs on the CPU): sample k starts at
    // shader::startPoint k. nullptr, or with receivers: at the patch's own point.
    const vk::Buffer* covers = nullptr;
};

/// Segments from the patches of some chunks to points of their own. Target s of patch i of chunk c is
/// targets[((c - firstChunk) * targetCount + s) * 64 + i]: xyz where the segment ends [m], already off its
/// surface; w <= 0: not asked for. Bit s % 32 of word ((c - firstChunk) * words + s / 32) * 64 + i, words =
/// ceil(targetCount / 32), is set when it was asked for and nothing is in between.
struct SegmentWork {
    uint32_t firstChunk = 0, chunkCount = 0;
    const vk::Buffer* chunks =
        nullptr; // uint32_t[], mapped, too: which chunks are meant by these numbers; nullptr: those
    uint32_t targetCount = 0; // per patch, > 0
    const vk::Buffer* targets =
        nullptr; // vec4[chunkCount * targetCount * 64], mapped where the tracer runs on the CPU
    const vk::Buffer* bits = nullptr; // uint32_t[chunkCount * words * 64], too
    const vk::Buffer* rays =
        nullptr; // uint32_t[kRayCounters]: number c adds its rays to slot c % kRayCounters
    // As in ClosestWork: target s starts at shader::startPoint of shader::startNumber(s, samplePass, turn,
    // run).
    const vk::Buffer* covers = nullptr;
    uint32_t samplePass = 0, turn = 1, run = 1;
};

constexpr uint32_t kTargetsPerWord = 32; // of a SegmentWork's bits; lib/rays/segments.glsl

/// Links of `closest` that were traced before objects moved: those of patches that have changed, those whose
/// ray meets a box in which an object was or is, and those that end at certain patches, are traced again; all
/// others stay as they are.
struct RetraceWork {
    ClosestWork closest; // of the scene's patches and the Sobol sequence
    const vk::Buffer* boxes =
        nullptr; // shader::TraceBox[boxCount], mapped where the tracer runs on the CPU, as those below
    uint32_t boxCount = 0;
    const vk::Buffer* changed = nullptr; // glm::uvec2 per chunk of all, a bit for each patch
    const vk::Buffer* ends = nullptr;    // likewise: to trace what ends there; nullptr: at none
    const vk::Buffer* list = nullptr;    // uint32_t[1 + chunkCount * sampleCount * 64], not on the CPU
    const vk::Buffer* rays = nullptr;    // as in SegmentWork
    bool silent = false;                 // also of patches that send nothing, which get kLinkDark else
};

/// The entries of a TraceScene that have changed, in ascending order.
struct SceneChange {
    std::span<const uint32_t> triangles; // that stand elsewhere: corners and hit table
    std::span<const uint32_t> texels;    // whose patch is there now, or no more
};

/// Answers geometric questions about patches: the only thing that differs between back-ends. There is one
/// virtual call per batch. GPU tracers record into cmd; the CPU tracer runs at once and writes into
/// host-visible buffers. Either way the result is there for what is recorded into cmd afterwards, behind a
/// barrier that the caller writes.
class Tracer {
public:
    virtual ~Tracer() = default;
    virtual const char* name() const = 0;
    virtual bool onCpu() const = 0;
    /// Tells whether anything is recorded into cmd; where not, cmd may be null.
    virtual bool records() const { return !onCpu(); }
    virtual void occlusion(VkCommandBuffer cmd, const OcclusionWork& work) = 0;
    virtual void closest(VkCommandBuffer cmd, const ClosestWork& work) = 0;
    /// Finds which targets are seen; not for the RTRad preset. On the CPU the targets must be there when this
    /// is called.
    virtual void segments(VkCommandBuffer cmd, const SegmentWork& work) = 0;

    /// Follows that patches, ascending, may send now or no more (kPatchSends): closest hits end at those that
    /// do. Waits for the device.
    virtual void updateSenders(std::span<const uint32_t> patches);
    /// Tells whether it follows objects that move: only then the calls below are for it.
    virtual bool follows() const { return false; }
    /// Follows the scene that it was made of, which has changed. Waits for the device.
    virtual void update(const SceneChange& change);
    virtual void retrace(VkCommandBuffer cmd, const RetraceWork& work);
};

} // namespace relume
