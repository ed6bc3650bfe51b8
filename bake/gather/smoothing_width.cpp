#include "bake/gather/smoothing_width.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace relume {
namespace {

// Smoothing is as wide as its error is small. These are the widths that are tried [texels], and how often the
// model is asked again with what the new width showed.
constexpr double kSigmaStep = 0.1, kLeastWidth = 0.3, kMostSigma = 4.0;
constexpr double kSigmaGrowth = 2.0; // per try
constexpr uint32_t kSigmaTries = 3;
// A width within this factor of the best one is left alone: the error hardly depends on it there.
constexpr double kSigmaSlack = 1.1;

// Returns the variance of a Gaussian of this width that is sampled at whole texels [texels^2]: it is less
// than sigma^2 where that is narrow, and nothing below the least width.
double kernelVariance(double sigma) {
    if (sigma < kLeastWidth) return 0.0;
    double sum = 0.5, squares = 0.0; // over one half of it
    for (int k = 1; k <= 4.0 * kMostSigma; ++k) {
        const double weight = std::exp(-0.5 * k * k / (sigma * sigma));
        sum += weight;
        squares += k * k * weight;
    }
    return squares / sum;
}

} // namespace

double smoothedVariance(const shader::ResolveSums& sums) {
    return sums.indirect + std::max(0.0f, sums.bias);
}

shader::ResolveSums SmoothingWidth::converge(const std::function<shader::ResolveSums(double)>& resolve) {
    shader::ResolveSums sums = resolve(sigma);
    double best = sigma, least = smoothedVariance(sums);
    for (uint32_t tries = 1; tries < kSigmaTries; ++tries) {
        const double before = sigma;
        adapt(sums);
        if (sigma == before) break;
        sums = resolve(sigma);
        if (smoothedVariance(sums) >= least) continue;
        best = sigma;
        least = smoothedVariance(sums);
    }
    if (sigma != best) {
        sigma = best;
        sums = resolve(sigma);
    }
    return sums;
}

// Takes the best width: the mean of a smooth function over a width sigma is off by sigma^2 times its
// curvature, and independent noise falls with the area, 1 / (1 + a sigma^2); the squares of both, as measured
// at one width, tell it. The bias found holds on where nothing is smoothed, which shows none.
void SmoothingWidth::adapt(const shader::ResolveSums& sums) {
    if (!(sums.raw > 0.0f)) {
        sigma = 0;
        return;
    }
    constexpr double kGaussian = 4.0 * std::numbers::pi; // the ideal one's share, until it is measured
    const double v = kernelVariance(sigma);
    if (v > 0) curvature = std::max(0.0f, sums.bias) / (v * v);
    const double a =
        v > 0 && sums.indirect > 0.0f ? std::max(0.0, sums.raw / sums.indirect - 1.0) / v : kGaussian;
    const double b = curvature >= 0 ? curvature : sums.raw;
    const auto error = [&](double width) {
        const double t = kernelVariance(width);
        return sums.raw / (1.0 + a * t) + b * t * t;
    };
    // Far from the width that was measured the model says little.
    const double most = std::min(kMostSigma, kSigmaGrowth * std::max(sigma, kLeastWidth));
    double best = 0;
    for (double width = kLeastWidth; width <= most; width += kSigmaStep) {
        if (error(width) < error(best)) best = width;
    }
    const bool close = best < kSigmaSlack * sigma && sigma < kSigmaSlack * best;
    if (!close) sigma = best;
}

} // namespace relume
