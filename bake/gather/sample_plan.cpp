#include "bake/gather/sample_plan.h"

#include <algorithm>
#include <array>
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

double varianceAt(const SampledPart& part, double samplePasses) {
    return part.variance * std::pow(std::max(1u, part.samplePasses) / std::max(1.0, samplePasses), part.fall);
}

double within(const SampledPart& part, double samplePasses) {
    return std::clamp(samplePasses, double(part.samplePasses),
                      double(std::max(part.samplePasses, part.most)));
}

// Returns the sample passes at which one more takes away cost / multiplier of the variance.
double samplePassesAt(const SampledPart& part, double multiplier) {
    if (part.variance <= 0.0) return part.samplePasses;
    const double ofOne = part.variance * std::pow(std::max(1u, part.samplePasses), part.fall);
    return within(part,
                  std::pow(multiplier * part.fall * ofOne / part.costOfSamplePass, 1.0 / (part.fall + 1.0)));
}

// Returns the sample passes that cost least of those that leave no more than `allowed`, or the most where
// none do. The multiplier is found by halving: all numbers grow with it.
std::vector<double> cheapestSamplePasses(std::span<const SampledPart> parts, double allowed) {
    constexpr double kLeastExponent = -512, kMostExponent = 512; // of two
    constexpr uint32_t kHalvings = 64;                           // to the last bit
    const auto left = [&](double exponent) {
        double sum = 0;
        for (const SampledPart& part : parts)
            sum += varianceAt(part, samplePassesAt(part, std::exp2(exponent)));
        return sum;
    };
    double low = kLeastExponent, high = kMostExponent;
    for (uint32_t i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        (left(middle) > allowed ? low : high) = middle;
    }
    std::vector<double> samplePasses;
    for (const SampledPart& part : parts)
        samplePasses.push_back(samplePassesAt(part, std::exp2(high)));
    return samplePasses;
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
    for (size_t i = 0; i < parts.size(); ++i) {
        const uint32_t above = limited(parts[i], wanted[i], kMostGrowthOfMany);
        samplePasses.push_back(above > wanted[i] ? stepBelow(parts[i], above) : above);
        variance += varianceAt(parts[i], samplePasses[i]);
        if (samplePasses[i] < above) open.push_back(i);
    }
    while (variance > allowed && !open.empty()) {
        const auto worth = [&](size_t i) {
            const uint32_t above = limited(parts[i], wanted[i], kMostGrowthOfMany);
            return (varianceAt(parts[i], samplePasses[i]) - varianceAt(parts[i], above)) /
                   ((above - samplePasses[i]) * parts[i].costOfSamplePass);
        };
        const auto best = std::max_element(open.begin(), open.end(),
                                           [&](size_t a, size_t b) { return worth(a) < worth(b); });
        const size_t i = *best;
        open.erase(best);
        variance -= varianceAt(parts[i], samplePasses[i]);
        samplePasses[i] = limited(parts[i], wanted[i], kMostGrowthOfMany);
        variance += varianceAt(parts[i], samplePasses[i]);
    }
    return samplePasses;
}

} // namespace

double fallOfVariance(uint32_t fewer, double varianceOfFewer, uint32_t more, double varianceOfMore,
                      double known) {
    constexpr double kIndependent = 1.0, kStratified = 1.5;
    if (fewer == 0 || more <= fewer || varianceOfFewer <= 0.0 || varianceOfMore <= 0.0) return known;
    const double fall = std::log(varianceOfFewer / varianceOfMore) / std::log(double(more) / fewer);
    return std::clamp(fall, kIndependent, kStratified);
}

std::vector<uint32_t> samplePassesFor(std::span<const SampledPart> parts, double allowed) {
    if (allowed > 0.0) return onSteps(parts, cheapestSamplePasses(parts, allowed), allowed);
    std::vector<uint32_t> samplePasses;
    for (const SampledPart& part : parts)
        samplePasses.push_back(part.samplePasses);
    return samplePasses;
}

double gainOfSamplePass(const SampledPart& part, uint32_t now) {
    return part.variance * part.samplePasses / (static_cast<double>(now) * now * part.costOfSamplePass);
}

SamplePasses samplePassesFor(const SampledPart& first, const SampledPart& second, double allowed) {
    if (!(allowed > 0.0)) return doubled(first, second);
    const std::vector<double> wanted = cheapestSamplePasses(std::array{first, second}, allowed);
    const SamplePasses samplePasses{limited(first, wanted[0]), limited(second, wanted[1])};
    return samplePasses == SamplePasses{first.samplePasses, second.samplePasses} ? doubled(first, second)
                                                                                 : samplePasses;
}

} // namespace relume
