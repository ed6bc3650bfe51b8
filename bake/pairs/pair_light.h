#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "assets/base/worker_pool.h"
#include "bake/base/bounce_convergence.h"
#include "bake/surface/patch_set.h"

namespace relume {

/// The light of the last two passes on the host, and what it tells about the passes that are still to come.
class PairLight {
public:
    /// Tells what a checkpoint keeps of it, beside the light.
    struct State {
        double lastChange = 0; // RMS [cd/m^2] of the last pass; 0: nothing yet
        BounceConvergence convergence;
    };
    /// Starts from this light; `dark` says that nothing of the scene's light is in it.
    PairLight(const PatchSet& patches, std::vector<glm::vec4> start, bool dark);

    const std::vector<glm::vec4>& light() const { return last_; }
    /// Takes the light after a pass, which `read` writes. Throws Error where it is not finite, or grows
    /// without end, as it does where few senders stand for many that are near. Returns the error that is
    /// left, relative to the mean light, where it can be told.
    std::optional<double> take(WorkerPool& pool, const std::function<void(std::vector<glm::vec4>&)>& read);
    /// Returns how far each patch's light may still be off; empty until it can be told.
    std::vector<float> errors() const;
    /// Returns the share of the mean light that is still to come, 1 until it can be told.
    double missing() const { return state_.convergence.left; }

    const State& state() const { return state_; }
    void restore(const State& state, std::vector<glm::vec4> light);

private:
    struct Sums {
        double squares = 0, light = 0; // R, G and B of all patches together
        uint64_t count = 0;
    };
    Sums changeOf(uint32_t first) const;
    std::optional<double> measure(WorkerPool& pool);
    void requireDecay(double change, double mean);

    const PatchSet& patches_;
    const bool dark_;
    State state_;
    std::vector<glm::vec4> last_, before_; // of the last finished pass, of the one before it
    std::optional<float> left_;            // share of the last change that is still to come
    uint32_t growing_ = 0;                 // passes in a row that changed more than the one before
};

} // namespace relume
