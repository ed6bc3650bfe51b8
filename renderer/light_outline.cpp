#include "renderer/light_outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace relume {
namespace {

constexpr int kParts = 24; // of a circle
// These are shares of a sign's size: the radius of its dot, where rays begin and end, and how far the arrow
// of what shines in one direction reaches.
constexpr float kDot = 0.3f, kRayFrom = 0.45f, kRayTo = 0.8f, kArrow = 2.2f, kArrowHead = 0.3f;
constexpr int kRays = 8;

class Outline {
public:
    std::vector<OutlineSegment> segments;

    void line(const glm::vec3& from, const glm::vec3& to) { segments.push_back({from, to}); }

    void circle(const glm::vec3& centre, const glm::vec3& a, const glm::vec3& b) {
        for (int i = 0; i < kParts; ++i)
            line(centre + around(a, b, i, kParts), centre + around(a, b, i + 1, kParts));
    }

    void rays(const glm::vec3& centre, const glm::vec3& a, const glm::vec3& b) {
        for (int i = 0; i < kRays; ++i) {
            const glm::vec3 way = around(a, b, i, kRays);
            line(centre + kRayFrom * way, centre + kRayTo * way);
        }
    }

    void arrow(const glm::vec3& from, const glm::vec3& way, const glm::vec3& side) {
        const glm::vec3 to = from + way, back = to - kArrowHead / kArrow * way;
        const glm::vec3 wing = 0.5f * kArrowHead / kArrow * glm::length(way) * side;
        line(from, to);
        line(to, back + wing);
        line(to, back - wing);
    }

    static glm::vec3 around(const glm::vec3& a, const glm::vec3& b, int part, int parts) {
        const float angle =
            2.0f * std::numbers::pi_v<float> * static_cast<float>(part) / static_cast<float>(parts);
        return std::cos(angle) * a + std::sin(angle) * b;
    }
};

void addCone(Outline& outline, const Light& light, const OutlineDesc& desc) {
    const glm::vec3 place(light.transform[3]);
    const glm::vec3 x = glm::normalize(glm::vec3(light.transform[0])),
                    y = glm::normalize(glm::vec3(light.transform[1])),
                    z = glm::normalize(glm::vec3(light.transform[2]));
    const float length = kArrow * desc.size;
    for (const float cone : {light.innerConeAngle, light.outerConeAngle}) {
        if (!(cone > 0.0f)) continue;
        const float radius = length * std::sin(cone);
        const glm::vec3 base = place - length * std::cos(cone) * z;
        outline.circle(base, radius * x, radius * y);
        if (cone != light.outerConeAngle) continue;
        for (int i = 0; i < 4; ++i)
            outline.line(place, base + Outline::around(radius * x, radius * y, i, 4));
    }
}

} // namespace

std::vector<OutlineSegment> lightOutline(const Light& light, const OutlineDesc& desc) {
    Outline outline;
    const glm::vec3 place(light.transform[3]);
    const glm::vec3 x = glm::normalize(glm::vec3(light.transform[0])),
                    y = glm::normalize(glm::vec3(light.transform[1])),
                    z = glm::normalize(glm::vec3(light.transform[2]));
    const glm::vec3 right = desc.size * desc.right, up = desc.size * desc.up;
    const glm::vec3 arrow = -kArrow * desc.size * z;
    outline.circle(place, kDot * right, kDot * up);
    switch (light.type) {
    case LightType::Point:
        outline.rays(place, right, up);
        break;
    case LightType::Spot:
        addCone(outline, light, desc);
        break;
    case LightType::Directional:
        outline.rays(place, right, up);
        outline.arrow(place, 2.0f * arrow, x);
        break;
    case LightType::Rectangle: {
        const glm::vec3 a = 0.5f * light.size.x * x, b = 0.5f * light.size.y * y;
        outline.line(place - a - b, place + a - b);
        outline.line(place + a - b, place + a + b);
        outline.line(place + a + b, place - a + b);
        outline.line(place - a + b, place - a - b);
        outline.arrow(place, arrow, x);
        break;
    }
    case LightType::Disc:
        outline.circle(place, light.radius * x, light.radius * y);
        outline.arrow(place, arrow, x);
        break;
    }
    const bool round = light.type == LightType::Point || light.type == LightType::Spot;
    if (round && light.radius > kDot * desc.size)
        outline.circle(place, light.radius * desc.right, light.radius * desc.up);
    return std::move(outline.segments);
}

} // namespace relume
