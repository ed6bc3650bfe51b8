#include "app/edit/scene_pose.h"

#include "assets/base/error.h"
#include "assets/model/scene_limits.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <cmath>

namespace relume {
namespace {

// Two directions are one below this sine of the angle between them.
constexpr double kParallel = 1e-6;

/// Returns the rotation in a transform's axes: X keeps its direction, Y its half plane. It is the identity
/// where the axes tell none.
glm::dmat3 rotationIn(const glm::dmat3& axes) {
    const double lengthX = glm::length(axes[0]);
    if (!(lengthX > 0.0)) return glm::dmat3(1.0);
    const glm::dvec3 x = axes[0] / lengthX;
    const glm::dvec3 y = axes[1] - x * glm::dot(axes[1], x);
    if (!(glm::length(y) > kParallel * glm::length(axes[1]))) return glm::dmat3(1.0);
    const glm::dvec3 up = glm::normalize(y);
    return {x, up, glm::cross(x, up)};
}

// Returns sine and cosine, which are exact for quarter turns, so that 90 degrees leave no rounding errors in
// the other axes.
std::array<double, 2> sineAndCosine(double degrees) {
    const double turn = std::remainder(degrees, 360.0);
    if (turn == 0.0) return {0.0, 1.0};
    if (std::abs(turn) == 180.0) return {0.0, -1.0};
    if (std::abs(turn) == 90.0) return {turn / 90.0, 0.0};
    return {std::sin(glm::radians(turn)), std::cos(glm::radians(turn))};
}

glm::dmat3 rotation(const glm::vec3& degrees) {
    const auto [sx, cx] = sineAndCosine(degrees.x);
    const auto [sy, cy] = sineAndCosine(degrees.y);
    const auto [sz, cz] = sineAndCosine(degrees.z);
    const glm::dmat3 x(1, 0, 0, 0, cx, sx, 0, -sx, cx), y(cy, 0, -sy, 0, 1, 0, sy, 0, cy),
        z(cz, sz, 0, -sz, cz, 0, 0, 0, 1);
    return z * y * x;
}

} // namespace

void requirePoint(const glm::vec3& point) {
    for (int i = 0; i < 3; ++i)
        if (!std::isfinite(point[i]))
            throw UsageError(fmt::format("{:.6g},{:.6g},{:.6g} are no finite numbers: give x,y,z", point.x,
                                         point.y, point.z));
}

void requirePlace(const glm::vec3& place) {
    requirePoint(place);
    if (!isWithinReach(place))
        throw UsageError(fmt::format("{:.6g},{:.6g},{:.6g} is too far away: give metres from -{:g} to {:g}",
                                     place.x, place.y, place.z, kFarthest, kFarthest));
}

glm::mat4 turned(const glm::mat4& transform, const glm::vec3& degrees) {
    const glm::dmat3 axes{glm::mat3(transform)};
    const glm::dmat3 unturned = glm::transpose(rotationIn(axes)) * axes;
    glm::mat4 result(glm::mat3(rotation(degrees) * unturned));
    result[3] = transform[3];
    return result;
}

glm::mat4 aimed(const Light& light, const glm::vec3& target) {
    if (light.type == LightType::Point)
        throw Error(
            "a point light shines alike in all directions: aim a spot, a directional or an area light");
    const glm::dvec3 way = glm::dvec3(light.transform[3]) - glm::dvec3(target);
    if (!(glm::length(way) > 0.0))
        throw Error("the light is at the point it is aimed at: name another point");
    const glm::dvec3 z = glm::normalize(way);
    glm::dvec3 x = glm::cross(glm::dvec3(0, 1, 0), z);
    // Straight up or down, any turn is as good: X stays X.
    x = glm::length(x) > kParallel ? glm::normalize(x) : glm::dvec3(1, 0, 0);
    glm::mat4 result(glm::mat3(glm::dmat3(x, glm::cross(z, x), z)));
    result[3] = light.transform[3];
    return result;
}

} // namespace relume
