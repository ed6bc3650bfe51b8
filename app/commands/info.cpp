#include "app/command.h"
#include "app/scene_info.h"
#include "assets/gltf.h"

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <memory>

namespace relume {
namespace {

using Json = nlohmann::ordered_json;

struct InfoOptions {
    std::string scene;
    uint32_t size = 512;
    bool json = false;
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
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const AtlasRect& rect = info.atlas.instances[i];
        json["instances"].push_back({{"name", scene.instances[i].name},
                                     {"mesh", scene.instances[i].mesh},
                                     {"texCoord", rect.texCoord},
                                     {"scale", jsonOf(rect.scale)},
                                     {"offset", jsonOf(rect.offset)}});
    }
    return json;
}

void printJson(const Scene& scene, const SceneInfo& info, uint32_t size) {
    const Json json = {{"scene", scene.path},
                       {"triangles", info.triangles},
                       {"maskedTriangles", info.maskedTriangles},
                       {"droppedTriangles", info.droppedTriangles},
                       {"meshes", scene.meshes.size()},
                       {"instances", scene.instances.size()},
                       {"materials", scene.materials.size()},
                       {"textures", scene.textures.size()},
                       {"lights", scene.lights.size()},
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
    // Names from the file need not be UTF-8.
    std::printf("%s\n", json.dump(2, ' ', false, Json::error_handler_t::replace).c_str());
}

void line(const char* name, const std::string& value) {
    std::printf("%-10s %s\n", name, value.c_str());
}

void printTable(const Scene& scene, const SceneInfo& info, uint32_t size) {
    line("scene", scene.path);
    line("triangles", fmt::format("{} ({} alpha-masked)", info.triangles, info.maskedTriangles));
    line("meshes", fmt::format("{} in {} instances", scene.meshes.size(), scene.instances.size()));
    line("materials", fmt::format("{}, {} textures", scene.materials.size(), scene.textures.size()));
    line("lights", fmt::format("{}", scene.lights.size()));
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
    const Scene scene = loadGltf(options.scene);
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
    command->add_option("scene", options->scene, "glTF 2.0 file (.gltf or .glb)")
        ->required()
        ->type_name("SCENE");
    command->add_option("--size", options->size, "Lightmap edge [texels]")
        ->capture_default_str()
        ->check(CLI::Range(1u, 65536u));
    command->add_flag("--json", options->json, "Print JSON instead of a table, with the atlas mapping");
    command->callback([options] { runInfo(*options); });
}

} // namespace relume
