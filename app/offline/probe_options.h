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
    /// Returns the directions on each face.
    uint32_t samplesOrDefault() const;
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

/// Returns what these probes take in a bake of the scene: `layers` tells whether lights are told apart.
ProbeExtent probeExtent(const ProbeOptions& options, const ProbePlan& plan, const Scene& scene, bool layers);

} // namespace relume
