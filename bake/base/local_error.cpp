#include "bake/base/local_error.h"

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

} // namespace

double medianLight(std::span<const uint32_t> lightBins) {
    return percentile(lightBins, 0.5, kLights);
}

LocalError withBias(const LocalError& error, double noise, double bias) {
    if (!(noise > 0) || !(bias > 0)) return error;
    const double growth = std::sqrt(1.0 + bias / noise);
    return {.p50 = growth * error.p50,
            .p90 = growth * error.p90,
            .p95 = growth * error.p95,
            .p99 = growth * error.p99};
}

LocalError localErrorOf(std::span<const uint32_t> errorBins) {
    const auto at = [&](double share) { return percentile(errorBins, share, kErrors); };
    return {.p50 = at(0.5), .p90 = at(0.9), .p95 = at(0.95), .p99 = at(0.99)};
}

} // namespace relume
