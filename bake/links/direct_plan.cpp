#include "bake/links/direct_plan.h"

#include "assets/base/error.h"
#include "assets/base/portions.h"
#include "bake/gather/sample_plan.h"

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

constexpr size_t kPlanPortion = size_t{1} << 12; // chunks that a thread looks at, at a time

} // namespace

void DirectPlan::learn(std::span<const ChunkVariance> chunks, std::span<const uint32_t> samplePasses,
                       bool locally) {
    double ChunkVariance::*const which = locally ? &ChunkVariance::localDirect : &ChunkVariance::direct;
    runPortions(pool_, chunks.size(), kPlanPortion, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            ofOne_[i] = pooledVariance(chunks, samplePasses, which, i);
            patches_[i] = chunks[i].patches;
        }
    });
}

// One more sample pass after n takes v / n^2 of a variance v / n.
uint32_t DirectPlan::wantedOf(const DirectPlanRules& rules, size_t chunk, uint32_t now) const {
    const uint32_t least = std::max(now, std::min(rules.least, rules.most));
    const double worth = ofOne_[chunk] / rules.cost;
    if (!(worth > rules.linkGain * now * now)) return least;
    const double growth = static_cast<double>(kMostChunkGrowth) * std::max(1u, now);
    const double pays = rules.linkGain > 0 ? std::sqrt(worth / rules.linkGain) : growth;
    return std::max(least, std::min(onLadder(std::min(pays, growth)), rules.most));
}

// Returns who takes part in each sample pass, by its number.
std::vector<DirectPlan::Part> DirectPlan::partsOf(std::span<const uint32_t> wanted,
                                                  std::span<const uint32_t> samplePasses) const {
    const uint32_t count = wanted.empty() ? 0 : *std::max_element(wanted.begin(), wanted.end());
    std::vector<Part> parts(count + 1); // first what changes from one sample pass to the next
    for (size_t i = 0; i < wanted.size(); ++i) {
        const uint32_t from = samplePasses[i], to = wanted[i];
        if (to <= from) continue;
        const double patches = patches_[i], ofOne = ofOne_[i] * patches;
        parts[from].ofOne += ofOne;
        parts[from].patches += patches;
        parts[to].ofOne -= ofOne;
        parts[to].patches -= patches;
    }
    for (uint32_t n = 1; n < count; ++n) {
        parts[n].ofOne += parts[n - 1].ofOne;
        parts[n].patches += parts[n - 1].patches;
    }
    parts.resize(count);
    return parts;
}

// Returns what the last sample pass has to take away for its cost where no more than `allowed` is to be left:
// as much as links would, or more.
double DirectPlan::gainFor(const DirectPlanRules& rules, std::span<const uint32_t> samplePasses) const {
    constexpr uint32_t kHalvings = 16; // to a thousandth
    // How many pay, times the root of what the last one takes away.
    std::vector<double> roots(ofOne_.size());
    runPortions(pool_, roots.size(), kPlanPortion, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            roots[i] = std::sqrt(ofOne_[i] / rules.cost);
    });
    const auto left = [&](double gain) {
        const double share = gain > 0 ? 1.0 / std::sqrt(gain) : 0.0;
        return sumOverAll(pool_, ofOne_.size(), [&](size_t i) {
            const double pays = gain > 0 ? roots[i] * share : rules.most;
            return ofOne_[i] * patches_[i] / std::max({1.0, double(samplePasses[i]), pays});
        });
    };
    const double most =
        *std::max_element(ofOne_.begin(), ofOne_.end()) / rules.cost; // one sample pass is enough
    if (!(most > rules.linkGain) || left(rules.linkGain) > rules.allowed) return rules.linkGain;
    double low = std::max(rules.linkGain, most / (double(rules.most) * rules.most)), high = most;
    for (uint32_t i = 0; i < kHalvings; ++i) {
        const double middle = std::sqrt(low * high);
        (left(middle) > rules.allowed ? high : low) = middle;
    }
    return low;
}

std::vector<uint32_t> DirectPlan::wanted(const DirectPlanRules& of,
                                         std::span<const uint32_t> samplePasses) const {
    ASSERT(samplePasses.size() == ofOne_.size());
    if (samplePasses.empty()) return {};
    DirectPlanRules rules = of;
    rules.linkGain = gainFor(of, samplePasses);
    std::vector<uint32_t> wanted(samplePasses.size());
    runPortions(pool_, wanted.size(), kPlanPortion, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            wanted[i] = wantedOf(rules, i, samplePasses[i]);
    });
    const std::vector<Part> parts = partsOf(wanted, samplePasses);
    const uint32_t ofAll = std::max(std::min(rules.least, rules.most),
                                    *std::min_element(samplePasses.begin(), samplePasses.end()));
    // This tells of each number the next sample pass that does not make up for its costs.
    std::vector<uint32_t> end(parts.size() + 1, static_cast<uint32_t>(parts.size()));
    for (auto n = static_cast<uint32_t>(parts.size()); n-- > 0;) {
        const Part& part = parts[n];
        const double cost = rules.cost * part.patches + rules.passCost;
        end[n] = n < ofAll || part.ofOne > of.linkGain * cost * n * n ? end[n + 1] : n;
    }
    for (size_t i = 0; i < wanted.size(); ++i) {
        if (wanted[i] > samplePasses[i]) wanted[i] = std::min(wanted[i], end[samplePasses[i]]);
    }
    return wanted;
}

double DirectPlan::left(std::span<const uint32_t> samplePasses) const {
    ASSERT(samplePasses.size() == ofOne_.size());
    return sumOverAll(pool_, samplePasses.size(), [&](size_t i) { return leftOf(i, samplePasses[i]); });
}

double DirectPlan::settled(std::span<const uint32_t> wanted, std::span<const uint32_t> samplePasses) const {
    ASSERT(samplePasses.size() == ofOne_.size() && wanted.size() == ofOne_.size());
    return sumOverAll(pool_, samplePasses.size(), [&](size_t i) {
        return wanted[i] == samplePasses[i] ? leftOf(i, samplePasses[i]) : 0.0;
    });
}

} // namespace relume
