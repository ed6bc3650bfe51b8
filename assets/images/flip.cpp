#include "assets/images/flip.h"

#include "assets/base/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace relume {
namespace {

using Plane = std::vector<float>;

// Colour ----------------------------------------------------------------------------------------------------

glm::dvec3 fromChromaticity(double x, double y) {
    return {x / y, 1.0, (1.0 - x - y) / y};
}

// Returns the matrix from linear RGB of sRGB's primaries and D65 white [IEC 61966-2-1] to XYZ divided by that
// white.
glm::dmat3 rgbToWhiteRelativeXyz() {
    const glm::dmat3 primaries(fromChromaticity(0.64, 0.33), fromChromaticity(0.30, 0.60),
                               fromChromaticity(0.15, 0.06));
    const glm::dvec3 white = fromChromaticity(0.3127, 0.3290);
    const glm::dvec3 amounts = glm::inverse(primaries) * white;
    glm::dmat3 result;
    for (int c = 0; c < 3; ++c)
        result[c] = amounts[c] * primaries[c] / white;
    return result;
}

struct Colours {
    glm::dmat3 toXyz = rgbToWhiteRelativeXyz(), fromXyz = glm::inverse(toXyz);

    // Converts to the linear opponent space YyCxCz, in which contrast sensitivities are known [section
    // 4.1.1].
    glm::dvec3 opponent(const glm::dvec3& rgb) const {
        const glm::dvec3 xyz = toXyz * rgb;
        return {116.0 * xyz.y - 16.0, 500.0 * (xyz.x - xyz.y), 200.0 * (xyz.y - xyz.z)};
    }
    glm::dvec3 rgbFromOpponent(const glm::dvec3& ycc) const {
        const double y = (ycc.x + 16.0) / 116.0;
        return fromXyz * glm::dvec3(y + ycc.y / 500.0, y, y - ycc.z / 200.0);
    }
    // Converts to CIELAB with the Hunt effect: colours look paler where it is dark [equation 8].
    glm::dvec3 hunt(const glm::dvec3& rgb) const {
        const glm::dvec3 xyz = toXyz * rgb;
        const auto f = [](double t) {
            constexpr double kDelta = 6.0 / 29.0;
            return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3.0 * kDelta * kDelta) + 4.0 / 29.0;
        };
        const glm::dvec3 g(f(xyz.x), f(xyz.y), f(xyz.z));
        const double lightness = 116.0 * g.y - 16.0, strength = 0.01 * lightness;
        return {lightness, strength * 500.0 * (g.x - g.y), strength * 200.0 * (g.y - g.z)};
    }
};

// Returns the distance HyAB: city block between lightness and chroma [equation 9].
double hyab(const glm::dvec3& a, const glm::dvec3& b) {
    return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

constexpr double kColourPower = 0.7;             // q_c: large differences count less
constexpr double kKnee = 0.4, kKneeValue = 0.95; // p_c, p_t
constexpr double kFeaturePower = 0.5;            // q_f
constexpr double kFeatureWidth = 0.082;          // w [degrees]: of the edges and points that attract

// Compresses the range beyond the knee, where all differences look the same [equation 11].
double redistribute(double difference, double largest) {
    const double knee = kKnee * largest;
    if (difference < knee) return difference / knee * kKneeValue;
    return kKneeValue + (difference - knee) / (largest - knee) * (1.0 - kKneeValue);
}

// Filters ---------------------------------------------------------------------------------------------------

using Kernel = std::vector<float>; // 2 radius + 1 weights

struct Frame {
    int width, height;

    size_t at(int x, int y) const { return static_cast<size_t>(y) * width + x; }

    // Filters the rows by `across`, then the columns by `down`; beyond the border its texels go on.
    Plane filtered(const Plane& plane, const Kernel& across, const Kernel& down) const {
        const int radius = static_cast<int>(across.size() / 2);
        Plane rows(plane.size()), result(plane.size(), 0.0f), padded(static_cast<size_t>(width) + 2 * radius);
        for (int y = 0; y < height; ++y) {
            const float* line = &plane[at(0, y)];
            std::fill_n(padded.begin(), radius, line[0]);
            std::copy_n(line, width, padded.begin() + radius);
            std::fill_n(padded.end() - radius, radius, line[width - 1]);
            for (int x = 0; x < width; ++x) {
                float sum = 0;
                for (int k = 0; k <= 2 * radius; ++k)
                    sum += across[k] * padded[x + k];
                rows[at(x, y)] = sum;
            }
        }
        for (int y = 0; y < height; ++y) {
            float* line = &result[at(0, y)];
            for (int k = -radius; k <= radius; ++k) {
                const float* source = &rows[at(0, std::clamp(y + k, 0, height - 1))];
                for (int x = 0; x < width; ++x)
                    line[x] += down[k + radius] * source[x];
            }
        }
        return result;
    }
};

// A contrast sensitivity is a sum of Gaussians a sqrt(pi / b) exp(-pi^2 r^2 / b), r in degrees [equation 3,
// table 1].
struct Sensitivity {
    std::array<double, 2> a, b;
};
constexpr Sensitivity kAchromatic{{1.0, 0.0}, {0.0047, 1e-5}};
constexpr Sensitivity kRedGreen{{1.0, 0.0}, {0.0053, 1e-5}};
constexpr Sensitivity kBlueYellow{{34.1, 13.5}, {0.04, 0.025}};

// Returns the plane filtered by a sensitivity, scaled so that its weights sum to 1.
Plane sensed(const Frame& frame, const Plane& plane, const Sensitivity& sensitivity, double pixelsPerDegree) {
    // All filters reach three standard deviations of the widest one: sigma^2 = b / (2 pi^2).
    const double widest = kBlueYellow.b[0];
    const int radius =
        static_cast<int>(std::ceil(3.0 * std::sqrt(widest / 2.0) / std::numbers::pi * pixelsPerDegree));
    std::array<Kernel, 2> kernels;
    std::array<double, 2> amounts{};
    double whole = 0;
    for (int g = 0; g < 2; ++g) {
        if (sensitivity.a[g] == 0.0) continue;
        double sum = 0;
        for (int k = -radius; k <= radius; ++k) {
            const double r = k / pixelsPerDegree;
            const double weight = std::exp(-std::numbers::pi * std::numbers::pi * r * r / sensitivity.b[g]);
            kernels[g].push_back(static_cast<float>(weight));
            sum += weight;
        }
        for (float& weight : kernels[g])
            weight = static_cast<float>(weight / sum);
        amounts[g] = sensitivity.a[g] * std::sqrt(std::numbers::pi / sensitivity.b[g]) * sum * sum;
        whole += amounts[g];
    }
    Plane result(plane.size(), 0.0f);
    for (int g = 0; g < 2; ++g) {
        if (kernels[g].empty()) continue;
        const Plane part = frame.filtered(plane, kernels[g], kernels[g]);
        const auto share = static_cast<float>(amounts[g] / whole);
        for (size_t i = 0; i < result.size(); ++i)
            result[i] += share * part[i];
    }
    return result;
}

// Runs the colour pipeline [section 4.1]: it returns what is left of a picture at this distance, in
// Hunt-adjusted CIELAB.
std::vector<glm::vec3> perceived(const FlipInput& input, const std::vector<glm::vec3>& picture,
                                 const Colours& colours, double pixelsPerDegree) {
    const Frame frame{static_cast<int>(input.width), static_cast<int>(input.height)};
    const size_t count = picture.size();
    std::array<Plane, 3> planes;
    for (Plane& plane : planes)
        plane.assign(count, 0.0f);
    Plane weight(count, 0.0f);
    for (size_t i = 0; i < count; ++i) {
        if (!input.covered[i]) continue;
        const glm::dvec3 ycc = colours.opponent(picture[i]);
        for (int c = 0; c < 3; ++c)
            planes[c][i] = static_cast<float>(ycc[c]);
        weight[i] = 1.0f;
    }
    for (int c = 0; c < 3; ++c) {
        const Sensitivity& sensitivity = c == 0 ? kAchromatic : c == 1 ? kRedGreen : kBlueYellow;
        const Plane sum = sensed(frame, planes[c], sensitivity, pixelsPerDegree);
        const Plane share = sensed(frame, weight, sensitivity, pixelsPerDegree);
        for (size_t i = 0; i < count; ++i)
            planes[c][i] = input.covered[i] ? sum[i] / share[i] : 0.0f;
    }
    std::vector<glm::vec3> result(count);
    for (size_t i = 0; i < count; ++i) {
        const glm::dvec3 rgb = colours.rgbFromOpponent({planes[0][i], planes[1][i], planes[2][i]});
        result[i] = colours.hunt(glm::clamp(rgb, 0.0, 1.0));
    }
    return result;
}

// Holds a Gaussian and its first and second derivatives; positive weights sum to 1, negative ones to -1
// [section 4.2].
struct FeatureKernels {
    Kernel smooth, edge, point;
};

FeatureKernels featureKernels(double pixelsPerDegree) {
    const double sigma = 0.5 * kFeatureWidth * pixelsPerDegree;
    const int radius = static_cast<int>(std::ceil(3.0 * sigma));
    FeatureKernels kernels;
    for (int k = -radius; k <= radius; ++k) {
        const double gauss = std::exp(-k * k / (2.0 * sigma * sigma));
        kernels.smooth.push_back(static_cast<float>(gauss));
        kernels.edge.push_back(static_cast<float>(-k * gauss));
        kernels.point.push_back(static_cast<float>((k * k / (sigma * sigma) - 1.0) * gauss));
    }
    const auto normalise = [](Kernel& kernel) {
        double positive = 0, negative = 0;
        for (float weight : kernel)
            (weight > 0 ? positive : negative) += weight;
        for (float& weight : kernel)
            weight = static_cast<float>(weight > 0     ? weight / positive
                                        : negative < 0 ? -weight / negative
                                                       : 0);
    };
    normalise(kernels.smooth);
    normalise(kernels.edge);
    normalise(kernels.point);
    return kernels;
}

// Returns how strong an edge (or point) each texel has: the length of the filter's answers across and down.
// The filters sum to 0, so a texel left out counts as one like the centre.
Plane features(const FlipInput& input, const Plane& luminance, const Kernel& kernel, const Kernel& smooth) {
    const Frame frame{static_cast<int>(input.width), static_cast<int>(input.height)};
    Plane weight(luminance.size());
    for (size_t i = 0; i < weight.size(); ++i)
        weight[i] = input.covered[i] ? 1.0f : 0.0f;
    const auto answer = [&](const Kernel& across, const Kernel& down) {
        Plane sum = frame.filtered(luminance, across, down);
        const Plane share = frame.filtered(weight, across, down);
        for (size_t i = 0; i < sum.size(); ++i)
            sum[i] -= luminance[i] * share[i];
        return sum;
    };
    Plane result = answer(kernel, smooth);
    const Plane down = answer(smooth, kernel);
    for (size_t i = 0; i < result.size(); ++i)
        result[i] = std::hypot(result[i], down[i]);
    return result;
}

// Returns the achromatic channel of the unfiltered picture, 0 to 1; it is 0 where nothing is covered.
Plane luminanceOf(const FlipInput& input, const std::vector<glm::vec3>& picture, const Colours& colours) {
    Plane result(picture.size(), 0.0f);
    for (size_t i = 0; i < result.size(); ++i)
        if (input.covered[i]) result[i] = static_cast<float>((colours.toXyz * glm::dvec3(picture[i])).y);
    return result;
}

} // namespace

std::vector<float> flip(const FlipInput& input, double pixelsPerDegree) {
    const size_t count = static_cast<size_t>(input.width) * input.height;
    ASSERT(input.a.size() == count && input.b.size() == count && input.covered.size() == count);
    ASSERT(pixelsPerDegree > 0.0);
    const Colours colours;
    const FeatureKernels kernels = featureKernels(pixelsPerDegree);
    const Plane luminanceA = luminanceOf(input, input.a, colours);
    const Plane luminanceB = luminanceOf(input, input.b, colours);
    const auto featureChange = [&](const Kernel& kernel) {
        Plane change = features(input, luminanceA, kernel, kernels.smooth);
        const Plane other = features(input, luminanceB, kernel, kernels.smooth);
        for (size_t i = 0; i < count; ++i)
            change[i] = std::abs(change[i] - other[i]);
        return change;
    };
    const Plane edges = featureChange(kernels.edge), points = featureChange(kernels.point);
    const std::vector<glm::vec3> a = perceived(input, input.a, colours, pixelsPerDegree);
    const std::vector<glm::vec3> b = perceived(input, input.b, colours, pixelsPerDegree);

    // Green against blue is the largest difference there is [equation 10].
    const double largest =
        std::pow(hyab(colours.hunt({0.0, 1.0, 0.0}), colours.hunt({0.0, 0.0, 1.0})), kColourPower);
    Plane result(count, 0.0f);
    for (size_t i = 0; i < count; ++i) {
        if (!input.covered[i]) continue;
        const double colour = redistribute(std::pow(hyab(a[i], b[i]), kColourPower), largest);
        const double feature =
            std::pow(std::max(edges[i], points[i]) / std::sqrt(2.0), kFeaturePower);    // [equation 15]
        result[i] = static_cast<float>(std::pow(colour, 1.0 - std::min(feature, 1.0))); // [equation 16]
    }
    return result;
}

} // namespace relume
