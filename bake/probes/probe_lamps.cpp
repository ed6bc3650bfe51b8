#include "bake/probes/probe_lamps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace relume {

// Light is sampled as by shader::lampSample, but without the cosine of a receiver.
ProbeLampRay sampleProbeLamp(const shader::Lamp& lamp, const glm::vec3& point, uint32_t probe,
                             uint32_t sample, float reach) {
    const glm::vec2 u =
        shader::sobolPoint(shader::replicateIndex(sample), shader::lampSeed(lamp, probe, sample));
    ProbeLampRay ray;
    if (lamp.type == shader::kLampRectangle || lamp.type == shader::kLampDisc) {
        float area = glm::length(glm::cross(lamp.edgeU, lamp.edgeV));
        ray.target = shader::rectangleCorner(lamp, u.x, u.y);
        if (lamp.type == shader::kLampDisc) {
            const glm::vec3 c = shader::cosineDirection(u);
            ray.target = lamp.position + lamp.radius * (c.x * lamp.edgeU + c.y * lamp.edgeV);
            area = std::numbers::pi_v<float> * lamp.radius * lamp.radius;
        }
        const glm::vec3 d = ray.target - point;
        const float d2 = std::max(glm::dot(d, d), shader::kNearestLamp2);
        ray.direction = d / std::sqrt(d2);
        ray.lux = area * std::max(-glm::dot(lamp.axis, ray.direction), 0.0f) / d2;
        ray.target += shader::kLampGap * (point - ray.target);
        return ray;
    }
    if (lamp.type == shader::kLampSun) {
        // The direction is the sample's own: the target less the point would be that of rounded places.
        const float sine2 = lamp.radius * lamp.radius;
        ray.direction = shader::coneDirection(-lamp.axis, sine2, u);
        ray.target = point + reach * ray.direction;
        ray.lux = 2.0f / (1.0f + std::sqrt(1.0f - sine2)); // the cone's solid angle over its projected one
        return ray;
    }
    shader::Patch patch{};
    patch.position = point;
    patch.normal = patch.shading = glm::vec3(0, 1, 0);
    const glm::vec3 away = lamp.position - point;
    if (glm::dot(away, away) > 0.0f) patch.normal = patch.shading = glm::normalize(away);
    const shader::LampSample s = shader::lampSample(lamp, patch, point, u, reach);
    ray.target = s.target;
    const glm::vec3 d = s.target - point;
    const float length = glm::length(d);
    if (!(length > 0.0f)) return ray;
    ray.direction = d / length;
    const float cosine = glm::dot(patch.shading, ray.direction);
    if (cosine > 0.0f) ray.lux = std::numbers::pi_v<float> * s.factor / cosine;
    return ray;
}

} // namespace relume
