#include "app/edit/scene_edit.h"

#include "app/edit/scene_names.h"
#include "app/edit/scene_pose.h"
#include "assets/model/light_names.h"
#include "assets/base/error.h"
#include "assets/base/warnings.h"
#include "assets/images/sky_picture.h"
#include "assets/model/black_body.h"
#include "assets/model/scene_limits.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace relume {
namespace {

using ThingKind = NamedThing::Kind;

constexpr ThingKinds kLights{.lamps = true, .emitters = true, .sky = true};
constexpr ThingKinds kPlaced{.lamps = true, .objects = true};

float largest(const glm::vec3& v) {
    return std::max({v.x, v.y, v.z});
}

/// Returns the radiance with another strength. Colour and strength are parts of it: its brightest channel is
/// the strength, so that neither changes the other.
glm::vec3 withStrength(const glm::vec3& radiance, float strength) {
    const float brightest = largest(radiance);
    return brightest > 0.0f ? radiance / brightest * strength : glm::vec3(strength);
}

glm::vec3 withColor(const glm::vec3& radiance, const glm::vec3& color, const std::string& thing,
                    const char* strength) {
    if (!(largest(color) > 0.0f))
        throw UsageError(fmt::format("{} cannot be black: set its {} to 0", thing, strength));
    if (!(largest(radiance) > 0.0f))
        throw Error(fmt::format("{} does not shine and has no colour: set its {} first", thing, strength));
    return color / largest(color) * largest(radiance);
}

/// Returns the colour that a setting gives; a temperature is a way to say one.
std::optional<glm::vec3> colorOf(const Setting& setting) {
    if (setting.property == Property::Color) return std::get<glm::vec3>(setting.value);
    if (setting.property == Property::Temperature) return blackBody(std::get<float>(setting.value));
    return std::nullopt;
}

ThingKinds kindsWith(Property property) {
    switch (property) {
    case Property::Color:
    case Property::Temperature:
        return kLights;
    case Property::Intensity:
        return {.lamps = true, .sky = true};
    case Property::Strength:
        return {.emitters = true, .materials = true};
    case Property::BaseColor:
    case Property::Emission:
        return {.materials = true};
    case Property::Rotation:
    case Property::File:
        return {.sky = true};
    default:
        return {.lamps = true};
    }
}

bool hasProperty(LightType type, Property property) {
    const bool round = type == LightType::Point || type == LightType::Spot;
    switch (property) {
    case Property::Radius:
        return round || type == LightType::Disc;
    case Property::Range:
        return round;
    case Property::Inner:
    case Property::Outer:
        return type == LightType::Spot;
    case Property::Angle:
        return type == LightType::Directional;
    case Property::Size:
        return type == LightType::Rectangle;
    default:
        return true;
    }
}

std::string propertiesOf(LightType type) {
    constexpr std::array kOfLamps = {
        Property::Name,  Property::Intensity, Property::Color, Property::Temperature, Property::Radius,
        Property::Angle, Property::Size,      Property::Range, Property::Inner,       Property::Outer};
    std::string names;
    for (const Property property : kOfLamps)
        if (hasProperty(type, property))
            names += std::string(names.empty() ? "" : ", ") + propertyName(property);
    return names;
}

void setLamp(Light& light, const Setting& setting) {
    if (!hasProperty(light.type, setting.property))
        throw UsageError(fmt::format("a {} light has no {}: it has {}", lightTypeName(light.type),
                                     propertyName(setting.property), propertiesOf(light.type)));
    const auto number = [&] { return std::get<float>(setting.value); };
    if (const std::optional<glm::vec3> color = colorOf(setting)) light.color = *color;
    if (setting.property == Property::Name) light.name = std::get<std::string>(setting.value);
    if (setting.property == Property::Intensity) light.intensity = number();
    if (setting.property == Property::Radius) light.radius = number();
    if (setting.property == Property::Angle) light.angle = glm::radians(number());
    if (setting.property == Property::Size) light.size = std::get<glm::vec2>(setting.value);
    if (setting.property == Property::Range) light.range = number();
    if (setting.property == Property::Inner) light.innerConeAngle = glm::radians(number());
    if (setting.property == Property::Outer) light.outerConeAngle = glm::radians(number());
}

/// Throws UsageError where several settings do not go together.
void requireGood(const Light& light) {
    Light limited = light;
    if (const std::vector<std::string> problems = limitLight(limited); !problems.empty())
        throw UsageError(fmt::format("the light {}: give a smaller number", problems.front()));
    if (light.type == LightType::Disc && !(light.radius > 0.0f))
        throw UsageError("a disc needs a radius: give metres above 0");
    if (light.type == LightType::Spot && light.innerConeAngle > light.outerConeAngle)
        throw UsageError(
            fmt::format("the inner cone of {:.6g} degrees is wider than the outer one of {:.6g}: "
                        "make that wider first",
                        glm::degrees(light.innerConeAngle), glm::degrees(light.outerConeAngle)));
}

void setMaterial(Material& material, const Setting& setting, const std::string& label) {
    if (const std::optional<glm::vec3> color = colorOf(setting))
        material.emission = withColor(material.emission, *color, label, "strength");
    if (setting.property == Property::Strength)
        material.emission = withStrength(material.emission, std::get<float>(setting.value));
    if (setting.property == Property::Emission) material.emission = std::get<glm::vec3>(setting.value);
    if (setting.property == Property::BaseColor)
        material.baseColor = glm::vec4(std::get<glm::vec3>(setting.value), material.baseColor.a);
}

void setSky(SkySettings& sky, const Setting& setting) {
    if (const std::optional<glm::vec3> color = colorOf(setting))
        sky.radiance = withColor(sky.radiance, *color, "the sky", "intensity");
    if (setting.property == Property::Intensity)
        sky.radiance = withStrength(sky.radiance, std::get<float>(setting.value));
    if (setting.property == Property::Rotation) sky.rotation = glm::radians(std::get<float>(setting.value));
    if (setting.property != Property::File) return;
    sky.file = std::get<std::string>(setting.value);
    if (sky.file.empty()) return;
    Sky picture; // read to find now what is wrong with it, not only at the next load
    picture.file = sky.file;
    readSkyPicture(picture);
    limitSky(picture);
    if (!(largest(sky.radiance) > 0.0f)) sky.radiance = glm::vec3(1.0f);
}

size_t usersOf(const Scene& scene, uint32_t material) {
    return static_cast<size_t>(
        std::count_if(scene.instances.begin(), scene.instances.end(), [&](const Instance& instance) {
            if (instance.mesh < 0) return false;
            const std::vector<Primitive>& primitives =
                scene.meshes[static_cast<size_t>(instance.mesh)].primitives;
            return std::any_of(primitives.begin(), primitives.end(), [material](const Primitive& primitive) {
                return primitive.material == static_cast<int>(material);
            });
        }));
}

/// Makes the edits: each function makes one kind and tells what it did.
struct Editor {
    const Scene& scene;
    SceneEdits& edits;

    NamedThing find(const std::string& name, const ThingKinds& kinds) const {
        return findThing(namedThings(scene, edits), name, kinds);
    }
    /// Places a thing. Throws UsageError where it would reach too far.
    void place(const NamedThing& thing, const glm::mat4& transform) const {
        requirePlace(glm::vec3(transform[3]));
        const bool isLamp = thing.kind == ThingKind::Lamp;
        const int mesh = isLamp ? -1 : scene.instances[thing.index].mesh;
        if (mesh >= 0 && !isWithinReach(scene.meshes[static_cast<size_t>(mesh)], transform))
            throw UsageError(
                fmt::format("{} would reach beyond {:g} m: keep it nearer", thing.label(), kFarthest));
        (isLamp ? edits.lights[thing.index].transform : edits.placements[thing.index].transform) = transform;
    }
    const glm::mat4& transformOf(const NamedThing& thing) const {
        return thing.kind == ThingKind::Lamp ? edits.lights[thing.index].transform
                                             : edits.placements[thing.index].transform;
    }

    std::string operator()(const SetEdit& edit) const;
    std::string operator()(const MoveEdit& edit) const;
    std::string operator()(const RotateEdit& edit) const;
    std::string operator()(const AimEdit& edit) const;
    std::string operator()(const AddLightEdit& edit) const;
    std::string operator()(const AddSkyEdit& edit) const;
    std::string operator()(const DuplicateEdit& edit) const;
    std::string operator()(const DeleteEdit& edit) const;
    std::string operator()(const HideEdit& edit) const;
};

std::string Editor::operator()(const SetEdit& edit) const {
    relume::requireGood(edit.setting);
    const NamedThing thing = find(edit.name, kindsWith(edit.setting.property));
    std::string done = fmt::format("{}: {}", thing.label(), describe(edit.setting));
    if (thing.kind == ThingKind::Lamp) {
        setLamp(edits.lights[thing.index], edit.setting);
        requireGood(edits.lights[thing.index]);
    } else if (thing.kind == ThingKind::Sky) {
        setSky(edits.sky, edit.setting);
    } else {
        const uint32_t material = thing.kind == ThingKind::Emitter ? thing.material : thing.index;
        setMaterial(edits.materials[material], edit.setting, thing.label());
        const size_t users = thing.kind == ThingKind::Emitter ? usersOf(scene, material) : 1;
        if (users > 1)
            done += fmt::format(", of the material {}, which {} objects have",
                                inQuotes(edits.materials[material].name), users);
    }
    return done;
}

std::string Editor::operator()(const MoveEdit& edit) const {
    requirePoint(edit.place);
    const NamedThing thing = find(edit.name, kPlaced);
    glm::mat4 transform = transformOf(thing);
    const glm::vec3 to = edit.relative ? glm::vec3(transform[3]) + edit.place : edit.place;
    transform[3] = glm::vec4(to, 1.0f);
    place(thing, transform);
    return fmt::format("{}: at {:.6g},{:.6g},{:.6g}", thing.label(), to.x, to.y, to.z);
}

std::string Editor::operator()(const RotateEdit& edit) const {
    requirePoint(edit.degrees);
    const NamedThing thing = find(edit.name, kPlaced);
    place(thing, turned(transformOf(thing), edit.degrees));
    return fmt::format("{}: turned to {:.6g},{:.6g},{:.6g} degrees", thing.label(), edit.degrees.x,
                       edit.degrees.y, edit.degrees.z);
}

std::string Editor::operator()(const AimEdit& edit) const {
    requirePlace(edit.target);
    const NamedThing thing = find(edit.name, {.lamps = true});
    Light& light = edits.lights[thing.index];
    light.transform = aimed(light, edit.target);
    return fmt::format("{}: aimed at {:.6g},{:.6g},{:.6g}", thing.label(), edit.target.x, edit.target.y,
                       edit.target.z);
}

std::string Editor::operator()(const AddLightEdit& edit) const {
    Light light;
    light.type = edit.type;
    light.name = lightTypeName(edit.type);
    if (light.type == LightType::Disc) light.radius = 0.5f; // 1 m across, as a rectangle is
    requirePlace(edit.position);
    requirePoint(edit.rotation);
    for (const Setting& setting : edit.settings) {
        relume::requireGood(setting);
        setLamp(light, setting);
    }
    requireGood(light);
    light.transform[3] = glm::vec4(edit.position, 1.0f);
    light.transform = turned(light.transform, edit.rotation);
    if (edit.aim) {
        requirePlace(*edit.aim);
        light.transform = aimed(light, *edit.aim);
    }
    edits.lights.push_back(light);
    return fmt::format("light {}: added, {:.6g} {}", inQuotes(light.name), light.intensity,
                       lightUnit(light.type));
}

std::string Editor::operator()(const AddSkyEdit& edit) const {
    if (edits.sky.radiance != glm::vec3(0.0f))
        throw Error("the scene has a sky already: set that one's properties, or delete it first");
    edits.sky = {};
    edits.sky.radiance = glm::vec3(1.0f);
    for (const Setting& setting : edit.settings) {
        relume::requireGood(setting);
        if (!kindsWith(setting.property).sky)
            throw UsageError(
                fmt::format("a sky has no {}: it has color, temperature, intensity, rotation, file",
                            propertyName(setting.property)));
        setSky(edits.sky, setting);
    }
    return fmt::format("the sky: added, {:.6g} cd/m^2", largest(edits.sky.radiance));
}

std::string Editor::operator()(const DuplicateEdit& edit) const {
    const std::vector<NamedThing> things = namedThings(scene, edits);
    const NamedThing thing = findThing(things, edit.name, {.lamps = true});
    Light copy = edits.lights[thing.index];
    copy.node = -1;
    copy.name = edit.copy;
    const auto taken = [&](const std::string& name) {
        return std::any_of(things.begin(), things.end(), [&](const NamedThing& t) {
            return (t.kind == ThingKind::Lamp || t.kind == ThingKind::Emitter || t.kind == ThingKind::Sky) &&
                   t.name == name;
        });
    };
    for (uint32_t n = 2; copy.name.empty() || (edit.copy.empty() && taken(copy.name)); ++n)
        copy.name = fmt::format("{} {}", thing.name, n);
    edits.lights.push_back(copy);
    return fmt::format("{}: duplicated as {}", thing.label(), inQuotes(copy.name));
}

std::string Editor::operator()(const DeleteEdit& edit) const {
    const NamedThing thing = find(edit.name, kLights);
    if (thing.kind == ThingKind::Emitter)
        throw Error(fmt::format("{} is an object that shines, which cannot be deleted: set its strength to 0",
                                inQuotes(thing.name)));
    if (thing.kind == ThingKind::Sky && edits.sky == SkySettings())
        throw Error("the scene has no sky: there is nothing to delete");
    if (thing.kind == ThingKind::Lamp)
        edits.lights.erase(edits.lights.begin() + thing.index);
    else
        edits.sky = {};
    return thing.label() + ": deleted";
}

std::string Editor::operator()(const HideEdit& edit) const {
    const NamedThing thing = find(edit.name, {.objects = true});
    edits.placements[thing.index].hidden = edit.hidden;
    return thing.label() + (edit.hidden ? ": hidden" : ": shown");
}

} // namespace

std::string applyEdit(const Scene& scene, const SceneEdit& edit, SceneEdits& edits) {
    SceneEdits next = edits;
    std::string done = std::visit(Editor{scene, next}, edit);
    edits = std::move(next);
    return done;
}

} // namespace relume
