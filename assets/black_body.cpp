#include "assets/black_body.h"

#include "assets/error.h"

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

// One lobe of a colour matching function: a Gaussian with another width on either side of its centre.
double lobe(double nanometres, double centre, double below, double above) {
    const double t = (nanometres - centre) * (nanometres < centre ? below : above);
    return std::exp(-0.5 * t * t);
}

// The CIE 1931 colour matching functions for 2 degrees, fitted by a few lobes each [Wyman, Sloan and Shirley
// 2013, "Simple Analytic Approximations to the CIE XYZ Color Matching Functions", JCGT 2(2), eq. 4].
glm::dvec3 matchingFunctions(double nm) {
    return {1.056 * lobe(nm, 599.8, 0.0264, 0.0323) + 0.362 * lobe(nm, 442.0, 0.0624, 0.0374) -
                0.065 * lobe(nm, 501.1, 0.0490, 0.0382),
            0.821 * lobe(nm, 568.8, 0.0213, 0.0247) + 0.286 * lobe(nm, 530.9, 0.0613, 0.0322),
            1.217 * lobe(nm, 437.0, 0.0845, 0.0278) + 0.681 * lobe(nm, 459.0, 0.0385, 0.0725)};
}

// Planck's law for radiance per wavelength, up to a factor; its second radiation constant [nm K] as CODATA
// 2018 has it.
double planck(double nm, double kelvin) {
    constexpr double kSecondRadiation = 1.438776877e7;
    return std::pow(nm, -5.0) / std::expm1(kSecondRadiation / (nm * kelvin));
}

} // namespace

glm::vec3 blackBodyColor(float kelvin) {
    ASSERT(kelvin >= kColdestBlackBody && kelvin <= kHottestBlackBody);
    glm::dvec3 xyz(0.0);
    for (double nm = 360.0; nm <= 830.0; nm += 5.0) // the CIE's range, in steps of which one lobe has many
        xyz += planck(nm, kelvin) * matchingFunctions(nm);
    // XYZ to linear sRGB [IEC 61966-2-1], by columns.
    constexpr glm::dmat3 kToRgb(3.2406, -0.9689, 0.0557, -1.5372, 1.8758, -0.2040, -0.4986, 0.0415, 1.0570);
    const glm::dvec3 rgb = glm::max(kToRgb * xyz, 0.0);
    return glm::vec3(rgb / std::max({rgb.r, rgb.g, rgb.b}));
}

} // namespace relume
