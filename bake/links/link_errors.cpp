// This part of LinkSolver finds its error, and makes the result.
#include "bake/links/link_solver.h"

#include "bake/base/finite_light.h"

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

// A receiver left out is missed over twice the gap, at its worst place. The share is the square of what
// texels are off, over the mean square of that: 1/32 where light is smooth, 1/4 across a step (at scale 2);
// 0.12 to 0.24 at scale 2 and 0.27 to 0.51 at scale 4 in the Cornell rooms at 128 x 128, where boxes touch
// the floor.
constexpr double kGapShare2 = 0.18, kGapShare4 = 0.36;
// Where the grid alone misses the error that was asked for, sampling ends when it adds this little to the
// square.
constexpr double kBesideGrid = 0.1;
// The error is looked at again when so much of the sample passes that it seems to need are done (variance
// falls as 1 / rounds or faster), and when their number has doubled.
constexpr double kCheckShare = 0.6, kCheckGrowth = 2.0;

} // namespace

// Finds the error that is left, from what the replicates say and the iteration; keeps it in progress().
void LinkSolver::check() {
    const uint32_t rounds = state_.directRounds + state_.linkRounds;
    state_.nextCheck = rounds + 1;
    if (state_.linkRounds == 0 && !(hybrid_ && settings_.passes == 1)) return; // no bounces yet
    resolve();
    progress_.converged = progress_.error <= settings_.error;
    const double off = progress_.error / settings_.error;
    const double growth = std::min(kCheckGrowth, kCheckShare * off * off);
    state_.nextCheck = std::max(rounds + 1, static_cast<uint32_t>(growth * rounds));
    // No number of samples makes up for a grid that is too coarse.
    const double grid2 = progress_.gridError * progress_.gridError;
    gridLimits_ = progress_.gridError > settings_.error &&
                  progress_.error * progress_.error - grid2 <= kBesideGrid * grid2;
}

void LinkSolver::resolve() {
    const auto at = [this](double sigma) { return resolveOnce(sigma); };
    learn(buffers_.rows ? state_.width.settle(at) : resolveOnce(0.0));
    stale_ = false;
    light_.clear();
}

// Learns what sums over all patches say, and that there is a new result.
void LinkSolver::learn(const shader::ResolveSums& sums) {
    requireFiniteLight(sums.light, double(sums.direct) + sums.raw + sums.indirect);
    state_.directVariance = sums.direct;
    state_.indirectVariance = smoothedVariance(sums);
    state_.directAtCheck = state_.directRounds;
    state_.linksAtCheck = state_.linkRounds;
    progress_.error = 0;
    if (sums.light > 0) {
        const double mean = sums.light / (3.0 * sums.count);
        state_.coarseVariance = coarseVariance(sums.count);
        progress_.gridError = std::sqrt(state_.coarseVariance / (3.0 * sums.count)) / mean;
        const double variance =
            (state_.directVariance + state_.indirectVariance + state_.coarseVariance) / (3.0 * sums.count);
        const bool settled = hybrid_ && settings_.passes == 1;
        const double iteration = settled ? 0.0 : state_.iterationError;
        progress_.error = std::sqrt(variance / (mean * mean) + iteration * iteration);
    }
    if (!hasSolution()) {
        live_.all = true; // this result is without what has arrived since
        return;
    }
    ++live_.resolves;
    live_.complete = live_.complete || settings_.passes > 0 || state_.settling.left <= kMostDimmer;
}

// Returns what interpolation leaves: a share of how far the receivers themselves are from what their
// neighbours say.
double LinkSolver::coarseVariance(double patches) {
    if (coarse_.count == 0 || state_.linkRounds == 0) return 0.0;
    VkCommandBuffer cmd = commands_.begin();
    resolvePass_.recordCoarse(cmd, input_.light, buffers_, state_.linkRounds * linksOfRound_);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    const glm::dvec4 total =
        sumsOf(vk::readBuffer<glm::vec4>(input_.device, buffers_.chunkSums, senders_.size()));
    const double rows = std::max(0.0, total.x) / std::max(1.0, total.y);
    const double columns = std::max(0.0, total.z) / std::max(1.0, total.w);
    return patches * (settings_.links.indirectScale == 2 ? kGapShare2 : kGapShare4) * (rows + columns);
}

shader::ResolveSums LinkSolver::resolveOnce(double sigma) {
    VkCommandBuffer cmd = commands_.begin();
    resolvePass_.record(cmd, input_.light, buffers_,
                        {.size = input_.patches.scene.size,
                         .samples = state_.linkRounds * linksOfRound_,
                         .directRounds = state_.directRounds,
                         .sigma = static_cast<float>(sigma)});
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    return sumsOf(
        vk::readBuffer<shader::ResolveSums>(input_.device, buffers_.chunkSums, input_.patches.chunkCount()));
}

// Returns the light so far; within a sample pass only some patches have its samples. What a look teaches
// about widths and variances must not decide what comes next: looking changes no byte.
const std::vector<glm::vec4>& LinkSolver::light() {
    if (stale_ && state_.stage == Stage::Plan && state_.directRounds + state_.linkRounds > 0) {
        const State before = state_;
        resolve();
        state_ = before;
    }
    if (light_.empty())
        light_ =
            vk::readBuffer<glm::vec4>(input_.device, buffers_.result, input_.patches.scene.patches.size());
    return light_;
}

std::vector<float> LinkSolver::errors() {
    std::vector<float> result;
    for (const glm::vec4& v : light())
        result.push_back(v.w);
    return result;
}

} // namespace relume
