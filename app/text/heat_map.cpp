#include "app/text/heat_map.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/constants.hpp>

namespace relume {
namespace {

constexpr double kShownShare = 0.99; // share of the values a scale must hold
constexpr float kGrey = 0.2f;        // linear; no colour of the ramp

} // namespace

// The colours are a helix around the grey diagonal of the RGB cube, with its deviation scaled by t (1 - t) /
// 2 [Green 2011: A colour scheme for the display of astronomical intensity images, equation 2].
glm::vec3 heatColour(double t) {
    constexpr double kStart = 0.5, kRotations = -1.1, kHue = 1.2; // begins blue, ends yellow; colourful
    t = std::clamp(t, 0.0, 1.0);
    const double angle = 2.0 * glm::pi<double>() * (kStart / 3.0 + 1.0 + kRotations * t);
    const double amplitude = kHue * t * (1.0 - t) / 2.0;
    const double c = amplitude * std::cos(angle), s = amplitude * std::sin(angle);
    return glm::clamp(
        glm::dvec3(t - 0.14861 * c + 1.78277 * s, t - 0.29227 * c - 0.90649 * s, t + 1.97294 * c), 0.0, 1.0);
}

double heatScale(const std::vector<float>& values, const std::vector<bool>& covered) {
    std::vector<float> sorted;
    for (size_t i = 0; i < values.size(); ++i)
        if (covered[i]) sorted.push_back(values[i]);
    if (sorted.empty()) return 1.0;
    const auto place =
        sorted.begin() + static_cast<ptrdiff_t>(kShownShare * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), place, sorted.end());
    double wanted = *place;
    // Values above 0 in fewer texels than that still make a scale.
    if (wanted <= 0.0) wanted = *std::max_element(sorted.begin(), sorted.end());
    if (!(wanted > 0.0)) return 1.0;
    const double power = std::pow(10.0, std::floor(std::log10(wanted)));
    for (double step : {1.0, 2.0, 5.0})
        if (wanted <= step * power * (1.0 + 1e-6)) return step * power;
    return 10.0 * power;
}

FloatImage heatMap(uint32_t width, const std::vector<float>& values, const std::vector<bool>& covered,
                   double scale) {
    FloatImage image{width, static_cast<uint32_t>(values.size() / width), {}, {}, {}};
    for (const char* channel : {"R", "G", "B"})
        image.add(channel).assign(values.size(), kGrey);
    for (size_t i = 0; i < values.size(); ++i) {
        if (!covered[i]) continue;
        const glm::vec3 colour = heatColour(values[i] / scale);
        for (int c = 0; c < 3; ++c)
            image.planes[c][i] = static_cast<float>(linearFromSrgb(colour[c]));
    }
    return image;
}

} // namespace relume
