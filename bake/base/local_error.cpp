#include "bake/base/local_error.h"

#include "assets/base/portions.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace relume {
namespace {

// Bins of equal ratios, as lib/local_error.glsl has them.
struct Scale {
    float leastOctave, binsPerOctave;
};
const Scale kLights{shader::kLeastLightOctave, shader::kLightBinsPerOctave};
const Scale kErrors{shader::kLeastErrorOctave, shader::kErrorBinsPerOctave};

// Returns the value below which this share of all lies. What is in the first bin is nothing.
double percentile(std::span<const uint32_t> bins, double share, const Scale& scale) {
    const double wanted = share * static_cast<double>(std::accumulate(bins.begin(), bins.end(), uint64_t{0}));
    double below = 0;
    for (size_t bin = 0; bin < bins.size(); ++bin) {
        const double count = bins[bin];
        if (count == 0 || below + count < wanted) {
            below += count;
            continue;
        }
        if (bin == 0) return 0.0;
        const double place = static_cast<double>(bin) + (wanted - below) / count;
        return std::exp2(scale.leastOctave + place / scale.binsPerOctave);
    }
    return 0.0;
}

// Returns the share of texels that are off by more than this, relatively.
double shareBeyond(double error, std::span<const double> deviations) {
    double beyond = 0, all = 0;
    for (size_t bin = 0; bin < deviations.size(); ++bin) {
        all += deviations[bin];
        if (bin == 0 || deviations[bin] == 0) continue; // the first bin's are not off
        const double place = (static_cast<double>(bin) + 0.5) / double{shader::kErrorBinsPerOctave};
        const double deviation = std::exp2(double{shader::kLeastErrorOctave} + place);
        beyond += deviations[bin] * std::erfc(error / (std::sqrt(2.0) * deviation));
    }
    return all > 0 ? beyond / all : 0.0;
}

// Returns the error that this share of all texels stays below, by halving its logarithm's range.
double normalPercentile(double share, std::span<const double> deviations) {
    double low = -60.0, high = 60.0; // octaves
    if (shareBeyond(std::exp2(low), deviations) <= 1.0 - share) return 0.0;
    constexpr int kHalvings = 24; // to a hundred thousandth of an octave
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        (shareBeyond(std::exp2(middle), deviations) > 1.0 - share ? low : high) = middle;
    }
    return std::exp2(high);
}

// A chunk's bias is taken to be there from so many standard errors of its estimate on.
constexpr double kSurely = 2.0;
// Portions are the same however many threads there are, so that sums round alike.
constexpr size_t kBiasPortion = 4096; // chunks

// Sums over chunks whose bias does not stand out, or is below nothing.
struct BiasSums {
    double noise = 0, bias = 0;
    double squares = 0, texels = 0; // of bias over noise
};

template<typename Add>
BiasSums sumOver(WorkerPool& pool, std::span<const ChunkSquares> chunks, const Add& add) {
    std::vector<BiasSums> parts((chunks.size() + kBiasPortion - 1) / kBiasPortion);
    runPortions(pool, chunks.size(), kBiasPortion, [&](size_t begin, size_t end) {
        for (const ChunkSquares& chunk : chunks.subspan(begin, end - begin))
            add(parts[begin / kBiasPortion], chunk);
    });
    BiasSums all;
    for (const BiasSums& part : parts) {
        all.noise += part.noise;
        all.bias += part.bias;
        all.squares += part.squares;
        all.texels += part.texels;
    }
    return all;
}

/// Two kinds of texels of a chunk, by the squares of all texels that are off as this kind.
struct Kinds {
    double share = 1;             // of texels that are of the first kind
    double first = 0, second = 0; // sums of squares, were all texels of this kind
};

// Returns the share of a chunk's texels in which its bias lies, from how much its fourth powers exceed what
// they would be were it the same everywhere. Those of a normal distribution are kNormal times that.
double shareOfBias(const ChunkSquares& chunk) {
    constexpr double kNormal = 3.0;
    const double even = chunk.bias * chunk.bias / chunk.texels;
    return kNormal * even < chunk.fourth ? std::max(kNormal * even / chunk.fourth, 1.0 / chunk.texels) : 1.0;
}

// Counts texels by their standard deviation, which kinds(chunk) tells.
template<typename Tell>
std::vector<double> deviationBins(WorkerPool& pool, std::span<const ChunkSquares> chunks, const Tell& kinds) {
    std::vector<std::vector<double>> parts((chunks.size() + kBiasPortion - 1) / kBiasPortion);
    runPortions(pool, chunks.size(), kBiasPortion, [&](size_t begin, size_t end) {
        std::vector<double>& bins = parts[begin / kBiasPortion];
        bins.assign(shader::kErrorBins, 0.0);
        for (const ChunkSquares& chunk : chunks.subspan(begin, end - begin)) {
            if (!(chunk.texels > 0)) continue;
            const auto add = [&](double share, double squares) {
                const auto deviation = static_cast<float>(std::sqrt(squares / chunk.texels));
                bins[shader::binOf(deviation, shader::kLeastErrorOctave, shader::kErrorBinsPerOctave,
                                   shader::kErrorBins)] += share * chunk.texels;
            };
            const Kinds of = kinds(chunk);
            add(of.share, of.first);
            if (of.share < 1.0) add(1.0 - of.share, of.second);
        }
    });
    std::vector<double> all(shader::kErrorBins, 0.0);
    for (const std::vector<double>& part : parts)
        for (size_t bin = 0; bin < all.size(); ++bin)
            all[bin] += part[bin];
    return all;
}

} // namespace

double medianLight(std::span<const uint32_t> lightBins) {
    return percentile(lightBins, 0.5, kLights);
}

LocalError localErrorOf(std::span<const uint32_t> errorBins) {
    const auto at = [&](double share) { return percentile(errorBins, share, kErrors); };
    return {.p50 = at(0.5), .p90 = at(0.9), .p95 = at(0.95), .p99 = at(0.99)};
}

LocalError normalErrorOf(std::span<const double> deviationBins) {
    const auto at = [&](double share) { return normalPercentile(share, deviationBins); };
    return {.p50 = at(0.5), .p90 = at(0.9), .p95 = at(0.95), .p99 = at(0.99)};
}

// The estimate of a chunk's bias is as noisy as what smoothing takes away, and so in proportion to the noise
// that is left; estimates below nothing, where there can be no bias, tell how noisy. Few chunks decide about
// one texel in a hundred, and their estimates are the most uncertain: that percentile grows as p95 does.
LocalError withBias(WorkerPool& pool, const LocalError& noise, std::span<const ChunkSquares> chunks) {
    const BiasSums below = sumOver(pool, chunks, [](BiasSums& sums, const ChunkSquares& chunk) {
        if (!(chunk.bias < 0.0) || !(chunk.noise > 0.0)) return;
        sums.squares += chunk.texels * chunk.bias * chunk.bias / (chunk.noise * chunk.noise);
        sums.texels += chunk.texels;
    });
    const double surely = below.texels > 0 ? kSurely * std::sqrt(below.squares / below.texels) : 0.0;
    const auto standsOut = [&](const ChunkSquares& chunk) { return chunk.bias > surely * chunk.noise; };
    const BiasSums rest = sumOver(pool, chunks, [&](BiasSums& sums, const ChunkSquares& chunk) {
        if (standsOut(chunk)) return;
        sums.noise += chunk.noise;
        sums.bias += chunk.bias;
    });
    const double spread = rest.noise > 0 ? std::max(0.0, rest.bias) / rest.noise : 0.0;
    const LocalError before = normalErrorOf(
        deviationBins(pool, chunks, [](const ChunkSquares& chunk) { return Kinds{.first = chunk.noise}; }));
    const LocalError after = normalErrorOf(deviationBins(pool, chunks, [&](const ChunkSquares& chunk) {
        if (!standsOut(chunk)) return Kinds{.first = chunk.noise * (1.0 + spread)};
        const double share = shareOfBias(chunk);
        return Kinds{.share = share, .first = chunk.noise + chunk.bias / share, .second = chunk.noise};
    }));
    const auto grown = [](double told, double from, double to) { return from > 0 ? told * to / from : told; };
    return {.p50 = grown(noise.p50, before.p50, after.p50),
            .p90 = grown(noise.p90, before.p90, after.p90),
            .p95 = grown(noise.p95, before.p95, after.p95),
            .p99 = grown(noise.p99, before.p95, after.p95)};
}

} // namespace relume
