#include "assets/gltf/gltf_light_json.h"

#include "assets/base/error.h"

#include <algorithm>

namespace relume::gltf {

namespace {

using Json = nlohmann::ordered_json;

/// Returns what all lights have.
Json lightJson(const Light& light, const char* type) {
    Json out;
    if (!light.name.empty()) out["name"] = light.name;
    out["type"] = type;
    out["color"] = jsonArray(light.color);
    out["intensity"] = light.intensity;
    return out;
}

} // namespace

bool isAreaLight(LightType type) {
    return type == LightType::Rectangle || type == LightType::Disc;
}

Json punctualLightJson(const Light& light) {
    ASSERT(!isAreaLight(light.type));
    if (light.type == LightType::Directional) {
        Json out = lightJson(light, "directional");
        if (light.angle > 0.0f) out["extras"]["relume"]["angle"] = light.angle;
        return out;
    }
    Json out = lightJson(light, light.type == LightType::Spot ? "spot" : "point");
    if (light.type == LightType::Spot) {
        out["spot"]["innerConeAngle"] = light.innerConeAngle;
        out["spot"]["outerConeAngle"] = light.outerConeAngle;
    }
    if (light.range > 0.0f) out["range"] = light.range;
    if (light.radius > 0.0f) out["extras"]["relume"]["radius"] = light.radius;
    return out;
}

Json areaLightJson(const Light& light) {
    ASSERT(isAreaLight(light.type));
    const bool isDisc = light.type == LightType::Disc;
    Json out = lightJson(light, isDisc ? "disc" : "rectangle");
    if (isDisc)
        out["radius"] = light.radius;
    else
        out["size"] = jsonArray(light.size);
    return out;
}

Json areaExtensionJson(const Light& light) {
    ASSERT(isAreaLight(light.type));
    const bool isDisc = light.type == LightType::Disc;
    Json out = lightJson(light, isDisc ? "disk" : "rect");
    out["size"] = isDisc ? 2.0f * light.radius : light.size.y; // a disc's is its diameter
    if (!isDisc) out["rect"]["aspect"] = light.size.x / light.size.y;
    return out;
}

Json skyJson(const Sky& sky, const std::string& file) {
    // This is in double precision, in which colour times intensity rounds to the radiance again, to the last
    // bit.
    const glm::dvec3 radiance(sky.radiance);
    const double intensity = std::max({radiance.r, radiance.g, radiance.b});
    Json out;
    out["color"] = jsonArray(intensity > 0.0 ? radiance / intensity : glm::dvec3(1.0));
    out["intensity"] = intensity;
    if (!file.empty()) out["file"] = file;
    if (sky.rotation != 0.0f) out["rotation"] = sky.rotation;
    return out;
}

} // namespace relume::gltf
