#pragma once

#include <string>
#include <vector>

#include "app/edit/prepare.h"
#include "app/offline/pair_options.h"
#include "bake/baker/baker.h"
#include "bake/trace/voxel_map.h"

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace relume {

constexpr float kRtradReflectivity = 0.9f; // of RTRad's preset, unless told otherwise

/// The options that the user typed after `relume bake`.
struct BakeOptions {
    std::string scene, output, picture, errorMap, json, sceneOut, shaders, device;
    std::string method;             // "": hybrid, or with the RTRad preset pure
    std::string directions, rotate; // "": not given
    std::string tracer = "auto", preset, quantity;
    uint32_t size = 512;
    uint32_t passes = 0; // 0: not given
    uint32_t voxels = 0; // 0: not given
    uint32_t voxelRatio = 0;
    double error = 0;                              // 0: not given
    double reflectivity = -1, distanceFactor = -1; // negative: not given
    double density = 0;
    double batchMs = 20;
    std::string checkpoint, resume;
    double checkpointEvery = 30; // [s]
    uint32_t dilate = 4;
    uint32_t samples = 0;       // 0: not given
    uint32_t indirectScale = 0; // 0: not given
    bool noSmooth = false, footprint = false;
    bool layers = false;
    std::string layerMemory;
    PairOptions pairs; // and caches
    bool noSew = false, half = false, conservative = false, unwrap = false, validate = false;
    bool deviceGather = false;
};

void addBakeOptions(CLI::App& command, BakeOptions& options);
/// Adds those of them that say how a lightmap is made, for other verbs that need one.
void addSolverOptions(CLI::App& command, BakeOptions& options);
/// Adds those of them that go with every method and number of samples: tracer, device, patches, what is
/// written.
void addMachineOptions(CLI::App& command, BakeOptions& options);
/// Return how users name methods and tracers.
std::vector<std::string> methodNames();
std::vector<std::string> tracerNames();
/// Adds the option for the memory of a layer for each light.
CLI::Option* addLayerMemory(CLI::App& command, BakeOptions& options);
void addSizeOption(CLI::App& command, const std::string& name, BakeOptions& options);

/// The bake that the options ask for. resolveBakeOptions() throws UsageError when they contradict each other.
struct BakeRequest {
    PrepareDesc prepare;
    BakeSettings bake;
    LightmapDesc lightmap;
};
BakeRequest resolveBakeOptions(const BakeOptions& options);
/// Returns the part of it that concerns voxels; with a ratio of 0 they play no part.
VoxelSettings resolveVoxels(const BakeOptions& options);

} // namespace relume
