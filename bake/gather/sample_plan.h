#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace relume {

/// Beyond so many directions per patch no error is worth the time. Points on lights have the same limit where
/// all patches get as many.
constexpr uint32_t kMaxSamplesOfPatch = 65536;

/// A chunk has at most so many sample passes of direct light by a plan of its own. A texel that touches a
/// lamp, of a hundred times the mean light, needs many times those that all others are content with, and
/// costs next to nothing.
constexpr uint32_t kMaxDirectSamplePasses = 65536;

/// Part of the error of light: its variance falls with the sample passes that it is made of.
struct SampledPart {
    uint32_t samplePasses = 0;   // so far
    uint32_t most = 0;           // sample passes that there can be
    double variance = 0;         // of the part, as it is
    double costOfSamplePass = 1; // in the same unit as the other part's
    bool doubles = false;        // their number is a power of two, unless it is the most
    double fall = 1;             // the variance goes as one over this power of them: fallOfVariance()
};

/// Returns the power of the number of sample passes by which a variance has fallen from one level to the
/// next, at least 1 (independent samples) and at most 1.5 (stratified points at an edge [Mitchell 1996,
/// Consequences of Stratified Sampling in Graphics]); `known` where these levels do not tell.
double fallOfVariance(uint32_t fewer, double varianceOfFewer, uint32_t more, double varianceOfMore,
                      double known);

/// Returns what one more sample pass after `now` of them takes away from the part's variance, for its cost.
/// The variance is as it was after part.samplePasses of them; it falls as 1 / samplePasses at least.
double gainOfSamplePass(const SampledPart& part, uint32_t now);

/// Returns the least number on the ladder of sample passes (1, 2, 3, 4, 6, 8, 12, 16, ...) that is so many at
/// least, so that what is planned on its own meets on few numbers; with `doubles` of the powers of two.
uint32_t onLadder(double samplePasses, bool doubles = false);

/// Returns for each part the sample passes that cost least in all of those by which the parts' variances come
/// to `allowed` together (a Lagrange multiplier: where variances fall as one over their number, that goes as
/// the root of variance over cost), but no part has less than it has. They are on the ladder and no more than
/// a few times as many as there are. Where `allowed` is not positive each has as many as it has.
std::vector<uint32_t> samplePassesFor(std::span<const SampledPart> parts, double allowed);

struct SamplePasses {
    uint32_t first = 0, second = 0;

    bool operator==(const SamplePasses&) const = default;
};

/// Returns the sample passes that cost least of those by which both variances come to `allowed` in all, in
/// the same way. They are no more than a few times as many as there are, for what is known of the variances
/// is not exact. They are steps of a ladder, so that layers meet on them. Of one part at least there are more
/// than before, while there can be.
SamplePasses samplePassesFor(const SampledPart& first, const SampledPart& second, double allowed);

} // namespace relume
