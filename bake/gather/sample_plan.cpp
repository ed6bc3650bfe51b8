#include "bake/gather/sample_plan.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace relume {

uint32_t onLadder(double rounds, bool doubles) {
    constexpr double kAlmostWhole = 1e-9;
    const auto whole = static_cast<uint32_t>(std::ceil(rounds * (1.0 - kAlmostWhole)));
    const uint32_t above = std::bit_ceil(whole), between = above / 4 * 3;
    return !doubles && whole <= between ? between : above;
}

namespace {

// There are at most so many times as many sample passes as before.
constexpr uint32_t kMostGrowth = 8;

uint32_t limited(const SampledPart& part, double rounds) {
    if (part.rounds >= part.most) return part.rounds;
    const double most = double{kMostGrowth} * std::max(1u, part.rounds);
    return std::min(part.most, onLadder(std::clamp(rounds, double(part.rounds), most), part.doubles));
}

double varianceOfRound(const SampledPart& part) {
    return part.variance * std::max(1u, part.rounds);
}

double within(const SampledPart& part, double rounds) {
    return std::clamp(rounds, double(part.rounds), double(std::max(part.rounds, part.most)));
}

// Returns the sample passes by which the part comes to what the other one leaves of `allowed` with so many.
double roundsBeside(const SampledPart& part, const SampledPart& other, double otherRounds, double allowed) {
    if (part.variance <= 0.0) return part.rounds;
    const double left = allowed - varianceOfRound(other) / std::max(1.0, otherRounds);
    return left > 0.0 ? varianceOfRound(part) / left : double(part.most);
}

// Doubles what takes away more of the variance for its cost.
Rounds doubled(const SampledPart& first, const SampledPart& second) {
    const auto worth = [](SampledPart part) {
        part.rounds = std::max(1u, part.rounds);
        return gainOfRound(part, part.rounds);
    };
    const bool noSecond = second.rounds >= second.most;
    if (first.rounds < first.most && (noSecond || worth(first) > worth(second)))
        return {limited(first, 2.0 * first.rounds), second.rounds};
    return {first.rounds, limited(second, 2.0 * second.rounds)};
}

} // namespace

// Parts that have more than the others would leave them keep what they have, and the others share what is
// left; so on, until none is added to those.
std::vector<uint32_t> roundsFor(std::span<const SampledPart> parts, double allowed) {
    std::vector<uint32_t> rounds;
    for (const SampledPart& part : parts)
        rounds.push_back(part.rounds);
    if (!(allowed > 0.0)) return rounds;
    std::vector<bool> settled(parts.size());
    std::vector<double> wanted(parts.size());
    for (bool more = true; more;) {
        double roots = 0, left = allowed;
        for (size_t i = 0; i < parts.size(); ++i) {
            if (settled[i])
                left -= varianceOfRound(parts[i]) / std::max(1.0, wanted[i]);
            else
                roots += std::sqrt(varianceOfRound(parts[i]) * parts[i].costOfRound);
        }
        more = false;
        for (size_t i = 0; i < parts.size(); ++i) {
            if (settled[i]) continue;
            const SampledPart& part = parts[i];
            const double free = left > 0.0
                                    ? std::sqrt(varianceOfRound(part) / part.costOfRound) * roots / left
                                    : double(part.most);
            wanted[i] = within(part, part.variance > 0.0 ? free : 0.0);
            settled[i] = wanted[i] != free;
            more = more || settled[i];
        }
    }
    for (size_t i = 0; i < parts.size(); ++i)
        rounds[i] = limited(parts[i], wanted[i]);
    return rounds;
}

double gainOfRound(const SampledPart& part, uint32_t now) {
    return part.variance * part.rounds / (static_cast<double>(now) * now * part.costOfRound);
}

Rounds roundsFor(const SampledPart& first, const SampledPart& second, double allowed) {
    if (!(allowed > 0.0)) return doubled(first, second);
    const double roots = std::sqrt(varianceOfRound(first) * first.costOfRound) +
                         std::sqrt(varianceOfRound(second) * second.costOfRound);
    double a = within(first, std::sqrt(varianceOfRound(first) / first.costOfRound) * roots / allowed);
    const double wanted = roundsBeside(second, first, a, allowed), b = within(second, wanted);
    if (b != wanted) a = within(first, roundsBeside(first, second, b, allowed));
    const Rounds rounds{limited(first, a), limited(second, b)};
    return rounds == Rounds{first.rounds, second.rounds} ? doubled(first, second) : rounds;
}

} // namespace relume
