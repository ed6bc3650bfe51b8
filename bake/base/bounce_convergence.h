#pragma once

#include <algorithm>

namespace relume {

/// Bounces may leave this share of the error that is asked for.
constexpr double kIterationShare = 0.2;
constexpr double kLeastIterationError = 1e-4;
/// Bounces over links that are kept may leave this share, as they cost no ray. What they leave is told
/// against the mean light, and a place that later bounces light has little of that: there it is a larger
/// share.
constexpr double kKeptIterationShare = 0.02;

/// They may leave such a share of each patch's own light, on the mean over all patches: hardly anything of
/// the mean light of a level in the sun lies in its rooms, where most of the light is that of later bounces.
constexpr double kLocalIterationAim = 0.002;
/// Layers may leave more: in most places a layer's share of the light is small, and layers gather over all
/// links each time.
constexpr double kLocalIterationAimOfLayers = 0.005;

/// Returns what bounces over such links may leave where this error is asked for, 0: none.
inline double keptIterationAim(double error) {
    return std::max(kKeptIterationShare * error, kLeastIterationError);
}

/// Tells how much of the mean light is still to come, if what each bounce adds goes on as a geometric series.
/// It goes by the mean, for the root mean square says little while a few bright texels make most of it.
struct BounceConvergence {
    double mean = -1; // after the last bounce; negative: none yet
    double gain = 0;  // what the last bounce added
    double ratio = 0; // the last gain over the one before
    double left = 1;  // relative to the mean; 1 until it can be told

    /// Takes the mean light before the first bounce, then after each.
    void add(double now) {
        const double added = mean >= 0 ? now - mean : 0.0;
        if (mean >= 0 && added <= 0.0) {
            ratio = left = 0.0;
        } else if (gain > 0) {
            ratio = added / gain;
            left = ratio < 1.0 ? std::min(1.0, added * ratio / (1.0 - ratio) / now) : 1.0;
        }
        gain = added;
        mean = now;
    }
    /// Counts one more bounce of the same light.
    void bounce() { left *= ratio; }
    /// Counts one more bounce by new samples, from the mean light of so many sample passes; the mean of all
    /// is the light then.
    void samplePass(double samplePasses) { left *= (samplePasses + ratio) / (samplePasses + 1.0); }
};

} // namespace relume
