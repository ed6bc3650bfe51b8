#include "bake/probes/spherical_harmonics.h"

#include <numbers>

namespace relume {

namespace {

constexpr double kBand0 = 0.28209479177387814;   // sqrt(1 / (4 pi))
constexpr double kBand1 = 0.48860251190291992;   // sqrt(3 / (4 pi))
constexpr double kBand2 = 1.0925484305920792;    // sqrt(15 / (4 pi))
constexpr double kBand2z = 0.31539156525252005;  // sqrt(5 / (16 pi))
constexpr double kBand2xy = 0.54627421529603959; // sqrt(15 / (16 pi))
// The cosine's factors of the three bands [Ramamoorthi and Hanrahan 2001, equation 8].
constexpr std::array<double, 9> kCosine = {std::numbers::pi,
                                           2.0 / 3.0 * std::numbers::pi,
                                           2.0 / 3.0 * std::numbers::pi,
                                           2.0 / 3.0 * std::numbers::pi,
                                           std::numbers::pi / 4.0,
                                           std::numbers::pi / 4.0,
                                           std::numbers::pi / 4.0,
                                           std::numbers::pi / 4.0,
                                           std::numbers::pi / 4.0};

} // namespace

std::array<double, 9> harmonicsAt(const glm::dvec3& d) {
    return {kBand0,
            kBand1 * d.y,
            kBand1 * d.z,
            kBand1 * d.x,
            kBand2 * d.x * d.y,
            kBand2 * d.y * d.z,
            kBand2z * (3.0 * d.z * d.z - 1.0),
            kBand2 * d.x * d.z,
            kBand2xy * (d.x * d.x - d.y * d.y)};
}

void addLight(Harmonics& harmonics, const glm::dvec3& direction, const glm::dvec3& light) {
    const std::array<double, 9> values = harmonicsAt(direction);
    for (size_t i = 0; i < values.size(); ++i)
        harmonics[i] += values[i] * light;
}

glm::dvec3 irradiance(const Harmonics& radiance, const glm::dvec3& normal) {
    const std::array<double, 9> values = harmonicsAt(normal);
    glm::dvec3 sum(0.0);
    for (size_t i = 0; i < values.size(); ++i)
        sum += kCosine[i] * values[i] * radiance[i];
    return sum;
}

std::array<glm::vec3, 9> lightingPolynomial(const Harmonics& radiance) {
    constexpr std::array<double, 9> kFactors = {kBand0, kBand1,  kBand1, kBand1,  kBand2,
                                                kBand2, kBand2z, kBand2, kBand2xy};
    std::array<glm::vec3, 9> result;
    for (size_t i = 0; i < result.size(); ++i)
        result[i] = glm::vec3(kCosine[i] * kFactors[i] / std::numbers::pi * radiance[i]);
    return result;
}

} // namespace relume
