#include "bake/gather/sample_plan.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace relume {

uint32_t onLadder(double samplePasses, bool doubles) {
    constexpr double kAlmostWhole = 1e-9;
    const auto whole = static_cast<uint32_t>(std::ceil(samplePasses * (1.0 - kAlmostWhole)));
    const uint32_t above = std::bit_ceil(whole), between = above / 4 * 3;
    return !doubles && whole <= between ? between : above;
}

namespace {

// There are at most so many times as many sample passes as before.
constexpr uint32_t kMostGrowth = 8;
// Many parts go in smaller steps: variances fall faster than one over the sample passes where these are
// stratified, and what one part got too many of nobody takes back.
constexpr uint32_t kMostGrowthOfMany = 4;

uint32_t limited(const SampledPart& part, double samplePasses, uint32_t growth = kMostGrowth) {
    if (part.samplePasses >= part.most) return part.samplePasses;
    const double most = static_cast<double>(growth) * std::max(1u, part.samplePasses);
    return std::min(part.most,
                    onLadder(std::clamp(samplePasses, double(part.samplePasses), most), part.doubles));
}

double varianceOfSamplePass(const SampledPart& part) {
    return part.variance * std::max(1u, part.samplePasses);
}

double within(const SampledPart& part, double samplePasses) {
    return std::clamp(samplePasses, double(part.samplePasses),
                      double(std::max(part.samplePasses, part.most)));
}

// Returns the sample passes by which the part comes to what the other one leaves of `allowed` with so many.
double samplePassesBeside(const SampledPart& part, const SampledPart& other, double otherSamplePasses,
                          double allowed) {
    if (part.variance <= 0.0) return part.samplePasses;
    const double left = allowed - varianceOfSamplePass(other) / std::max(1.0, otherSamplePasses);
    return left > 0.0 ? varianceOfSamplePass(part) / left : double(part.most);
}

// Doubles what takes away more of the variance for its cost.
SamplePasses doubled(const SampledPart& first, const SampledPart& second) {
    const auto worth = [](SampledPart part) {
        part.samplePasses = std::max(1u, part.samplePasses);
        return gainOfSamplePass(part, part.samplePasses);
    };
    const bool noSecond = second.samplePasses >= second.most;
    if (first.samplePasses < first.most && (noSecond || worth(first) > worth(second)))
        return {limited(first, 2.0 * first.samplePasses), second.samplePasses};
    return {first.samplePasses, limited(second, 2.0 * second.samplePasses)};
}

// Returns the step of the ladder before the one that `above` is on, or what the part has where that is more.
uint32_t stepBelow(const SampledPart& part, uint32_t above) {
    const uint32_t below = part.doubles                 ? above / 2
                           : std::has_single_bit(above) ? above / 4 * 3
                                                        : above / 3 * 2;
    return std::max(part.samplePasses, std::min(below, above));
}

// Takes each part to a step of the ladder. All begin below what they want; then the step comes next that
// takes away most of the variance for its cost, until what is left is allowed. If all went above at once, it
// would be half of that where steps double.
std::vector<uint32_t> onSteps(std::span<const SampledPart> parts, std::span<const double> wanted,
                              double allowed) {
    std::vector<uint32_t> samplePasses;
    std::vector<size_t> open; // parts that have a step to go
    double variance = 0;
    const auto varianceAt = [&](size_t i, uint32_t now) {
        return varianceOfSamplePass(parts[i]) / std::max(1u, now);
    };
    for (size_t i = 0; i < parts.size(); ++i) {
        const uint32_t above = limited(parts[i], wanted[i], kMostGrowthOfMany);
        samplePasses.push_back(above > wanted[i] ? stepBelow(parts[i], above) : above);
        variance += varianceAt(i, samplePasses[i]);
        if (samplePasses[i] < above) open.push_back(i);
    }
    while (variance > allowed && !open.empty()) {
        const auto worth = [&](size_t i) {
            const uint32_t above = limited(parts[i], wanted[i], kMostGrowthOfMany);
            return (varianceAt(i, samplePasses[i]) - varianceAt(i, above)) /
                   ((above - samplePasses[i]) * parts[i].costOfSamplePass);
        };
        const auto best = std::max_element(open.begin(), open.end(),
                                           [&](size_t a, size_t b) { return worth(a) < worth(b); });
        const size_t i = *best;
        open.erase(best);
        variance -= varianceAt(i, samplePasses[i]);
        samplePasses[i] = limited(parts[i], wanted[i], kMostGrowthOfMany);
        variance += varianceAt(i, samplePasses[i]);
    }
    return samplePasses;
}

} // namespace

// Parts that have more than the others would leave them keep what they have, and the others share what is
// left; so on, until none is added to those.
std::vector<uint32_t> samplePassesFor(std::span<const SampledPart> parts, double allowed) {
    std::vector<uint32_t> samplePasses;
    for (const SampledPart& part : parts)
        samplePasses.push_back(part.samplePasses);
    if (!(allowed > 0.0)) return samplePasses;
    std::vector<bool> settled(parts.size());
    std::vector<double> wanted(parts.size());
    for (bool more = true; more;) {
        double roots = 0, left = allowed;
        for (size_t i = 0; i < parts.size(); ++i) {
            if (settled[i])
                left -= varianceOfSamplePass(parts[i]) / std::max(1.0, wanted[i]);
            else
                roots += std::sqrt(varianceOfSamplePass(parts[i]) * parts[i].costOfSamplePass);
        }
        more = false;
        for (size_t i = 0; i < parts.size(); ++i) {
            if (settled[i]) continue;
            const SampledPart& part = parts[i];
            const double free =
                left > 0.0 ? std::sqrt(varianceOfSamplePass(part) / part.costOfSamplePass) * roots / left
                           : double(part.most);
            wanted[i] = within(part, part.variance > 0.0 ? free : 0.0);
            settled[i] = wanted[i] != free;
            more = more || settled[i];
        }
    }
    return onSteps(parts, wanted, allowed);
}

double gainOfSamplePass(const SampledPart& part, uint32_t now) {
    return part.variance * part.samplePasses / (static_cast<double>(now) * now * part.costOfSamplePass);
}

SamplePasses samplePassesFor(const SampledPart& first, const SampledPart& second, double allowed) {
    if (!(allowed > 0.0)) return doubled(first, second);
    const double roots = std::sqrt(varianceOfSamplePass(first) * first.costOfSamplePass) +
                         std::sqrt(varianceOfSamplePass(second) * second.costOfSamplePass);
    double a =
        within(first, std::sqrt(varianceOfSamplePass(first) / first.costOfSamplePass) * roots / allowed);
    const double wanted = samplePassesBeside(second, first, a, allowed), b = within(second, wanted);
    if (b != wanted) a = within(first, samplePassesBeside(first, second, b, allowed));
    const SamplePasses samplePasses{limited(first, a), limited(second, b)};
    return samplePasses == SamplePasses{first.samplePasses, second.samplePasses} ? doubled(first, second)
                                                                                 : samplePasses;
}

} // namespace relume
