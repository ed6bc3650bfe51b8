#pragma once

#include <array>

#include <glm/glm.hpp>

namespace relume {

/// Coefficients of the nine real spherical harmonics of bands 0 to 2, in the order and with the signs of
/// [Ramamoorthi and Hanrahan 2001]: 1; y, z, x; xy, yz, 3z^2 - 1, xz, x^2 - y^2. Those of radiance are in
/// cd/m^2.
using Harmonics = std::array<glm::dvec3, 9>;

/// Returns the nine functions at unit `direction`; the integral of each one's square over the sphere is 1.
std::array<double, 9> harmonicsAt(const glm::dvec3& direction);

/// Adds light from unit `direction`: `light` is radiance times solid angle [cd/m^2 sr], which is irradiance
/// on a surface that faces it [lux].
void addLight(Harmonics& harmonics, const glm::dvec3& direction, const glm::dvec3& light);

/// Returns the irradiance [lux] on a surface with unit `normal` by the cosine's factors of the bands, pi, 2/3
/// pi and pi/4 [Ramamoorthi and Hanrahan 2001, equation 12]. Bands above 2 are missing, so it may be
/// negative beside a strong light.
glm::dvec3 irradiance(const Harmonics& radiance, const glm::dvec3& normal);

/// Returns what 1, y, z, x, xy, yz, 3z^2 - 1, xz and x^2 - y^2 of a unit normal (x, y, z) are multiplied with
/// to sum up to lighting = irradiance / pi [cd/m^2] on a surface that has it.
std::array<glm::vec3, 9> lightingPolynomial(const Harmonics& radiance);

} // namespace relume
