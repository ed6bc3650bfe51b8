#pragma once

#include <string>
#include <vector>

#include "bake/baker/baker.h"
#include "bake/probes/probe_grid.h"
#include "bake/probes/probe_links.h"

namespace CLI {
class App;
} // namespace CLI

namespace relume {

/// Says which light probes the user wants, and which file they go to.
struct ProbeOptions {
    double spacing = 0;          // of a grid [m]; 0: none
    std::vector<std::string> at; // "X,Y,Z" [m] of single probes
    uint32_t samples = 0;        // directions on each of six faces; 0: not given
    std::string output;          // .json; "": not given

    bool wanted() const { return spacing > 0 || !at.empty(); }
};

void addProbeOptions(CLI::App& command, ProbeOptions& options);
/// Throws UsageError where they contradict each other or the settings of the bake.
void checkProbeOptions(const ProbeOptions& options, const BakeSettings& bake, bool radianceWanted);

/// The places of probes, and the grid that they are of, where they are of one.
struct ProbePlan {
    bool isGrid = false;
    ProbeGrid grid;
    std::vector<glm::vec3> points; // [m]
};
/// Plans a grid within the bounds of the scene's triangles, or single places. Throws UsageError.
ProbePlan planProbes(const ProbeOptions& options, const WorldMesh& mesh);

/// Traces and gathers the probes of a finished bake. Throws Error.
std::vector<Probe> bakeProbes(const vk::Device& device, const Scene& scene, Baker& baker,
                              const ProbePlan& plan, uint32_t samples, float reflectivity);

/// Writes them as JSON under a temporary name that is then changed. Throws Error.
void writeProbes(const std::string& path, const ProbePlan& plan, const std::vector<Probe>& probes);

} // namespace relume
