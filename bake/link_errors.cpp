// Of LinkSolver: what is known of its error, and the result.
#include "bake/link_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace relume {
namespace {

// A receiver left out is missed over twice the gap, at its worst place. Square of what texels are off, over
// the mean square of that: 1/32 where light is smooth, 1/4 across a step (at scale 2); 0.12 to 0.24 at scale
// 2 and 0.27 to 0.51 at scale 4 in the Cornell rooms at 128 x 128, where boxes touch the floor.
constexpr double kGapShare2 = 0.18, kGapShare4 = 0.36;
// Where the grid alone misses the error that was asked for, sampling ends when it adds this little to the
// square.
constexpr double kBesideGrid = 0.1;
// The error is looked at again when so much of the rounds that it seems to need are done (variance falls as 1
// / rounds or faster), and when their number has doubled.
constexpr double kCheckShare = 0.6, kCheckGrowth = 2.0;
// Smoothing is as wide as its error is small: widths that are tried [texels], and how often the model is
// asked again with what the new width showed.
constexpr double kSigmaStep = 0.1, kLeastSigma = 0.3, kMostSigma = 4.0;
constexpr double kSigmaGrowth = 2.0; // per try
constexpr uint32_t kSigmaTries = 3;
// A width within this factor of the best one is left alone: the error hardly depends on it there.
constexpr double kSigmaSlack = 1.25;

// Of a Gaussian of this width that is sampled at whole texels [texels^2]: less than sigma^2 where it is
// narrow, and nothing below the least width.
double kernelVariance(double sigma) {
    if (sigma < kLeastSigma) return 0.0;
    double sum = 0.5, squares = 0.0; // of one half
    for (int k = 1; k <= 4.0 * kMostSigma; ++k) {
        const double weight = std::exp(-0.5 * k * k / (sigma * sigma));
        sum += weight;
        squares += k * k * weight;
    }
    return squares / sum;
}

// Square of what smoothing leaves and adds.
double smoothedError(const shader::ResolveSums& sums) {
    return sums.indirect + std::max(0.0f, sums.bias);
}

} // namespace

// The error that is left, from what the replicates say and the iteration; kept in progress().
void LinkSolver::check() {
    const uint32_t rounds = state_.directRounds + state_.linkRounds;
    state_.nextCheck = rounds + 1;
    if (state_.linkRounds == 0 && !(hybrid_ && settings_.passes == 1)) return; // no bounces yet
    resolve();
    progress_.converged = progress_.error <= settings_.error;
    const double off = progress_.error / settings_.error;
    const double growth = std::min(kCheckGrowth, kCheckShare * off * off);
    state_.nextCheck = std::max(rounds + 1, static_cast<uint32_t>(growth * rounds));
    // No number of samples mends a grid that is too coarse.
    const double grid2 = progress_.gridError * progress_.gridError;
    gridLimits_ = progress_.gridError > settings_.error &&
                  progress_.error * progress_.error - grid2 <= kBesideGrid * grid2;
}

void LinkSolver::resolve() {
    shader::ResolveSums sums = resolveOnce();
    double best = state_.sigma, least = smoothedError(sums);
    for (uint32_t tries = 1; tries < kSigmaTries && buffers_.rows; ++tries) {
        const double before = state_.sigma;
        adaptSigma(sums);
        if (state_.sigma == before) break;
        sums = resolveOnce();
        if (smoothedError(sums) >= least) continue;
        best = state_.sigma;
        least = smoothedError(sums);
    }
    if (state_.sigma != best) {
        state_.sigma = best;
        sums = resolveOnce();
    }
    learn(sums);
    stale_ = false;
    light_.clear();
}

// What sums over all patches say, and that there is a new result.
void LinkSolver::learn(const shader::ResolveSums& sums) {
    state_.directVariance = sums.direct;
    state_.indirectVariance = smoothedError(sums);
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

// What interpolation leaves: a share of how far the receivers themselves are from what their neighbours say.
double LinkSolver::coarseVariance(double patches) {
    if (coarse_.count == 0 || state_.linkRounds == 0) return 0.0;
    VkCommandBuffer cmd = commands_.begin();
    resolvePass_.recordCoarse(cmd, input_.light, buffers_, state_.linkRounds * shape_.links);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    glm::dvec4 total(0.0);
    for (const glm::vec4& sum : vk::readBuffer<glm::vec4>(input_.device, buffers_.chunkSums, senders_.size()))
        total += glm::dvec4(sum);
    const double rows = std::max(0.0, total.x) / std::max(1.0, total.y);
    const double columns = std::max(0.0, total.z) / std::max(1.0, total.w);
    return patches * (settings_.links.indirectScale == 2 ? kGapShare2 : kGapShare4) * (rows + columns);
}

shader::ResolveSums LinkSolver::resolveOnce() {
    VkCommandBuffer cmd = commands_.begin();
    resolvePass_.record(cmd, input_.light, buffers_,
                        {.size = input_.patches.scene.size,
                         .samples = state_.linkRounds * shape_.links,
                         .directRounds = state_.directRounds,
                         .sigma = static_cast<float>(state_.sigma)});
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    const auto chunks =
        vk::readBuffer<shader::ResolveSums>(input_.device, buffers_.chunkSums, input_.patches.chunkCount());
    std::array<double, 6> total{};
    for (const shader::ResolveSums& s : chunks) {
        const std::array<float, 6> terms = {s.light, s.direct, s.indirect, s.raw, s.bias, s.count};
        for (size_t k = 0; k < total.size(); ++k)
            total[k] += terms[k];
    }
    const auto f = [&](size_t k) { return static_cast<float>(total[k]); };
    return {f(0), f(1), f(2), f(3), f(4), f(5)};
}

// Of a smooth function the mean over a width sigma is off by sigma^2 times its curvature, and independent
// noise falls with the area, 1 / (1 + a sigma^2): the squares of both, as measured at one width, tell the
// best one. The bias found holds on where nothing is smoothed, which shows none.
void LinkSolver::adaptSigma(const shader::ResolveSums& sums) {
    if (!(sums.raw > 0.0f)) {
        state_.sigma = 0;
        return;
    }
    constexpr double kGaussian = 4.0 * std::numbers::pi; // the ideal one's share, until it is measured
    const double v = kernelVariance(state_.sigma);
    if (v > 0) state_.curvature = std::max(0.0f, sums.bias) / (v * v);
    const double a =
        v > 0 && sums.indirect > 0.0f ? std::max(0.0, sums.raw / sums.indirect - 1.0) / v : kGaussian;
    const double b = state_.curvature >= 0 ? state_.curvature : sums.raw;
    const auto error = [&](double sigma) {
        const double t = kernelVariance(sigma);
        return sums.raw / (1.0 + a * t) + b * t * t;
    };
    // Far from the width that was measured the model says little.
    const double most = std::min(kMostSigma, kSigmaGrowth * std::max(state_.sigma, kLeastSigma));
    double best = 0;
    for (double sigma = kLeastSigma; sigma <= most; sigma += kSigmaStep) {
        if (error(sigma) < error(best)) best = sigma;
    }
    const bool close = best < kSigmaSlack * state_.sigma && state_.sigma < kSigmaSlack * best;
    if (!close) state_.sigma = best;
}

// Within a round only some patches have its samples. What a look teaches about widths and variances must not
// decide what comes next: looking changes no byte.
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
