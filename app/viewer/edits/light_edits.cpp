#include "app/viewer/edits/light_edits.h"

#include "assets/model/light_names.h"
#include "assets/base/error.h"
#include "assets/model/scene_limits.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <utility>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

using Kind = LightKey::Kind;

// A room lit for reading has this lighting, 300 lux on white [cd/m^2].
constexpr float kUsualLighting = 100.0f;
// New lights stand at this share of the way from the eye to what it sees.
constexpr float kWay = 0.6f;
constexpr float kExtent = 0.2f;       // across an area light, of its distance from what it shines at
constexpr float kRadiusShare = 0.02f; // of a bulb, of the same distance
constexpr float kSunAngle = 0.00925f; // [rad], as seen from the earth
constexpr float kSunTilt = 0.8727f;   // [rad] below the horizon: a sun in the forenoon
// Between a light and its copy there is this share of what it is across, and from middle to middle at least
// so much [m].
constexpr float kBeside = 0.2f, kLeastBeside = 0.25f;

const Light& lamp(const SceneEdits& edits, const LightKey& key) {
    ASSERT(key.kind == Kind::Lamp && key.index < edits.lights.size());
    return edits.lights[key.index];
}

std::string freeName(const std::vector<Light>& lights, const std::string& wanted) {
    std::set<std::string> taken;
    for (const Light& light : lights)
        taken.insert(light.name);
    std::string name = wanted;
    for (uint32_t n = 2; taken.contains(name); ++n)
        name = wanted + " " + std::to_string(n);
    return name;
}

const char* newName(LightType type) {
    switch (type) {
    case LightType::Point:
        return "Point";
    case LightType::Spot:
        return "Spot";
    case LightType::Directional:
        return "Sun";
    case LightType::Rectangle:
        return "Rectangle";
    case LightType::Disc:
        return "Disc";
    }
    return "Light";
}

// Returns the irradiance that a new light should give: lighting is irradiance over pi.
float wantedIrradiance(const LightSpot& spot) {
    const float lighting = (spot.lighting.r + spot.lighting.g + spot.lighting.b) / 3.0f;
    return std::numbers::pi_v<float> *
           (lighting > 0.0f && std::isfinite(lighting) ? lighting : kUsualLighting);
}

} // namespace

glm::vec3 typedColour(const glm::vec3& colour) {
    return glm::clamp(colour, 0.0f, kBrightest);
}

float typedAngle(float degrees) {
    constexpr float kTurn = 360.0f;
    if (!std::isfinite(degrees)) return 0.0f;
    return std::abs(degrees) > kTurn ? std::fmod(degrees, kTurn) : degrees;
}

glm::vec3 typedAngles(const glm::vec3& degrees) {
    return {typedAngle(degrees.x), typedAngle(degrees.y), typedAngle(degrees.z)};
}

EmissionParts splitEmission(const glm::vec3& emission) {
    EmissionParts parts;
    parts.strength = std::max({emission.r, emission.g, emission.b, 0.0f});
    if (parts.strength > 0) parts.colour = emission / parts.strength;
    return parts;
}

LightPower powerOf(const SceneEdits& edits, const LightKey& key) {
    if (key.kind == Kind::Group) return {glm::vec3(1.0f), 1.0f}; // weighed in its layer
    if (key.kind == Kind::Lamp) return {lamp(edits, key).color, lamp(edits, key).intensity};
    const EmissionParts parts =
        splitEmission(key.kind == Kind::Sky ? edits.sky.radiance : edits.materials[key.material].emission);
    return {parts.colour, parts.strength};
}

void setPower(SceneEdits& edits, const LightKey& key, const LightPower& power) {
    if (key.kind == Kind::Lamp) {
        edits.lights[key.index].color = glm::max(power.color, 0.0f);
        edits.lights[key.index].intensity = std::max(power.intensity, 0.0f);
        return;
    }
    const glm::vec3 radiance = glm::max(power.color, 0.0f) * std::max(power.intensity, 0.0f);
    (key.kind == Kind::Sky ? edits.sky.radiance : edits.materials[key.material].emission) = radiance;
}

const char* lightTypeOf(const SceneEdits& edits, const LightKey& key) {
    if (key.kind == Kind::Lamp) return lightTypeName(lamp(edits, key).type);
    return key.kind == Kind::Sky ? "sky" : "emitter";
}

const char* lightUnitOf(const SceneEdits& edits, const LightKey& key) {
    if (key.kind == Kind::Lamp) return lightUnit(lamp(edits, key).type);
    return key.kind == Kind::Sky && !edits.sky.file.empty() ? "times" : "cd/m^2";
}

Light makeLight(LightType type, const LightSpot& spot) {
    const glm::vec3 eye(spot.camera[3]);
    const float distance = std::max((1.0f - kWay) * glm::distance(eye, spot.seen), 1e-6f);
    const float irradiance = wantedIrradiance(spot);
    Light light;
    light.name = newName(type);
    light.type = type;
    light.transform = spot.camera;
    light.transform[3] = glm::vec4(glm::mix(eye, spot.seen, kWay), 1.0f);
    light.intensity = irradiance * distance * distance;
    light.size = glm::vec2(kExtent * distance);
    switch (type) {
    case LightType::Point:
    case LightType::Spot:
        light.radius = kRadiusShare * distance;
        break;
    case LightType::Directional: {
        light.intensity = irradiance;
        light.angle = kSunAngle;
        const glm::vec3 angles = lightAngles(spot.camera);
        light.transform = withAngles(light.transform, {angles.x, -glm::degrees(kSunTilt), 0.0f});
        break;
    }
    case LightType::Rectangle:
        light.intensity /= light.size.x * light.size.y;
        break;
    case LightType::Disc:
        light.radius = 0.5f * kExtent * distance;
        light.intensity /= std::numbers::pi_v<float> * light.radius * light.radius;
        break;
    }
    return light;
}

SkySettings makeSky(SkySettings sky, const LightSpot& spot) {
    sky.radiance = glm::vec3(sky.file.empty() ? wantedIrradiance(spot) / std::numbers::pi_v<float> : 1.0f);
    return sky;
}

LightKey addLamp(Document& document, Light light) {
    std::vector<Light>& lights = document.edits.lights;
    light.name = freeName(lights, light.name);
    light.node = -1;
    lights.push_back(std::move(light));
    return {Kind::Lamp, static_cast<uint32_t>(lights.size() - 1), 0};
}

LightKey duplicateLamp(Document& document, uint32_t index) {
    Light light = document.edits.lights[index];
    const float across =
        std::max(light.type == LightType::Rectangle ? light.size.x : 0.0f, 2.0f * light.radius);
    const glm::vec3 right = glm::normalize(glm::vec3(light.transform[0]));
    light.preview = false;
    light.transform[3] += glm::vec4(std::max((1.0f + kBeside) * across, kLeastBeside) * right, 0.0f);
    return addLamp(document, std::move(light));
}

void eraseLamp(Document& document, uint32_t index) {
    std::vector<Light>& lights = document.edits.lights;
    ASSERT(index < lights.size());
    lights.erase(lights.begin() + static_cast<std::ptrdiff_t>(index));
    document.mix.lampErased(index);
}

bool hasPreview(const SceneEdits& edits) {
    return edits.sky.preview || std::any_of(edits.lights.begin(), edits.lights.end(),
                                            [](const Light& light) { return light.preview; });
}

bool isPreview(const SceneEdits& edits, const LightKey& key) {
    if (key.kind == LightKey::Kind::Sky) return edits.sky.preview;
    return key.kind == LightKey::Kind::Lamp && key.index < edits.lights.size() &&
           edits.lights[key.index].preview;
}

void keepPreview(SceneEdits& edits) {
    edits.sky.preview = false;
    for (Light& light : edits.lights) {
        if (!light.preview) continue;
        light.preview = false;
        constexpr std::string_view kMark = "Preview "; // of addPreviewLight()
        if (light.name.starts_with(kMark) && light.name.size() > kMark.size()) {
            light.name.erase(0, kMark.size());
            light.name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(light.name[0])));
        }
    }
}

void toggle(std::vector<LightKey>& keys, const LightKey& key) {
    if (std::erase(keys, key) == 0) keys.push_back(key);
}

glm::vec3 lightAngles(const glm::mat4& transform) {
    const glm::vec3 x = glm::normalize(glm::vec3(transform[0])), y = glm::normalize(glm::vec3(transform[1])),
                    z = glm::normalize(glm::vec3(transform[2]));
    // The rotation is turn(Y) tilt(X) roll(Z), with the third column (sin turn cos tilt, -sin tilt, cos turn
    // cos tilt).
    const float tilt = std::asin(std::clamp(-z.y, -1.0f, 1.0f));
    constexpr float kUpright = 1e-4f; // cosine of the tilt below which turn and roll are one
    if (std::hypot(z.x, z.z) < kUpright) return glm::degrees(glm::vec3(std::atan2(-x.z, x.x), tilt, 0.0f));
    return glm::degrees(glm::vec3(std::atan2(z.x, z.z), tilt, std::atan2(x.y, y.y)));
}

glm::mat4 withAngles(const glm::mat4& transform, const glm::vec3& degrees) {
    const glm::vec3 angles = glm::radians(degrees);
    glm::mat4 turned = glm::rotate(glm::mat4(1.0f), angles.x, {0.0f, 1.0f, 0.0f});
    turned = glm::rotate(turned, angles.y, {1.0f, 0.0f, 0.0f});
    turned = glm::rotate(turned, angles.z, {0.0f, 0.0f, 1.0f});
    turned[3] = transform[3];
    return turned;
}

glm::mat4 aimedAlong(const glm::mat4& transform, const glm::vec3& direction) {
    const glm::vec3 z = -glm::normalize(direction);
    const float tilt = std::asin(std::clamp(-z.y, -1.0f, 1.0f));
    const bool upright = std::hypot(z.x, z.z) < 1e-4f;
    const float turn = upright ? glm::radians(lightAngles(transform).x) : std::atan2(z.x, z.z);
    return withAngles(transform, glm::degrees(glm::vec3(turn, tilt, 0.0f)));
}

glm::mat4 placedOn(const Light& light, const glm::vec3& position, const glm::vec3& normal, float gap) {
    const bool round = light.type == LightType::Point || light.type == LightType::Spot;
    glm::mat4 placed = light.type == LightType::Point || light.type == LightType::Directional
                           ? light.transform
                           : aimedAlong(light.transform, normal);
    placed[3] = glm::vec4(position + (gap + (round ? light.radius : 0.0f)) * normal, 1.0f);
    return placed;
}

glm::vec3 normalAt(const WorldMesh& mesh, uint32_t instance, const glm::vec3& position,
                   const glm::vec3& towards) {
    glm::vec3 best = towards;
    float least = std::numeric_limits<float>::max();
    for (size_t i = 0; i < mesh.triangleCount(); ++i) {
        if (mesh.instance[i] != instance) continue;
        const glm::vec3 &a = mesh.positions[3 * i], &b = mesh.positions[3 * i + 1],
                        &c = mesh.positions[3 * i + 2];
        const glm::vec3 area = glm::cross(b - a, c - a), normal = glm::normalize(area);
        // The position is so far beside the triangle's edges, or off its plane.
        float off = std::abs(glm::dot(position - a, normal));
        for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
            off = std::max(off, glm::dot(position - from, glm::normalize(glm::cross(to - from, normal))));
        if (off >= least) continue;
        least = off;
        best = glm::dot(normal, towards) < 0.0f ? -normal : normal;
    }
    return best;
}

bool LightList::update(const LoadedScene* scene, const Session& session) {
    if (scene == nullptr) return false;
    if (scene->number == number_ && session.changes() == edits_) return false;
    if (scene->number != number_) {
        const Scene& file = scene->prepared.scene;
        scene_ = {};
        scene_.instances = file.instances;
        scene_.sky.file = file.sky.file;
        scene_.meshes.resize(file.meshes.size());
        for (size_t i = 0; i < file.meshes.size(); ++i)
            for (const Primitive& primitive : file.meshes[i].primitives)
                scene_.meshes[i].primitives.emplace_back().material = primitive.material;
    }
    number_ = scene->number;
    edits_ = session.changes();
    applyEdits(scene_, session.document().edits);
    sources_ = lightSources(scene_);
    return true;
}

const LightSource* LightList::find(const LightKey& key) const {
    const auto found = std::find_if(sources_.begin(), sources_.end(),
                                    [&](const LightSource& source) { return source.key == key; });
    return found == sources_.end() ? nullptr : &*found;
}

size_t LightList::emittersOf(uint32_t material) const {
    return static_cast<size_t>(
        std::count_if(sources_.begin(), sources_.end(), [&](const LightSource& source) {
            return source.key.kind == Kind::Emitter && source.key.material == material;
        }));
}

} // namespace relume
