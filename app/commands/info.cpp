#include "app/commands/command.h"
#include "app/edit/choice_options.h"
#include "app/edit/scene_info.h"
#include "app/offline/chosen_lights.h"
#include "assets/model/light_names.h"
#include "app/text/option_checks.h"
#include "assets/base/warnings.h"
#include "assets/foreign/load_scene.h"

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdio>
#include <memory>

namespace relume {
namespace {

using Json = nlohmann::ordered_json;

struct InfoOptions {
    std::string scene;
    GltfChoice choice;
    uint32_t size = 512;
    bool json = false, lightNames = false;
};

template<typename Vec>
Json jsonOf(const Vec& v) {
    Json array = Json::array();
    for (glm::length_t i = 0; i < v.length(); ++i)
        array.push_back(v[i]);
    return array;
}

Json atlasJson(const Scene& scene, const SceneInfo& info, uint32_t size) {
    if (!info.mapped) return nullptr;
    Json json = {{"size", size},
                 {"repacked", info.atlas.repacked},
                 {"charts", info.charts},
                 {"coverage", info.statistics.coverage},
                 {"overlap", info.statistics.overlap},
                 {"texelsPerMetre",
                  {{"min", info.statistics.texelDensityMin},
                   {"mean", info.statistics.texelDensityMean},
                   {"max", info.statistics.texelDensityMax}}},
                 {"instances", Json::array()}};
    if (info.atlas.pages.count > 1) json["pages"] = info.atlas.pages.count;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const AtlasRect& rect = info.atlas.instances[i];
        json["instances"].push_back({{"name", scene.instances[i].name},
                                     {"mesh", scene.instances[i].mesh},
                                     {"texCoord", rect.texCoord},
                                     {"scale", jsonOf(rect.scale)},
                                     {"offset", jsonOf(rect.offset)}});
        if (info.atlas.pages.count > 1) json["instances"].back()["page"] = rect.page;
    }
    return json;
}

Json lightJson(const Light& light) {
    Json json = {{"name", light.name},
                 {"type", lightTypeName(light.type)},
                 {"intensity", light.intensity},
                 {"unit", lightUnit(light.type)},
                 {"color", jsonOf(light.color)}};
    if (light.type == LightType::Rectangle) json["size"] = jsonOf(light.size);
    if (light.type == LightType::Directional) json["angleDegrees"] = glm::degrees(light.angle);
    if (light.type == LightType::Disc) json["radius"] = light.radius;
    if (light.type == LightType::Point || light.type == LightType::Spot) {
        json["radius"] = light.radius;
        json["range"] = light.range > 0.0f ? Json(light.range) : Json(nullptr);
    }
    if (light.type == LightType::Spot)
        json["coneDegrees"] = {{"inner", glm::degrees(light.innerConeAngle)},
                               {"outer", glm::degrees(light.outerConeAngle)}};
    json["position"] =
        light.type == LightType::Directional ? Json(nullptr) : jsonOf(glm::vec3(light.transform[3]));
    json["direction"] = light.type == LightType::Point
                            ? Json(nullptr)
                            : jsonOf(glm::vec3(0.0f) - glm::vec3(light.transform[2]));
    return json;
}

Json lightsJson(const Scene& scene) {
    Json json = Json::array();
    for (const Light& light : scene.lights)
        json.push_back(lightJson(light));
    return json;
}

Json skyJson(const Sky& sky) {
    if (!sky.shines()) return nullptr;
    Json json = {{"radiance", jsonOf(sky.radiance)}, {"picture", nullptr}};
    if (!sky.pixels.empty())
        json["picture"] = {{"file", sky.file},
                           {"width", sky.width},
                           {"height", sky.height},
                           {"rotationDegrees", glm::degrees(sky.rotation)}};
    return json;
}

void printJson(const Scene& scene, const SceneInfo& info, uint32_t size) {
    const Json json = {{"scene", scene.path},
                       {"triangles", info.triangles},
                       {"maskedTriangles", info.maskedTriangles},
                       {"droppedTriangles", info.droppedTriangles},
                       {"scenes", scene.sceneNames},
                       {"variants", scene.variantNames},
                       {"meshes", scene.meshes.size()},
                       {"instances", scene.instances.size()},
                       {"materials", scene.materials.size()},
                       {"textures", scene.textures.size()},
                       {"lights", lightsJson(scene)},
                       {"sky", skyJson(scene.sky)},
                       {"cameras", scene.cameras.size()},
                       {"bounds", {{"min", jsonOf(info.low)}, {"max", jsonOf(info.high)}}},
                       {"area", info.area},
                       {"emitters",
                        {{"count", info.emitters},
                         {"area", info.emitterArea},
                         {"areaTimesEmission", jsonOf(info.emitted)},
                         {"textured", info.texturedEmitters}}},
                       {"lightmap", atlasJson(scene, info, size)},
                       {"warnings", info.warnings}};
    // The names in the file need not be UTF-8.
    std::printf("%s\n", json.dump(2, ' ', false, Json::error_handler_t::replace).c_str());
}

std::string quotedList(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names)
        text += (text.empty() ? "" : ", ") + inQuotes(name);
    return text;
}

void line(const char* name, const std::string& value) {
    std::printf("%-11s %s\n", name, value.c_str());
}

std::string describe(const Light& light) {
    std::string text = light.name.empty() ? "" : inQuotes(light.name) + ", ";
    text += fmt::format("{:.6g} {}, colour ({:.4g}, {:.4g}, {:.4g})", light.intensity, lightUnit(light.type),
                        light.color.r, light.color.g, light.color.b);
    if (light.type == LightType::Spot)
        text += fmt::format(", cone {:.4g} to {:.4g} degrees from the axis",
                            glm::degrees(light.innerConeAngle), glm::degrees(light.outerConeAngle));
    if (light.type == LightType::Rectangle)
        text += fmt::format(", {:.4g} x {:.4g} m", light.size.x, light.size.y);
    if (light.type == LightType::Directional && light.angle > 0.0f)
        text += fmt::format(", {:.4g} degrees across", glm::degrees(light.angle));
    if (light.radius > 0.0f) text += fmt::format(", radius {:.4g} m", light.radius);
    if (light.range > 0.0f) text += fmt::format(", range {:.4g} m", light.range);
    return text;
}

void printLights(const Scene& scene) {
    std::string counts;
    for (LightType type :
         {LightType::Point, LightType::Spot, LightType::Directional, LightType::Rectangle, LightType::Disc}) {
        const auto count = std::count_if(scene.lights.begin(), scene.lights.end(),
                                         [type](const Light& light) { return light.type == type; });
        if (count > 0)
            counts += fmt::format("{}{} {}", counts.empty() ? ": " : ", ", count, lightTypeName(type));
    }
    line("lights", std::to_string(scene.lights.size()) + counts);
    std::vector<Light> lights = scene.lights;
    std::stable_sort(lights.begin(), lights.end(),
                     [](const Light& a, const Light& b) { return a.type < b.type; });
    for (const Light& light : lights)
        line(lightTypeName(light.type), describe(light));
    const Sky& sky = scene.sky;
    if (!sky.shines()) {
        line("sky", "none");
    } else if (sky.pixels.empty()) {
        line("sky",
             fmt::format("({:.6g}, {:.6g}, {:.6g}) cd/m^2", sky.radiance.r, sky.radiance.g, sky.radiance.b));
    } else {
        line("sky", fmt::format("{}, {} x {}, times ({:.6g}, {:.6g}, {:.6g}), turned by {:.4g} degrees",
                                sky.file, sky.width, sky.height, sky.radiance.r, sky.radiance.g,
                                sky.radiance.b, glm::degrees(sky.rotation)));
    }
}

void printTable(const Scene& scene, const SceneInfo& info, uint32_t size) {
    line("scene", scene.path);
    line("triangles", fmt::format("{} ({} alpha-masked)", info.triangles, info.maskedTriangles));
    if (scene.sceneNames.size() > 1) line("scenes", quotedList(scene.sceneNames));
    if (!scene.variantNames.empty()) line("variants", quotedList(scene.variantNames));
    line("meshes", fmt::format("{} in {} instances", scene.meshes.size(), scene.instances.size()));
    line("materials", fmt::format("{}, {} textures", scene.materials.size(), scene.textures.size()));
    printLights(scene);
    line("cameras", fmt::format("{}", scene.cameras.size()));
    line("bounds", fmt::format("({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}) m", info.low.x,
                               info.low.y, info.low.z, info.high.x, info.high.y, info.high.z));
    line("area", fmt::format("{:.6g} m^2", info.area));
    line("emitters", fmt::format("{}, {:.6g} m^2, area x emission ({:.6g}, {:.6g}, {:.6g}) cd{}",
                                 info.emitters, info.emitterArea, info.emitted.r, info.emitted.g,
                                 info.emitted.b, info.texturedEmitters ? " at most (textured)" : ""));
    if (info.mapped) {
        const AtlasStatistics& s = info.statistics;
        line("lightmap",
             fmt::format("UVs {}, {} charts",
                         info.atlas.repacked ? "repacked, a rectangle per instance" : "used as they are",
                         info.charts));
        line("coverage", fmt::format("{:.1f} %, {:.3f} % of it covered more than once", 100.0 * s.coverage,
                                     100.0 * s.overlap));
        line("density", fmt::format("{:.4g} texels/m at {} x {} ({:.4g} to {:.4g})", s.texelDensityMean, size,
                                    size, s.texelDensityMin, s.texelDensityMax));
    } else {
        line("lightmap", "no usable UVs");
    }
    for (const std::string& warning : info.warnings)
        line("warning", warning);
}

void runInfo(const InfoOptions& options) {
    const Scene scene = loadScene(options.scene, options.choice);
    if (options.lightNames) {
        for (const std::string& name : lightNames(scene))
            std::printf("%s\n", name.c_str());
        return;
    }
    const SceneInfo info = inspectScene(scene, options.size);
    if (options.json)
        printJson(scene, info, options.size);
    else
        printTable(scene, info, options.size);
}

} // namespace

void addInfoCommand(CLI::App& app) {
    const auto options = std::make_shared<InfoOptions>();
    CLI::App* command = app.add_subcommand("info", "Tell what is in a scene and how its lightmap UVs are");
    command->add_option("SCENE", options->scene, "Scene: .glb, .gltf, .obj, .fbx, .dae, ...")
        ->required()
        ->type_name("");
    addChoiceOptions(*command, options->choice);
    command->add_option("--size", options->size, "Lightmap edge [texels]")
        ->capture_default_str()
        ->check(wholeFrom(1, 65536));
    CLI::Option* json =
        command->add_flag("--json", options->json, "Print JSON instead of a table, with the atlas mapping");
    command
        ->add_flag(
            "--light-names", options->lightNames,
            "Print only the names of all that shines, one a line, as 'relume bake --lights' takes them")
        ->excludes(json);
    command->callback([options] { runInfo(*options); });
}

} // namespace relume
