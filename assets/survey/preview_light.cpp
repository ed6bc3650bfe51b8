#include "assets/survey/preview_light.h"

#include "assets/survey/level_rooms.h"

#include <algorithm>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

// A sun at some 45 degrees in a clear sky: about 65,000 lux across its rays, and 13,000 lux of the sky on the
// ground [CIE 110-1994, clear sky].
constexpr float kSunLux = 65000.0f;
constexpr float kSkyLuminance = 4000.0f; // [cd/m^2]
const glm::vec3 kSunColour(1.0f, 0.93f, 0.82f), kSkyColour(0.72f, 0.86f, 1.0f);
const glm::vec3 kSunWay(-0.55f, -0.75f, -0.37f); // of its rays; askew to walls, which stand along the axes
constexpr float kSunAngle = 0.03f;               // [rad], three times the sun's: its shadows show as soft

// A lamp that gives 300 lux [EN 12464-1, rooms] where the nearest surface is.
constexpr float kLampLux = 300.0f;
constexpr float kLampRadius = 0.1f; // of the clearance
const glm::vec3 kLampColour(1.0f, 0.9f, 0.78f);

Light sun() {
    Light light;
    light.name = "Preview sun";
    light.type = LightType::Directional;
    // Its place means nothing.
    light.transform = glm::inverse(glm::lookAt(glm::vec3(0.0f), kSunWay, glm::vec3(0.0f, 1.0f, 0.0f)));
    light.color = kSunColour;
    light.intensity = kSunLux;
    light.angle = kSunAngle;
    light.preview = true;
    return light;
}

Light lamp(const glm::vec3& place, float clearance) {
    Light light;
    light.name = "Preview lamp";
    light.type = LightType::Point;
    light.transform = glm::translate(glm::mat4(1.0f), place);
    light.color = kLampColour;
    light.intensity = kLampLux * clearance * clearance;
    light.radius = kLampRadius * clearance;
    light.preview = true;
    return light;
}

} // namespace

bool isDark(const Scene& scene) {
    if (!scene.lights.empty() || scene.sky.shines()) return false;
    const auto emits = [&](const Primitive& primitive) {
        return primitive.material >= 0 &&
               scene.materials[static_cast<size_t>(primitive.material)].emission != glm::vec3(0.0f);
    };
    return std::none_of(scene.instances.begin(), scene.instances.end(), [&](const Instance& instance) {
        const Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
        return !instance.hidden && std::any_of(mesh.primitives.begin(), mesh.primitives.end(), emits);
    });
}

PreviewLight previewLight(const WorldMesh& mesh) {
    PreviewLight light;
    if (!mesh.positions.empty()) {
        glm::vec3 low = mesh.positions.front(), high = low;
        for (const glm::vec3& point : mesh.positions) {
            low = glm::min(low, point);
            high = glm::max(high, point);
        }
        const LevelRays rays(mesh);
        const LevelRooms rooms = findRooms(rays, low, high);
        if (rooms.closed) {
            const glm::vec3 place = clearestPoint(rays, rooms.places);
            light.lights.push_back(lamp(place, rays.clearance(place)));
            light.closed = true;
            return light;
        }
    }
    light.lights.push_back(sun());
    light.sky.radiance = kSkyLuminance * kSkyColour;
    light.sky.preview = true;
    return light;
}

std::string addPreviewLight(Scene& scene, const WorldMesh& mesh) {
    if (!isDark(scene)) return "";
    PreviewLight light = previewLight(mesh);
    scene.lights = std::move(light.lights);
    if (light.closed) return "a preview lamp";
    static_cast<SkySettings&>(scene.sky) = light.sky;
    return "a preview sun and sky";
}

} // namespace relume
