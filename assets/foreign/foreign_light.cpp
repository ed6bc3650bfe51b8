#include "assets/foreign/foreign_build.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/constants.hpp>

namespace relume::foreign {
namespace {

constexpr float kPi = glm::pi<float>();

// Sides of an area light whose size libassimp does not tell [m].
constexpr float kUnknownSide = 1.0f;
// Where a file of COLLADA tells no outer cone, libassimp guesses it by a cosine that falls to a tenth, so
// that it is at least acos(0.1) wider [rad].
constexpr float kGuessedCone = 1.4706f;
// The whole angle of a new spot of Blender's: libassimp tells none for .blend files [rad].
constexpr float kBlenderCone = glm::quarter_pi<float>();

glm::vec3 finiteColor(const aiColor3D& color) {
    const glm::vec3 rgb(color.r, color.g, color.b);
    return glm::any(glm::isnan(rgb)) || glm::any(glm::isinf(rgb)) ? glm::vec3(0.0f) : rgb;
}

glm::vec3 directionOf(const glm::dmat4& world, const glm::vec3& local, const glm::vec3& fallback) {
    const glm::dvec3 turned = glm::dmat3(world) * glm::dvec3(local);
    const double length = glm::length(turned);
    return std::isfinite(length) && length > 0.0 ? glm::vec3(turned / length) : fallback;
}

/// Returns the transform of something at a place that looks along -Z.
glm::mat4 looking(const glm::vec3& place, const glm::vec3& along, const glm::vec3& up) {
    const glm::vec3 back = -along;
    glm::vec3 right = glm::cross(up, back);
    if (glm::length(right) < 1e-4f) // they are parallel: any will do
        right = glm::cross(std::abs(back.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0), back);
    right = glm::normalize(right);
    glm::mat4 transform(1.0f);
    transform[0] = glm::vec4(right, 0.0f);
    transform[1] = glm::vec4(glm::cross(back, right), 0.0f);
    transform[2] = glm::vec4(back, 0.0f);
    transform[3] = glm::vec4(place, 1.0f);
    return transform;
}

glm::vec3 placeOf(const glm::dmat4& world, const aiVector3D& local) {
    return glm::vec3(world * glm::dvec4(local.x, local.y, local.z, 1.0));
}

bool isPlaced(const glm::mat4& transform) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            if (!std::isfinite(transform[c][r])) return false;
    return true;
}

/// Says by how much a light falls off at a distance in units of the file; 1 where the file has no word for
/// it.
float fallOff(const Build& build, const aiLight& light, float distance) {
    const float c = light.mAttenuationConstant, l = light.mAttenuationLinear, q = light.mAttenuationQuadratic;
    const bool unsaid = c == 0.0f && l == 1.0f && q == 0.0f; // as libassimp makes a light
    // In .fbx files the constant is the distance where the fall-off begins.
    const bool constant = l == 0.0f && q == 0.0f && build.ending == ".fbx";
    const float sum = c + l * distance + q * distance * distance;
    return unsaid || constant || !std::isfinite(sum) || sum <= 0.0f ? 1.0f : sum;
}

/// Sets the half angles of a cone by whole ones [rad].
void setCone(float inner, float outer, Light& light) {
    if (!std::isfinite(outer) || outer <= 0.0f) outer = inner;
    if (!std::isfinite(outer) || outer <= 0.0f) outer = glm::half_pi<float>();
    if (!std::isfinite(inner)) inner = 0.0f;
    if (inner > outer) std::swap(inner, outer);
    light.outerConeAngle = std::clamp(outer / 2, 1e-3f, glm::half_pi<float>());
    // glTF wants the inner cone to be smaller.
    light.innerConeAngle = std::clamp(inner / 2, 0.0f, 0.98f * light.outerConeAngle);
}

void setConeOfFile(const Build& build, const aiLight& source, Light& light) {
    const float inner = source.mAngleInnerCone;
    float outer = source.mAngleOuterCone;
    if (build.ending == ".3ds") outer -= inner; // libassimp adds them
    if (build.ending == ".dae" && outer - inner > kGuessedCone - 1e-3f) outer = inner;
    setCone(inner, outer, light);
}

/// Sets the intensity of a light in watts by what Cycles makes of it, which a path traced plane below each
/// kind confirms: a sphere of P watts has P / 4 pi W/sr, a spot is such a sphere behind a screen, a sun's
/// watts are those per square metre that faces it, and an area light has P / 4A W/(m^2 sr), which is pi / 4
/// of what a Lambertian surface of that power would have.
void setByWatts(Light& light, float value) {
    const float lumens = kLumensPerWatt * value;
    if (light.type == LightType::Point || light.type == LightType::Spot)
        light.intensity = lumens / (4 * kPi);
    else if (light.type == LightType::Rectangle)
        light.intensity = lumens / (4 * light.size.x * light.size.y);
    else
        light.intensity = lumens;
}

/// Sets the intensity of a light without a unit: a white surface that it shines upon has the radiance that
/// the file says, at the distance Placing::reach.
void setByLook(const Build& build, const aiLight& source, const Placing& placing, Light& light, float value) {
    const float reach = placing.reach;
    const auto inFile = static_cast<float>(reach / placing.scale);
    const float candela = kPi * value * reach * reach / fallOff(build, source, inFile);
    if (light.type == LightType::Directional)
        light.intensity = kPi * value;
    else if (light.type == LightType::Rectangle)
        light.intensity = candela / (light.size.x * light.size.y);
    else
        light.intensity = candela;
}

void addAmbient(Build& build, const aiLight& source, const std::string& name) {
    const glm::vec3 color = glm::max(finiteColor(source.mColorAmbient), glm::vec3(0.0f));
    if (color == glm::vec3(0.0f)) return;
    build.made.scene.sky.radiance += unitOfLight(build) * color;
    build.warnings.add("ambient light " + inQuotes(name), "shines from everywhere: it becomes a sky");
}

/// Sets the kind, and what only that kind has. Returns false where there is none that shines.
bool setKind(Build& build, const aiLight& source, Light& light, const Placing& placing) {
    switch (source.mType) {
    case aiLightSource_POINT:
        light.type = LightType::Point;
        return true;
    case aiLightSource_SPOT:
        light.type = LightType::Spot;
        setConeOfFile(build, source, light);
        return true;
    case aiLightSource_DIRECTIONAL:
        light.type = LightType::Directional;
        return true;
    case aiLightSource_UNDEFINED: // area lights of .fbx files, spots of .blend files
        if (build.ending == ".blend" && build.inWatts) {
            light.type = LightType::Spot;
            setCone(kBlenderCone, kBlenderCone, light);
            build.warnings.add("spot light " + inQuotes(light.name),
                               "has no cone that libassimp tells: it becomes one of 45 degrees");
            return true;
        }
        if (build.ending != ".fbx") return false;
        [[fallthrough]];
    case aiLightSource_AREA: {
        light.type = LightType::Rectangle;
        // The node's scale counts: its lengths along the light's own X and Y.
        const glm::vec2 size(
            source.mSize.x * glm::length(glm::dmat3(placing.world) * glm::dvec3(1.0, 0.0, 0.0)),
            source.mSize.y * glm::length(glm::dmat3(placing.world) * glm::dvec3(0.0, 1.0, 0.0)));
        const bool known = std::isfinite(size.x) && std::isfinite(size.y) && size.x > 0 && size.y > 0;
        light.size = known ? size : glm::vec2(kUnknownSide);
        if (!known)
            build.warnings.add("area light " + inQuotes(light.name),
                               "has no size that libassimp tells: it becomes a square of 1 m");
        return true;
    }
    default:
        return false;
    }
}

} // namespace

void addLight(Build& build, const aiLight& source, const Placing& placing) {
    Light light;
    light.name = nameOf(source.mName);
    if (source.mType == aiLightSource_AMBIENT) return addAmbient(build, source, light.name);
    if (!setKind(build, source, light, placing)) {
        build.warnings.add("light " + inQuotes(light.name), "is of a kind that is not supported, left out");
        return;
    }
    const glm::vec3 down(0.0f, -1.0f, 0.0f);
    const bool untold = source.mType == aiLightSource_UNDEFINED && build.ending == ".blend";
    const glm::vec3 along = untold ? glm::vec3(0.0f, 0.0f, -1.0f) : vec3Of(source.mDirection);
    light.transform =
        looking(placeOf(placing.world, source.mPosition), directionOf(placing.world, along, down),
                directionOf(placing.world, vec3Of(source.mUp), glm::vec3(0.0f, 1.0f, 0.0f)));
    if (!isPlaced(light.transform)) {
        build.warnings.add("light " + inQuotes(light.name), "has no finite position, left out");
        return;
    }
    const glm::vec3 color = glm::max(finiteColor(source.mColorDiffuse), glm::vec3(0.0f));
    const float value = std::max({color.r, color.g, color.b});
    if (value > 0.0f) light.color = color / value;
    if (build.inWatts)
        setByWatts(light, value);
    else
        setByLook(build, source, placing, light, value);
    build.made.scene.lights.push_back(std::move(light));
}

void addCamera(Build& build, const aiCamera& source, const Placing& placing) {
    Camera camera;
    camera.name = nameOf(source.mName);
    camera.transform =
        looking(placeOf(placing.world, source.mPosition),
                directionOf(placing.world, vec3Of(source.mLookAt), glm::vec3(0.0f, 0.0f, -1.0f)),
                directionOf(placing.world, vec3Of(source.mUp), glm::vec3(0.0f, 1.0f, 0.0f)));
    if (!isPlaced(camera.transform)) return;
    // These width and height belong to an angle where the file has no word for it: those of old programs.
    constexpr float kUsualAspect = 4.0f / 3.0f, kWideAspect = 16.0f / 9.0f;
    const bool known = std::isfinite(source.mAspect) && source.mAspect > 0.01f && source.mAspect < 100.0f;
    const bool old = build.ending == ".3ds" || build.ending == ".ase";
    const float aspect = known ? source.mAspect : old ? kUsualAspect : kWideAspect;
    if (known) camera.aspect = aspect;
    // The angle is the whole horizontal one, other than libassimp's documentation says: all its readers give
    // it so. That of a .3ds file is the focal length in mm [3D Studio File Format], taken for degrees.
    float across = source.mHorizontalFOV;
    if (build.ending == ".3ds") across = glm::radians(2400.0f / glm::degrees(across));
    constexpr float kLeast = 0.02f, kMost = 3.1f; // [rad]; what is outside was not told
    if (std::isfinite(across) && across > kLeast && across < kMost)
        camera.yfov = 2.0f * std::atan(std::tan(across / 2) / aspect);
    const auto scale = static_cast<float>(placing.scale);
    if (source.mOrthographicWidth > 0.0f && std::isfinite(source.mOrthographicWidth)) {
        camera.perspective = false;
        camera.ymag = source.mOrthographicWidth * scale / aspect;
    }
    const float nearest = source.mClipPlaneNear * scale, farthest = source.mClipPlaneFar * scale;
    if (std::isfinite(nearest) && nearest > 0.0f) camera.znear = nearest;
    if (std::isfinite(farthest) && farthest > camera.znear) camera.zfar = farthest;
    build.made.scene.cameras.push_back(std::move(camera));
}

} // namespace relume::foreign
