#pragma once

#include <cstdint>

namespace relume {

/// A part of a layer's error: its variance falls as one over the rounds of samples it is made of.
struct SampledPart {
    uint32_t rounds = 0;    // so far
    uint32_t most = 0;      // rounds that there can be
    double variance = 0;    // of the part, as it is
    double costOfRound = 1; // in what it is counted in for the other part, too
};

struct Rounds {
    uint32_t first = 0, second = 0;

    bool operator==(const Rounds&) const = default;
};

/// Rounds that cost least of those by which both variances come to `allowed` in all (a Lagrange multiplier:
/// rounds as the root of variance over cost), no more than a few times as many as there are, for what is
/// known of the variances is not exact. As steps of a ladder, so that layers meet on them. More than before
/// of one at least, while there can be.
Rounds roundsFor(const SampledPart& first, const SampledPart& second, double allowed);

} // namespace relume
