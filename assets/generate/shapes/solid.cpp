#include "assets/generate/shapes/solid.h"

#include <cmath>

#include <glm/gtc/constants.hpp>

namespace relume::generate {

Solid& Solid::add(Solid other) {
    for (Chart& chart : other.charts)
        charts.push_back(std::move(chart));
    return *this;
}

Solid& Solid::move(const glm::dvec3& offset) {
    for (Chart& chart : charts)
        for (ChartVertex& vertex : chart.vertices)
            vertex.position += offset;
    return *this;
}

Solid& Solid::turn(const glm::dmat3& rotation) {
    for (Chart& chart : charts)
        for (ChartVertex& vertex : chart.vertices)
            vertex.position = rotation * vertex.position;
    return *this;
}

Solid& Solid::turnY(double degrees) {
    const double angle = glm::radians(degrees);
    const double c = std::cos(angle), s = std::sin(angle);
    return turn(glm::dmat3({c, 0, -s}, {0, 1, 0}, {s, 0, c}));
}

Solid& Solid::paint(int material) {
    for (Chart& chart : charts)
        chart.material = material;
    return *this;
}

Solid& Solid::denser(double factor) {
    for (Chart& chart : charts)
        chart.density *= factor;
    return *this;
}

double roundSteadily(double x) {
    // This is not quite one half: a value computed as an exact half must not fall to either side by its last
    // bit.
    return std::floor(x + 0.4971);
}

glm::dvec3 snap(const glm::dvec3& position) {
    constexpr double kSteps = 16384.0; // [1/m], see the header
    return {roundSteadily(position.x * kSteps) / kSteps, roundSteadily(position.y * kSteps) / kSteps,
            roundSteadily(position.z * kSteps) / kSteps};
}

} // namespace relume::generate
