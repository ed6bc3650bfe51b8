#pragma once

#include <cstdint>
#include <vector>

#include "bake/passes.h"
#include "bake/trace/tracer.h"
#include "bake/vk/commands.h"

namespace relume {

struct SolverSettings {
    TransportSettings transport;
    uint32_t passes = 0; // stop after this many; 0: by error alone
    double error =
        0.01; // stop when the iteration's remaining error (relRMSE) is below this; 0: by passes alone
    double batchMs = 20.0; // aim of one submit
};

/// Where a bake stands, and what it has cost.
struct SolverProgress {
    uint32_t passes = 0;     // finished
    double passFraction = 0; // of the current pass's pairs
    double error = 1.0;      // remaining error of the iteration, relRMSE; 1 until it can be told
    uint64_t rays =
        0; // facing pairs whose visibility was found, each once per pass (RTRad preset: from both ends)
    uint64_t pairs = 0;                         // receiver-sender pairs that were gathered
    double traceSeconds = 0, gatherSeconds = 0; // GPU timestamps; on the CPU tracer wall time for the first
    double seconds = 0;                         // inside step()
    std::vector<double> passSeconds;            // the same, of each finished pass
    bool converged = false;                     // error below the aim (else the number of passes ended it)
};

/// Pure progressive radiosity, resumable: each step() does one batch. A pass gathers every patch's light from
/// every other patch and adds one bounce; ligIn and ligOut swap between passes. Visibility of a pair is
/// traced once per pass and serves both ends. Sums run over super-blocks of 1024 x 1024 pairs in a fixed
/// order, so neither batch sizes nor timing change a byte.
class Solver {
public:
    /// All must outlive the solver; light.ligIn and ligOut are set to the starting light. Throws Error.
    Solver(const vk::Device& device, const PatchSet& patches, LightBuffers& light, Tracer& tracer,
           const SolverSettings& settings);

    bool done() const { return done_; }
    /// One batch, waited for. Call until done(). Throws Error on device loss.
    void step();
    const SolverProgress& progress() const { return progress_; }
    /// progress().rays and those of the current pass; asks the device.
    uint64_t raysSoFar();
    /// Light of the last finished pass, one vec4 per patch.
    const std::vector<glm::vec4>& light() const { return last_; }

    static constexpr uint32_t kMaxPasses = 256;
    /// Throws Error, with the size that fits, when there are more pairs than can be numbered.
    static void checkPairs(const PatchSet& patches);
    /// Device bytes of the solver's own buffers, beside LightBuffers.
    static uint64_t bytes(uint32_t chunkCount, bool software);

private:
    struct Portion {
        uint32_t units = 0;
        double busy = 0; // of these have a sender, about
    };
    void beginPass();
    Portion cutPortion(double wanted, uint32_t most) const;
    void traceBatch(uint32_t unitCount);
    void endPass();
    void measureChange(const std::vector<glm::vec4>& now);

    const vk::Device& device_;
    const PatchSet& patches_;
    LightBuffers& light_;
    Tracer& tracer_;
    SolverSettings settings_;
    RadiancePass radiancePass_;
    GatherPass gatherPass_;
    FinishPass finishPass_;
    vk::Commands commands_;
    vk::Timestamps timestamps_;
    PairBuffers pairs_;
    vk::Buffer rays_;
    std::vector<SuperBlock> supers_; // of the current pass
    std::vector<float> busyShare_;   // of each one: units in which somebody sends, > 0
    bool inPass_ = false, done_ = false;
    uint32_t nextUnit_ = 0; // of supers_, in units
    double unitsPerMs_ = 0; // with senders, measured; 0: nothing yet
    double lastChange_ = 0; // RMS [cd/m^2] of the last pass
    std::vector<glm::vec4> last_;
    SolverProgress progress_;
};

} // namespace relume
