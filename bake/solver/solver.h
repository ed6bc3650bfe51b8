#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "bake/base/chunk_order.h"
#include "bake/ranks/ranks.h"
#include "bake/solver/transport.h"
#include "bake/surface/light_buffers.h"
#include "bake/trace/tracer.h"

namespace relume {

/// The ways to choose the senders of light.
enum class Method {
    Pure,        // every patch sends to every other one
    Static,      // one patch of every window stands for it
    MonteCarlo,  // the same, drawn for each receiving chunk and window
    Mipmapped,   // one sender with the mean of every window
    Adaptive,    // leaves of a quad-tree over ligIn
    Directional, // what cosine-distributed directions hit
    Hybrid,      // points on lights for direct light, directions for the rest
};

/// Throws UsageError for an unknown name.
Method parseMethod(const std::string& name);
const char* methodName(Method method);
/// Pair methods ask about pairs of patches, the others about directions.
inline bool isPairMethod(Method method) {
    return method != Method::Directional && method != Method::Hybrid;
}

/// The settings of the pair methods.
struct PairSettings {
    uint32_t window = 1;     // static, Monte-Carlo, mipmapped: edge of a window [texels], a power of two
    double threshold = 0.05; // adaptive: difference up to which nodes are merged, relative to the mean light
    uint32_t node = 8;       // adaptive: edge of the largest node [texels], a power of two
    double thresholdRamp = 1.0; // adaptive: factor on the threshold from pass to pass
};

/// The sources of link methods' directions.
enum class DirectionSet {
    Sobol, // the Owen-scrambled Sobol sequence
    Lec    // the thesis' insertion into the largest empty circle (bake/links/directions.h)
};

/// The settings of directional and hybrid.
struct LinkSettings {
    DirectionSet directions = DirectionSet::Sobol;
    Rotation rotation = Rotation::Patch;
    uint32_t samples = 0; // directions per patch, in whole sample passes; 0: as many as the error needs
    bool smooth = true;   // hybrid: the indirect part is smoothed for display and output
    // With 2 or 4, links are followed from one patch of every so many by so many texels of a chart, and their
    // light is interpolated between these.
    uint32_t indirectScale = 1;
    // Links read the mean light over the part of a chart that their direction stands for
    // (bake/links/footprint.h).
    bool footprint = false;
    // Samples start all over the part of their texel that the surface covers; else in its middle.
    bool allOver = true;
    // Chunks take samples where light is still off; else every patch takes as many.
    bool perChunk = false;
    // Every patch takes as many samples of direct light, too, as what others take less of is measured
    // against.
    bool uniform = false;
};

/// The memory that bits and links may take for later bounces. Without a cache the same rays are traced again.
struct CacheSettings {
    enum class Kind { Auto, None, Bits, Links };
    Kind kind = Kind::Auto; // Auto: bits or links, as the method has them
    // At most; 0: a third of the device's free memory and, for links beside a GPU, a quarter of the host's.
    uint64_t bytes = 0;
    uint64_t deviceBytes = 0; // of links on the device, the others are the host's; 0: what is there for them

    bool keepsBits() const { return kind == Kind::Auto || kind == Kind::Bits; }
    bool keepsLinks() const { return kind == Kind::Auto || kind == Kind::Links; }
};

/// The settings of hybrid with one layer per light (bake/layers/layer_solver.h).
struct LayerSettings {
    bool on = false;
    // For layers, at most; 0: a third of the device's free memory and, beside a GPU, a quarter of the host's.
    uint64_t bytes = 0;
    uint64_t deviceBytes = 0; // of them on the device, the others are the host's; 0: what is there for them
    bool optional = false;    // where they do not fit, all lights are baked as one; else that is an error
    double error = 0;         // that each layer is to have by itself (relRMSE); 0: none is asked for
    // The names of the lights whose layers are made (LightSource::name), each of them by itself; empty: all.
    std::vector<std::string> lights = {};
};

struct SolverSettings {
    Method method = Method::Pure;
    LayerSettings layers;
    PairSettings pairs;
    LinkSettings links;
    CacheSettings cache;
    TransportSettings transport;
    uint32_t passes = 0; // pair methods: stop after this many; link methods: bounces of each sample pass; 0:
                         // by error alone
    double error =
        0.01; // stop when the remaining error (relRMSE) is below this; 0: by passes and samples alone
    double localError = 0; // link methods: and when the local error (localError95) is, too; 0: it may be any
    double batchMs = 20.0; // aim of one submit
    bool live = false;     // liveLight() will be asked, and abortPass() forgets at once: takes more memory
    Spill spill = Spill::None; // which of the link methods' buffers are in the host's memory, at least
};

/// Tells whether samples start all over their texels.
inline bool startsAllOver(const SolverSettings& settings) {
    return !isPairMethod(settings.method) && settings.links.allOver;
}

/// The state of a bake, and what it has cost.
struct SolverCounters {
    uint32_t passes = 0;     // finished; link methods: bounces of all sample passes
    uint32_t samples = 0;    // link methods: directions per patch (with a coarser grid: of that) so far
    double passFraction = 0; // of the current pass
    double error = 1.0;      // remaining error, relRMSE; 1 until it can be told
    // The local error of a texel is |light - true light| / max(true light, 5 % of the median light). These
    // are the 95th and 99th percentile over all texels; 1 until they can be told, as the pair methods never
    // do.
    double localError95 = 1.0, localError99 = 1.0;
    double gridError = 0; // share of it that a coarser grid of directions leaves, however many samples
    uint64_t rays = 0; // facing pairs whose visibility was found, each once per pass (RTRad preset: from both
                       // ends), or directions and segments traced
    uint64_t pairs = 0;                         // receiver-sender pairs or links that were gathered
    uint64_t linksRead = 0;                     // of layers: a link is read once for all that bounce together
    double traceSeconds = 0, gatherSeconds = 0; // GPU timestamps; on the CPU tracer wall time for the first
    double seconds = 0;                         // inside step()
    bool converged = false;  // error below the aim (else the number of passes or samples ended it)
    uint64_t cacheBytes = 0; // memory that bits or links are kept in
    double cachedShare = 0;  // of the pairs or links of a pass
    uint64_t raysSaved = 0;  // rays that a later pass found in the cache
};
struct SolverProgress : SolverCounters {
    std::vector<double> passSeconds; // inside step(), of each finished pass
};

/// A solver's state between two steps, as plain data. With the stateParts() it is all that a solver needs to
/// go on as if it had never stopped. Bits and links are not part of it: they are traced again.
struct SolverState {
    SolverCounters counters;
    std::vector<double> passSeconds;
    std::vector<uint8_t> own; // the solver's own struct, byte by byte
};

/// One of the arrays that belong to a state. They may take gigabytes, so they are read and written piece by
/// piece, where they are.
struct StatePart {
    uint64_t bytes = 0;
    std::function<void(void* to, uint64_t offset, uint64_t size)> read;
    std::function<void(const void* from, uint64_t offset, uint64_t size)> write;
};

/// The light that can be shown between two steps.
struct LiveLight {
    // vec4 per patch, on the device: lighting, w means nothing. Link methods have none until patches that are
    // seen, or all of them where no priority was set, have their first light: a picture of none would be
    // black. What is told as changed before counts nevertheless.
    const vk::Buffer* light = nullptr;
    uint64_t version = 0; // changes when the light does
    // True once the light has all bounces, so that it is at most some percent dimmer than the result will be;
    // it stays true. Before, the light is what there is: direct light as it arrives, then bounce by bounce.
    bool complete = false;
    bool bounced = true;             // the light has bounces, if not all; only layers tell
    std::vector<ChunkRange> changed; // chunks changed since the call before, merged()
};

/// Progressive radiosity, resumable: each step() does one batch. Neither batch sizes nor timing change a byte
/// of the result.
class Solver {
public:
    static constexpr uint32_t kMaxPasses = 256;

    virtual ~Solver() = default;
    bool done() const { return done_; }
    /// Does one batch and waits for it. Call it until done(). Throws Error on device loss.
    virtual void step() = 0;
    const SolverProgress& progress() const { return progress_; }
    /// Returns progress().rays plus those of the current pass; may ask the device.
    virtual uint64_t raysSoFar() { return progress_.rays; }
    /// Sets the aim of one submit, from the next step on.
    void setBatchMs(double ms) { batchMs_ = ms; }
    /// Lets patches in chunks that are not 0 (one entry per chunk; empty: none) come first wherever the order
    /// is free: within a bounce of link methods, which changes no byte, and in rows of super-blocks of pair
    /// methods that have not begun, where sums then agree to 1e-5.
    virtual void setPriority(std::vector<uint8_t> chunkSeen) = 0;
    /// Tells whether the next step() begins a pass (link methods: a sample pass), or nothing is left.
    virtual bool passBoundary() const = 0;
    /// Forgets the pass that has begun: what follows has the bytes of an undisturbed bake. The counters keep
    /// what it has cost. Right after a restore() within a pass that adds to sums, that pass is done to its
    /// end instead.
    virtual void abortPass() = 0;
    /// Returns the light so far; needs SolverSettings::live. Its buffer holds until the next step(),
    /// restore() or abortPass(). Asking changes no byte of the result.
    virtual LiveLight liveLight() = 0;
    /// Returns the light of the last finished pass (link methods: sample pass) for display and output, one
    /// vec4 per patch. Looking at it in between changes no byte of the result.
    virtual const std::vector<glm::vec4>& light() = 0;
    /// Returns how far each patch's light may still be off, one number per patch in light()'s unit; empty
    /// when that cannot be told yet.
    virtual std::vector<float> errors() = 0;

    /// Returns where it stands; not once it is done().
    virtual SolverState state() = 0;
    /// Brings to this rank what others have of the state's arrays and of light(), so that it may be read
    /// here; all ranks call it between two passes. Where one process bakes alone nothing is missing.
    virtual void collect() {}
    /// Returns the state's arrays in the solver's own order; they hold as long as no step() is made.
    virtual std::vector<StatePart> stateParts() = 0;
    /// Goes on from a state of a solver with the same input and settings; batches and caches may differ. The
    /// parts must be written before. Throws Error when the state is not this kind of solver's.
    virtual void restore(const SolverState& state) = 0;

protected:
    /// This share of the mean light may be missing from light that is called complete, as BounceConvergence
    /// tells it: ratios of the first bounces are too small, so it may be twice as much, which cannot be
    /// foreseen.
    static constexpr double kMostDimmer = 0.01;

    /// Make the state with a solver's own plain struct, and take it back.
    template<typename Own>
    SolverState makeState(const Own& own) const {
        static_assert(std::is_trivially_copyable_v<Own>);
        const auto* bytes = reinterpret_cast<const uint8_t*>(&own);
        return {progress_, progress_.passSeconds, {bytes, bytes + sizeof(own)}};
    }
    template<typename Own>
    Own takeState(const SolverState& state) {
        Own own;
        takeState(state, &own, sizeof(own));
        return own;
    }
    static StatePart part(const vk::Device& device, const vk::Buffer& buffer);
    static StatePart part(ChunkOrder& order);
    static StatePart part(std::vector<uint32_t>& values);
    static StatePart part(std::vector<double>& values);

    bool done_ = false;
    double batchMs_ = 20.0; // aim of one submit
    SolverProgress progress_;

private:
    void takeState(const SolverState& state, void* own, size_t size);
};

/// Copies ranges of a buffer of one vec4 per patch.
void recordCopy(VkCommandBuffer cmd, const vk::Buffer& from, const vk::Buffer& to,
                const std::vector<ChunkRange>& ranges);

/// A solver's input; all of it must outlive the solver.
struct SolverInput {
    const vk::Device& device;
    const Scene& scene;
    const PatchSet& patches;
    LightBuffers& light; // ligIn and ligOut are set to the starting light
    Tracer& tracer;
    Ranks& ranks = oneProcess(); // that bake together; a solver that cannot asserts that there is one
};

} // namespace relume
