#include "bake/gather/chunk_plan.h"

#include "bake/gather/sample_plan.h"

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

// A chunk's variance is at least the mean over so many chunks on both sides.
constexpr size_t kNeighbours = 2;
// Numbers of sample passes are searched to this share.
constexpr double kSearchShare = 1e-3;

uint32_t limited(double wanted, uint32_t now, uint32_t most) {
    if (wanted <= now) return now;
    const double limit = std::min(double{kMostChunkGrowth} * std::max(1u, now), double(most));
    return std::max(now, std::min(onLadder(std::min(wanted, limit)), most));
}

// Variances of one sample pass per patch, no smaller than around them.
struct Variances {
    std::vector<double> direct, links;
};

Variances pooled(std::span<const ChunkVariance> chunks, const ChunkPlan& now, double ChunkVariance::*direct,
                 double ChunkVariance::*links) {
    Variances all;
    all.direct.reserve(chunks.size());
    all.links.reserve(chunks.size());
    for (size_t i = 0; i < chunks.size(); ++i) {
        all.direct.push_back(pooledVariance(chunks, now.direct, direct, i));
        all.links.push_back(pooledVariance(chunks, now.links, links, i));
    }
    return all;
}

// Brings chunks to the local error, each by itself.
void planLocally(const ChunkPlanRules& rules, std::span<const ChunkVariance> chunks, const ChunkPlan& now,
                 ChunkPlan& plan) {
    const Variances each = pooled(chunks, now, &ChunkVariance::localDirect, &ChunkVariance::localIndirect);
    const double allowed = rules.localError * rules.localError;
    for (size_t i = 0; i < chunks.size(); ++i) {
        if (!(chunks[i].patches > 0)) continue;
        const double direct = rules.hasDirect ? each.direct[i] / now.direct[i] : 0.0;
        const double links = each.links[i] / now.links[i];
        if (direct + links <= allowed) continue;
        const SamplePasses samplePasses =
            samplePassesFor({.samplePasses = now.direct[i],
                             .most = rules.hasDirect ? rules.mostSamplePasses : now.direct[i],
                             .variance = direct,
                             .costOfSamplePass = rules.directCost},
                            {.samplePasses = now.links[i],
                             .most = rules.mostSamplePasses,
                             .variance = links,
                             .costOfSamplePass = rules.linkCost},
                            allowed);
        plan.direct[i] = limited(samplePasses.first, now.direct[i], rules.mostSamplePasses);
        plan.links[i] = limited(samplePasses.second, now.links[i], rules.mostSamplePasses);
    }
}

// Brings all chunks together to the variance that is allowed: sample passes go where a pass takes most of it
// away for its cost.
void planTogether(const ChunkPlanRules& rules, std::span<const ChunkVariance> chunks, const ChunkPlan& now,
                  ChunkPlan& plan) {
    const Variances each = pooled(chunks, now, &ChunkVariance::direct, &ChunkVariance::indirect);
    const auto wanted = [&](double variance, double cost, double scale) {
        return scale * std::sqrt(variance / cost);
    };
    // Returns what is left where pass counts follow `scale`.
    const auto left = [&](double scale) {
        double sum = 0;
        for (size_t i = 0; i < chunks.size(); ++i) {
            const ChunkVariance& c = chunks[i];
            if (!(c.patches > 0)) continue;
            const auto share = [&](double total, double variance, double cost, uint32_t done,
                                   uint32_t planned) {
                const double samplePasses =
                    std::max(double(std::max(planned, 1u)), wanted(variance, cost, scale));
                return total * done / samplePasses;
            };
            if (rules.hasDirect)
                sum += share(c.direct, each.direct[i], rules.directCost, now.direct[i], plan.direct[i]);
            sum += share(c.indirect, each.links[i], rules.linkCost, now.links[i], plan.links[i]);
        }
        return sum;
    };
    if (left(0.0) <= rules.variance) return;
    double low = 0, high = 1e-12;
    constexpr double kMostScale = 1e30;
    while (left(high) > rules.variance && high < kMostScale)
        high *= 4.0;
    while (high - low > kSearchShare * high) {
        const double middle = 0.5 * (low + high);
        (left(middle) > rules.variance ? low : high) = middle;
    }
    for (size_t i = 0; i < chunks.size(); ++i) {
        if (!(chunks[i].patches > 0)) continue;
        const auto raise = [&](uint32_t& planned, uint32_t done, double variance, double cost) {
            const double samplePasses = wanted(variance, cost, high);
            if (samplePasses > planned)
                planned = std::max(planned, limited(samplePasses, done, rules.mostSamplePasses));
        };
        if (rules.hasDirect) raise(plan.direct[i], now.direct[i], each.direct[i], rules.directCost);
        raise(plan.links[i], now.links[i], each.links[i], rules.linkCost);
    }
}

} // namespace

double pooledVariance(std::span<const ChunkVariance> chunks, std::span<const uint32_t> samplePasses,
                      double ChunkVariance::*which, size_t chunk) {
    if (!(chunks[chunk].patches > 0)) return 0.0;
    const auto ofOne = [&](size_t i) { return chunks[i].*which * samplePasses[i]; };
    const size_t end = std::min(chunks.size(), chunk + kNeighbours + 1);
    double sum = 0, patches = 0;
    for (size_t k = chunk - std::min(chunk, kNeighbours); k < end; ++k) {
        sum += ofOne(k);
        patches += chunks[k].patches;
    }
    return std::max(sum / patches, ofOne(chunk) / chunks[chunk].patches);
}

ChunkPlan planChunks(const ChunkPlanRules& rules, std::span<const ChunkVariance> chunks,
                     const ChunkPlan& now) {
    ChunkPlan plan = now;
    if (rules.localError > 0) planLocally(rules, chunks, now, plan);
    if (rules.variance > 0) planTogether(rules, chunks, now, plan);
    return plan;
}

} // namespace relume
