#include "bake/lights/lamps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace relume {
namespace {

// The softest edge of a spot is no sharper than KHR_lights_punctual has it [difference of cosines].
constexpr float kLeastEdge = 0.001f;

bool hasExtent(const shader::Lamp& lamp) {
    const bool area = lamp.type == shader::kLampRectangle || lamp.type == shader::kLampSky;
    return area || lamp.radius > 0.0f;
}

shader::Lamp makeLamp(const Light& light) {
    const glm::vec3 x(light.transform[0]), y(light.transform[1]), z(light.transform[2]);
    shader::Lamp lamp{};
    lamp.position = glm::vec3(light.transform[3]);
    lamp.axis = -glm::normalize(z);
    lamp.color = light.color * light.intensity;
    lamp.radius = light.radius;
    lamp.range = light.range;
    switch (light.type) {
    case LightType::Point:
        lamp.type = shader::kLampPoint;
        break;
    case LightType::Spot: {
        const float outer = std::cos(light.outerConeAngle), inner = std::cos(light.innerConeAngle);
        lamp.type = shader::kLampSpot;
        lamp.coneScale = 1.0f / std::max(kLeastEdge, inner - outer);
        lamp.coneOffset = -outer * lamp.coneScale;
        break;
    }
    case LightType::Directional:
        lamp.type = shader::kLampSun;
        lamp.radius = std::sin(0.5f * light.angle);
        break;
    // The edges are the right way round for edgeU x edgeV to lie along -Z.
    case LightType::Rectangle:
        lamp.type = shader::kLampRectangle;
        lamp.edgeU = light.size.y * glm::normalize(y);
        lamp.edgeV = light.size.x * glm::normalize(x);
        break;
    case LightType::Disc:
        lamp.type = shader::kLampDisc;
        lamp.edgeU = glm::normalize(y);
        lamp.edgeV = glm::normalize(x);
        break;
    }
    return lamp;
}

// Adds the tables to draw pixels by brightness: for each pixel the running share of its row, times solid
// angles for the rows. Returns whether the picture shines at all.
bool addPicture(LampSet& set, const Sky& sky) {
    set.skyPixels.reserve(sky.pixels.size());
    std::vector<double> rows;
    double all = 0;
    for (uint32_t row = 0; row < sky.height; ++row) {
        const auto* pixels = sky.pixels.data() + size_t{row} * sky.width;
        double sum = 0;
        for (uint32_t column = 0; column < sky.width; ++column)
            sum += double{pixels[column].r} + pixels[column].g + pixels[column].b;
        double running = 0;
        for (uint32_t column = 0; column < sky.width; ++column) {
            running += double{pixels[column].r} + pixels[column].g + pixels[column].b;
            const double share =
                sum > 0 && column + 1 < sky.width ? running / sum : column + 1.0 == sky.width;
            set.skyPixels.emplace_back(pixels[column], static_cast<float>(share));
        }
        all += sum * std::sin(std::numbers::pi * (row + 0.5) / sky.height);
        rows.push_back(all);
    }
    for (const double share : rows)
        set.skyRows.push_back(all > 0 ? static_cast<float>(share / all) : 0.0f);
    set.skySize = {sky.width, sky.height};
    set.skyRotation = sky.rotation;
    return all > 0;
}

} // namespace

float reachOf(const WorldMesh& mesh) {
    glm::vec3 lo = mesh.positions.front(), hi = lo;
    for (const glm::vec3& p : mesh.positions) {
        lo = glm::min(lo, p);
        hi = glm::max(hi, p);
    }
    return 2.0f * glm::length(hi - lo);
}

std::vector<shader::Lamp> lampsOf(const Scene& scene, bool skyShines, const LampDesc& desc) {
    std::vector<shader::Lamp> lamps;
    for (const Light& light : scene.lights) {
        shader::Lamp lamp = makeLamp(light);
        if (desc.unit) lamp.color = glm::vec3(1.0f);
        if (lamp.color != glm::vec3(0.0f)) lamps.push_back(lamp);
    }
    if (skyShines) {
        shader::Lamp lamp{};
        lamp.type = shader::kLampSky;
        lamp.color = desc.unit ? glm::vec3(1.0f) : scene.sky.radiance;
        lamps.push_back(lamp);
    }
    for (shader::Lamp& lamp : lamps) {
        lamp.samples = hasExtent(lamp) ? desc.samples : desc.pointSamples;
        // Kinds have numbers of their own. Lights of a kind share them: one's light must not depend on what
        // other lights there are.
        lamp.seed = lamp.type + 1;
    }
    return lamps;
}

LampSet buildLamps(const Scene& scene, const WorldMesh& mesh, const LampDesc& desc) {
    LampSet set;
    set.reach = reachOf(mesh);
    const bool picture = !scene.sky.pixels.empty();
    const bool skyShines = desc.sky && scene.sky.shines() && (!picture || addPicture(set, scene.sky));
    set.lamps = lampsOf(scene, skyShines, desc);
    return set;
}

} // namespace relume
