#include "assets/base/error.h"
#include "assets/gltf/gltf_build.h"
#include "assets/gltf/file/gltf_file.h"
#include "assets/gltf/file/gltf_value.h"
#include "assets/images/sky_picture.h"
#include "assets/model/scene_limits.h"

#include <glm/gtc/constants.hpp>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>

namespace relume::gltf {

namespace {

using nlohmann::json;

constexpr float kNarrowestCone = 1e-3f; // [rad]; one of 0 lights nothing, this one a metre at 1 km
// Exporters write transforms to 6 or 7 digits.
constexpr double kTransformTolerance = 1e-3; // of a unit axis [1], for what is told to the user
constexpr double kSameTransform = 1e-6;      // of a unit axis [1], for what is kept as it is
constexpr double kParallel = 1e-5;           // sine of the angle between axes that tell no plane

/// Reads the numbers of one light or sky. What is wrong with them is corrected and warned about.
class Numbers {
public:
    Numbers(const json& object, std::string thing, Warnings& warnings)
        : object_(object), thing_(std::move(thing)), warnings_(warnings) {}

    void warn(const std::string& problem) const { warnings_.add(thing_, problem); }

    float number(const char* key, float fallback) const {
        const auto found = object_.find(key);
        if (found == object_.end()) return fallback;
        if (isFinite(*found)) return found->get<float>();
        warn(fmt::format("its {} is not a finite number, {} is used", key, fallback));
        return fallback;
    }

    float notNegative(const char* key, float fallback) const {
        const float value = number(key, fallback);
        if (value >= 0.0f) return value;
        warn(fmt::format("its {} is negative, 0 is used", key));
        return 0.0f;
    }

    glm::dvec3 color() const {
        const auto found = object_.find("color");
        if (found == object_.end()) return glm::dvec3(1.0);
        if (!found->is_array() || found->size() != 3 ||
            !std::all_of(found->begin(), found->end(), isFinite)) {
            warn("its color is not three finite numbers, white is used");
            return glm::dvec3(1.0);
        }
        const glm::dvec3 color((*found)[0].get<double>(), (*found)[1].get<double>(),
                               (*found)[2].get<double>());
        if (std::min({color.r, color.g, color.b}) < 0.0) warn("its color is negative, 0 is used");
        return glm::max(color, 0.0);
    }

    /// Returns the `count` lengths of an array, or one number where `count` is 1; nothing where one of them
    /// is no length.
    std::vector<float> lengths(const char* key, size_t count) const {
        const auto found = object_.find(key);
        if (found == object_.end()) return {};
        const json list = count == 1 ? json::array({*found}) : *found;
        if (!list.is_array() || list.size() != count || !std::all_of(list.begin(), list.end(), isFinite))
            return {};
        const std::vector<float> lengths = list.get<std::vector<float>>();
        return *std::min_element(lengths.begin(), lengths.end()) > 0.0f ? lengths : std::vector<float>();
    }

private:
    static bool isFinite(const json& value) {
        return value.is_number() && std::abs(value.get<double>()) <= std::numeric_limits<float>::max();
    }

    const json& object_;
    std::string thing_;
    Warnings& warnings_;
};

/// Holds one light's place in the file.
struct Source {
    const json& object;
    int node;
    std::string name; // the light's own, else the node's
    const glm::mat4& world;
    float usualIntensity = 1.0f; // where the file has none

    std::string label() const {
        return name.empty() ? fmt::format("light of node {}", node) : "light " + inQuotes(name);
    }
};

/// Returns the light's own name, or the node's where it has none.
std::string nameOfLight(const json& light, const std::string& node) {
    const std::string own = textOr(light, "name", "");
    return own.empty() ? node : own;
}

/// Brings `v` to unit length. Returns false where it has no direction.
bool normalize(glm::dvec3& v, double shortest = 0.0) {
    const double length = glm::length(v);
    if (!(length > shortest) || !std::isfinite(length)) return false;
    v /= length;
    return true;
}

/// Returns the axes without scale: Z and Y keep their directions, X becomes what makes them right-handed.
/// Returns nullopt where they tell no Z.
std::optional<glm::dmat3> rigidAxes(const glm::dmat3& world) {
    glm::dvec3 x = world[0], y = world[1], z = world[2];
    const bool hasX = normalize(x), hasY = normalize(y);
    if (!normalize(z)) {
        z = glm::cross(x, y);
        if (!hasX || !hasY || !normalize(z, kParallel)) return std::nullopt;
    }
    y -= z * glm::dot(y, z);
    if (!hasY || !normalize(y, kParallel)) {
        y = glm::cross(z, x);
        if (!hasX || !normalize(y, kParallel)) {
            y = glm::cross(z, std::abs(z.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0));
            normalize(y);
        }
    }
    return glm::dmat3(glm::cross(y, z), y, z);
}

void warnAboutAxes(const glm::dmat3& world, LightType type, const Numbers& numbers) {
    glm::dvec3 axes[3] = {world[0], world[1], world[2]};
    bool isScaled = false, isSheared = false;
    for (glm::dvec3& axis : axes) {
        isScaled |= !(std::abs(glm::length(axis) - 1.0) <= kTransformTolerance);
        normalize(axis);
    }
    for (int i = 0; i < 3; ++i)
        isSheared |= std::abs(glm::dot(axes[i], axes[(i + 1) % 3])) > kTransformTolerance;
    if (isSheared) numbers.warn("its node is sheared, its axes are made perpendicular");
    if (isScaled && (type == LightType::Rectangle || type == LightType::Disc))
        numbers.warn("its node is scaled, its size stays as it is written");
}

/// Returns the transform that a light gets from its node, or nullopt where this does not tell where to shine.
std::optional<glm::mat4> lightTransform(const glm::mat4& world, LightType type, const Numbers& numbers) {
    const glm::dmat3 given{glm::mat3(world)};
    std::optional<glm::dmat3> axes = rigidAxes(given);
    glm::mat4 transform(1.0f);
    transform[3] = world[3];
    if (type == LightType::Point && !axes) return transform;
    if (!axes) return std::nullopt;
    if (type != LightType::Point) warnAboutAxes(given, type, numbers);
    double change = 0.0;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            change = std::max(change, std::abs((*axes)[c][r] - given[c][r]));
    // A file that is read and written again and again must not drift by its last bits.
    if (change <= kSameTransform) return world;
    for (int c = 0; c < 3; ++c)
        transform[c] = glm::vec4(glm::vec3((*axes)[c]), 0.0f);
    return transform;
}

void addLight(Build& build, Light light, const Source& source, const Numbers& numbers) {
    const std::optional<glm::mat4> transform = lightTransform(source.world, light.type, numbers);
    if (!transform) {
        numbers.warn("its node is scaled to nothing, it has no direction and is ignored");
        return;
    }
    light.name = source.name;
    light.node = source.node;
    light.transform = *transform;
    light.color = glm::vec3(numbers.color());
    light.intensity = numbers.notNegative("intensity", source.usualIntensity);
    for (const std::string& problem : limitLight(light))
        numbers.warn(problem);
    if (light.type == LightType::Directional) {
        if (!isWithinReach(glm::vec3(light.transform[3])))
            light.transform[3] = glm::vec4(0.0f, 0.0f, 0.0f, 1.0f); // which means nothing to it
    } else if (!isWithinReach(glm::vec3(light.transform[3]))) {
        numbers.warn(fmt::format("stands more than {:g} m away and is ignored: move it", kFarthest));
        return;
    }
    build.scene.lights.push_back(std::move(light));
}

/// Returns a transform whose axes have the length 1, as far as they have a direction.
glm::mat4 withUnitAxes(const glm::mat4& transform) {
    glm::mat4 out = transform;
    for (int c = 0; c < 3; ++c) {
        glm::dvec3 axis(transform[c]);
        if (normalize(axis)) out[c] = glm::vec4(glm::vec3(axis), 0.0f);
    }
    return out;
}

void readCone(Light& light, const Source& source, Warnings& warnings) {
    static const json kNone = json::object();
    const auto spot = source.object.find("spot");
    const Numbers numbers(spot == source.object.end() ? kNone : *spot, source.label(), warnings);
    const float outer = numbers.number("outerConeAngle", light.outerConeAngle);
    const float inner = numbers.number("innerConeAngle", light.innerConeAngle);
    light.outerConeAngle = std::clamp(outer, kNarrowestCone, glm::half_pi<float>());
    light.innerConeAngle = std::clamp(inner, 0.0f, light.outerConeAngle);
    if (outer != light.outerConeAngle || inner != light.innerConeAngle)
        numbers.warn("has cone angles out of range, they are clamped");
}

void addPunctual(Build& build, const Source& source) {
    static const json kNone = json::object();
    const Numbers numbers(source.object, source.label(), build.warnings);
    const auto extras = source.object.find("extras");
    const bool extended = extras != source.object.end() && extras->is_object() && extras->contains("relume");
    const Numbers own(extended ? (*extras)["relume"] : kNone, source.label(), build.warnings);
    const std::string type = source.object.value("type", "");
    Light light;
    if (type == "directional") {
        light.type = LightType::Directional;
        light.angle = own.notNegative("angle", 0.0f);
        if (light.angle > glm::pi<float>()) {
            numbers.warn("its angle is wider than half the sky, pi is used");
            light.angle = glm::pi<float>();
        }
    } else if (type == "point" || type == "spot") {
        light.type = type == "spot" ? LightType::Spot : LightType::Point;
        light.range = numbers.notNegative("range", 0.0f);
        light.radius = own.notNegative("radius", 0.0f);
        if (light.type == LightType::Spot) readCone(light, source, build.warnings);
    } else {
        numbers.warn(fmt::format("has the unknown type {} and is ignored", inQuotes(type)));
        return;
    }
    addLight(build, light, source, numbers);
}

void addArea(Build& build, const Source& source) {
    const Numbers numbers(source.object, source.label(), build.warnings);
    const std::string type = source.object.value("type", "");
    Light light;
    if (type == "rectangle") {
        light.type = LightType::Rectangle;
        const std::vector<float> size = numbers.lengths("size", 2);
        if (size.empty()) {
            numbers.warn("its size is not two positive numbers, it is ignored");
            return;
        }
        light.size = {size[0], size[1]};
    } else if (type == "disc") {
        light.type = LightType::Disc;
        const std::vector<float> radius = numbers.lengths("radius", 1);
        if (radius.empty()) {
            numbers.warn("its radius is not a positive number, it is ignored");
            return;
        }
        light.radius = radius[0];
    } else {
        numbers.warn(fmt::format("has the unknown type {} and is ignored", inQuotes(type)));
        return;
    }
    addLight(build, light, source, numbers);
}

/// Returns the largest scale of a node's axes, by which EXT_lights_area scales its lights.
float largestScale(const glm::mat4& world) {
    return std::max({glm::length(glm::vec3(world[0])), glm::length(glm::vec3(world[1])),
                     glm::length(glm::vec3(world[2]))});
}

/// Adds a light of EXT_lights_area (a draft of the Khronos Group): `size` is a rectangle's height or a disc's
/// diameter, and the node's scale applies to it.
void addAreaExtension(Build& build, const Source& source) {
    static const json kNone = json::object();
    const Numbers numbers(source.object, source.label(), build.warnings);
    const std::string type = textOr(source.object, "type", "rect");
    const json* rect = memberOf(source.object, "rect");
    const Numbers shape(rect ? *rect : kNone, source.label(), build.warnings);
    const float scale = largestScale(source.world);
    const float size = scale * numbers.number("size", 1.0f), aspect = shape.number("aspect", 1.0f);
    Light light;
    if (type != "rect" && type != "disk") {
        numbers.warn(fmt::format("has the unknown type {} and is ignored", inQuotes(type)));
        return;
    }
    if (!(size > 0.0f) || !std::isfinite(size) || !(aspect > 0.0f) || !std::isfinite(size * aspect)) {
        numbers.warn("its size is not positive and finite, it is ignored");
        return;
    }
    light.type = type == "disk" ? LightType::Disc : LightType::Rectangle;
    light.size = {size * aspect, size};
    light.radius = light.type == LightType::Disc ? 0.5f * size : 0.0f;
    if (light.type == LightType::Disc) light.size = glm::vec2(1.0f); // which means nothing to it
    // The scale is in the size now; told without it, it is nothing to warn about.
    const glm::mat4 unscaled = withUnitAxes(source.world);
    addLight(build, light, {source.object, source.node, source.name, unscaled, source.usualIntensity},
             numbers);
}

} // namespace

void addLights(Build& build, size_t node, const glm::mat4& world) {
    const json& holder = build.nodes[node];
    const std::string nodeName = holder.value("name", "");
    const json::json_pointer use("/extensions/KHR_lights_punctual/light");
    if (holder.contains(use)) {
        const json& light = build.lights[holder[use].get<size_t>()];
        addPunctual(build, {light, static_cast<int>(node), nameOfLight(light, nodeName), world});
    }
    // Where a node has an area light by both, ours says more: the extension's size follows the node's scale.
    const json* extension = extensionOf(holder, kAreaLights);
    if (const json* light = ownExtra(holder, "areaLight")) {
        addArea(build, {*light, static_cast<int>(node), nameOfLight(*light, nodeName), world});
    } else if (extension) {
        const int entry = indexBelow(*extension, "light", build.areaLights.size());
        if (entry < 0) {
            build.warnings.add("node " + inQuotes(nodeName), "names no light of EXT_lights_area");
            return;
        }
        const json& named = build.areaLights[static_cast<size_t>(entry)];
        constexpr float kUsualIntensity = 1000.0f; // [cd/m^2], the extension's
        addAreaExtension(
            build, {named, static_cast<int>(node), nameOfLight(named, nodeName), world, kUsualIntensity});
    }
}

void buildSky(Build& build) {
    if (build.scenes.empty()) return;
    const json* source = ownExtra(build.scenes[static_cast<size_t>(build.sceneNumber)], "sky");
    if (!source) return;
    const Numbers numbers(*source, "sky", build.warnings);
    Sky& sky = build.scene.sky;
    const glm::dvec3 radiance = numbers.color() * double(numbers.notNegative("intensity", 1.0f));
    constexpr double kLargest = std::numeric_limits<float>::max(); // limitSky has a closer bound
    sky.radiance = glm::vec3(glm::min(radiance, kLargest));
    sky.rotation = numbers.number("rotation", 0.0f);
    const std::string file = source->value("file", "");
    if (file.empty()) {
        for (const std::string& problem : limitSky(sky))
            numbers.warn(problem);
        return;
    }
    sky.file = (std::filesystem::path(build.path).parent_path() / file).string();
    try {
        for (const std::string& warning : readSkyPicture(sky))
            build.warnings.add("sky " + inQuotes(file), warning);
        for (const std::string& problem : limitSky(sky))
            build.warnings.add("sky " + inQuotes(file), problem);
    } catch (const Error& error) {
        std::string reason = error.what(); // with the name as the file spells it
        std::replace_if(
            reason.begin(), reason.end(), [](unsigned char c) { return c < 0x20; }, ' ');
        throw Error(fmt::format("{}: its sky: {}", build.path, reason));
    }
}

} // namespace relume::gltf
