#include "app/offline/bake_statistics.h"

#include "assets/base/file_write.h"
#include "bake/layers/layer_solver.h"
#include "bake/trace/voxel_map.h"

#include <iostream>

#include <nlohmann/json.hpp>

namespace relume {
namespace {

using Json = nlohmann::ordered_json;

Json atlasJson(const PreparedScene& prepared) {
    Json instances = Json::array();
    for (size_t i = 0; i < prepared.atlas.instances.size(); ++i) {
        const AtlasRect& rect = prepared.atlas.instances[i];
        instances.push_back({{"instance", prepared.scene.instances[i].name},
                             {"texcoord", rect.texCoord},
                             {"scale", {rect.scale.x, rect.scale.y}},
                             {"offset", {rect.offset.x, rect.offset.y}}});
        if (prepared.atlas.pages.count > 1) instances.back()["page"] = rect.page;
    }
    return {{"repacked", prepared.atlas.repacked}, {"instances", instances}};
}

// Tells how far each layer is, and how good by itself.
Json layersJson(const LayerSolver& solver) {
    Json layers = Json::array();
    for (const std::unique_ptr<Layer>& layer : solver.layers()) {
        const glm::vec3& weight = layer->source.weight;
        layers.push_back({{"name", layer->source.name},
                          {"weight", {weight.r, weight.g, weight.b}},
                          {"error", layer->error},
                          {"directSamplePasses", layer->level.directSamplePasses},
                          {"linkSamplePasses", layer->level.linkSamplePasses},
                          {"share", solver.shareOf(*layer)}});
    }
    return layers;
}

} // namespace

void writeStatistics(const std::string& path, const BakeStatistics& s) {
    const SolverProgress& p = s.baker.solver().progress();
    Json seconds, cpu;
    double total = 0, totalCpu = 0;
    for (const PhaseTime& phase : s.phases) {
        seconds[phase.name] = phase.seconds;
        cpu[phase.name] = phase.cpuSeconds;
        total += phase.seconds;
        totalCpu += phase.cpuSeconds;
    }
    seconds["total"] = total;
    double firstRay = 0; // rays begin with those that tell which patches lie inside something
    for (const PhaseTime& phase : s.phases) {
        if (phase.name == "validity" || phase.name == "solver set-up") break;
        firstRay += phase.seconds;
    }
    cpu["total"] = totalCpu;
    const VoxelSettings voxels = resolveVoxels(s.options);
    Json json = {{"version", RELUME_VERSION},
                 {"scene", s.options.files.scene},
                 {"output", s.options.files.output},
                 {"method", s.options.solve.method},
                 {"size", s.options.patches.size},
                 {"device", s.device.name},
                 {"driver", s.device.driver},
                 {"tracer", s.baker.tracer().name()},
                 {"voxels", voxels.ratio > 0 ? voxels.resolution : 0},
                 {"voxelRatio", voxels.ratio},
                 {"triangles", s.baker.patches().scene.mesh.triangleCount()},
                 {"patches", s.baker.patches().count},
                 {"invalidPatches", s.baker.invalidPatches()},
                 {"passes", p.passes},
                 {"samples", p.samples},
                 {"indirectScale", std::max(s.options.links.indirectScale, 1u)},
                 {"footprint", s.options.links.footprint},
                 {"error", p.error},
                 {"localError", p.localError95},
                 {"localError99", p.localError99},
                 {"gridError", p.gridError},
                 {"converged", p.converged},
                 {"pairs", p.pairs},
                 {"linksRead", p.linksRead},
                 {"rays", p.rays},
                 {"raysSaved", p.raysSaved},
                 {"cacheBytes", p.cacheBytes},
                 {"cachedShare", p.cachedShare},
                 {"spilledBytes", s.baker.spilledBytes()},
                 {"raysPerSecond", p.seconds > 0 ? static_cast<double>(p.rays) / p.seconds : 0.0},
                 {"traceSeconds", p.traceSeconds},
                 {"gatherSeconds", p.gatherSeconds},
                 {"passSeconds", p.passSeconds},
                 {"seconds", seconds},
                 {"cpuSeconds", cpu},
                 {"secondsToFirstRay", firstRay},
                 {"bakeCpuSeconds", s.bakeCpuSeconds},
                 {"atlas", atlasJson(s.prepared)}};
    if (s.prepared.atlas.pages.count > 1) json["pages"] = s.prepared.atlas.pages.count;
    if (s.baker.layers()) json["layers"] = layersJson(*s.baker.layers());
    // The names of files, and those from the scene's file, need not be UTF-8.
    const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
    if (path == "-")
        std::cout << text << std::flush;
    else
        writeFileAtomically(path, text);
}

} // namespace relume
