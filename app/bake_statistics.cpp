#include "app/bake_statistics.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>

#include <nlohmann/json.hpp>
#include <unistd.h>

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
    }
    return {{"repacked", prepared.atlas.repacked}, {"instances", instances}};
}

} // namespace

void checkStatisticsPath(const std::string& path) {
    const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
    if (std::filesystem::is_directory(path))
        throw Error(path + ": is a folder: name a file for the statistics");
    if (access(folder.c_str(), W_OK) != 0) {
        throw Error(path + ": cannot write into folder '" + folder.string() + "': " + std::strerror(errno));
    }
}

void writeTextFile(const std::string& path, const std::string& text) {
    const std::string temporary = path + ".tmp" + std::to_string(getpid());
    std::ofstream file(temporary, std::ios::binary);
    file << text;
    file.close();
    if (!file || std::rename(temporary.c_str(), path.c_str()) != 0) {
        const std::string reason = std::strerror(errno);
        std::remove(temporary.c_str());
        throw Error(path + ": cannot write: " + reason + ": choose another folder");
    }
}

void writeStatistics(const std::string& path, const BakeStatistics& s) {
    const SolverProgress& p = s.baker.solver().progress();
    Json seconds;
    double total = 0;
    for (const PhaseTime& phase : s.phases) {
        seconds[phase.name] = phase.seconds;
        total += phase.seconds;
    }
    seconds["total"] = total;
    const Json json = {{"version", RELUME_VERSION},
                       {"scene", s.options.scene},
                       {"output", s.options.output},
                       {"method", s.options.method},
                       {"size", s.options.size},
                       {"device", s.device.name},
                       {"driver", s.device.driver},
                       {"tracer", s.baker.tracer().name()},
                       {"triangles", s.baker.patches().scene.mesh.triangleCount()},
                       {"patches", s.baker.patches().count},
                       {"invalidPatches", s.baker.invalidPatches()},
                       {"passes", p.passes},
                       {"error", p.error},
                       {"converged", p.converged},
                       {"pairs", p.pairs},
                       {"rays", p.rays},
                       {"raysPerSecond", p.seconds > 0 ? static_cast<double>(p.rays) / p.seconds : 0.0},
                       {"traceSeconds", p.traceSeconds},
                       {"gatherSeconds", p.gatherSeconds},
                       {"seconds", seconds},
                       {"atlas", atlasJson(s.prepared)}};
    if (path == "-")
        std::cout << json.dump(2) << std::endl;
    else
        writeTextFile(path, json.dump(2) + "\n");
}

} // namespace relume
