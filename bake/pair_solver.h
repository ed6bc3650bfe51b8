#pragma once

#include "bake/solver.h"
#include "bake/vk/commands.h"

namespace relume {

/// The pair methods. A pass gathers every patch's light from all senders and adds one bounce; ligIn and
/// ligOut swap between passes. Visibility of a pair is traced once per pass and serves both ends. Sums run
/// over super-blocks of 1024 x 1024 pairs in a fixed order.
class PairSolver final : public Solver {
public:
    /// Throws Error.
    PairSolver(const SolverInput& input, const SolverSettings& settings);

    void step() override;
    uint64_t raysSoFar() override; // asks the device
    const std::vector<glm::vec4>& light() override { return last_; }
    std::vector<float> errors() override { return errors_; }
    SolverState state() override;
    std::vector<StatePart> stateParts() override;
    void restore(const SolverState& state) override;

    /// Throws Error, with the size that fits, when there are more pairs than can be numbered.
    static void checkPairs(const PatchSet& patches);
    static uint64_t bytes(uint32_t chunkCount, bool software);

private:
    struct State {
        bool inPass = false;
        uint32_t nextUnit = 0; // the first one of a super-block
        double lastChange = 0;
    };
    struct Portion {
        uint32_t units = 0;
        double busy = 0; // of these have a sender, about
    };
    void beginPass();
    void listSupers();
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
    bool inPass_ = false;
    uint32_t nextUnit_ = 0; // of supers_, in units
    double unitsPerMs_ = 0; // with senders, measured; 0: nothing yet
    double lastChange_ = 0; // RMS [cd/m^2] of the last pass
    std::vector<glm::vec4> last_;
    std::vector<float> errors_; // of each patch, by what the last pass changed
};

} // namespace relume
