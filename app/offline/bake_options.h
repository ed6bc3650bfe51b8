#pragma once

#include <string>
#include <vector>

#include "app/edit/prepare.h"
#include "app/offline/pair_options.h"
#include "app/offline/probe_options.h"
#include "bake/baker/baker.h"
#include "bake/trace/voxel_map.h"

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace relume {

constexpr float kRtradReflectivity = 0.9f; // of RTRad's preset, unless told otherwise

/// The files that a bake reads and writes; "": not given.
struct BakeFiles {
    std::string scene, output, picture, errorMap, json, sceneOut;
    bool half = false;       // the output, if it is an .exr
    std::string compression; // of the files that are .exr; "": not given
    GltfChoice choice;       // of the scene
};

/// The patches that the lightmap has.
struct PatchOptions {
    uint32_t size = 512;    // edge of a lightmap's page [texels]
    bool sizeTyped = false; // else the edge is what furnishing.density needs, where that is given
    std::string pages;      // as askedPages() takes them; "": not given
    bool conservative = false;
    Furnishing furnishing;
};

/// Says how light is gathered, and when that is enough.
struct SolveOptions {
    std::string method; // "": hybrid, or with the RTRad preset pure
    std::string preset;
    uint32_t passes = 0;                           // 0: not given
    double error = 0;                              // 0: not given
    double localError = -1;                        // negative: not given
    double reflectivity = -1, distanceFactor = -1; // negative: not given
};

/// The options of the methods that follow directions.
struct LinkOptions {
    uint32_t samples = 0;                   // 0: not given
    std::string directions, rotate, points; // "": not given
    uint32_t indirectScale = 0;             // 0: not given
    bool noSmooth = false, footprint = false, perChunk = false;
};

struct LayerOptions {
    bool on = false;
    std::string memory;              // "": not given
    double error = 0;                // 0: not given
    std::vector<std::string> lights; // as chosenLights() takes them; empty: not given
};

struct VoxelOptions {
    uint32_t resolution = 0; // 0: not given
    uint32_t ratio = 0;
};

/// The device, and how it works.
struct MachineOptions {
    std::string device, tracer = "auto", shaders;
    uint64_t memory = 0; // of the device at most [bytes]; 0: all that is free
    double batchMs = 20;
    bool deviceGather = false, validate = false;
    uint32_t turn = 0; // which of several devices alike (vk::Device::Desc); no option: a process's place
};

/// Returns the device that is asked for.
vk::Device::Desc deviceDesc(const MachineOptions& machine);

/// The texels that are written.
struct LightmapOptions {
    std::string quantity; // "": not given
    uint32_t dilate = 4;  // rings of texels filled around charts
    bool noSew = false;
};

struct CheckpointOptions {
    std::string file, resume; // "": none
    double every = 30;        // [s]
};

/// The options that the user typed after `relume bake`.
struct BakeOptions {
    BakeFiles files;
    PatchOptions patches;
    SolveOptions solve;
    LinkOptions links;
    PairOptions pairs; // and caches
    LayerOptions layers;
    VoxelOptions voxels;
    MachineOptions machine;
    LightmapOptions lightmap;
    CheckpointOptions checkpoint;
    ProbeOptions probes;
};

void addBakeOptions(CLI::App& command, BakeOptions& options);
/// Adds those of them that say how a lightmap is made, for other verbs that need one.
void addSolverOptions(CLI::App& command, BakeOptions& options);
/// Does the same for a verb that may take a lightmap instead: `lightmaps`, the options that
/// name one, exclude those that only a bake has. `alsoUsed` names what the verb itself needs without a bake.
void addSolverOptionsBeside(CLI::App& command, BakeOptions& options,
                            const std::vector<CLI::Option*>& lightmaps,
                            const std::vector<std::string>& alsoUsed = {});
/// Adds those of them that go with every method and number of samples: tracer, device, patches, what is
/// written.
void addMachineOptions(CLI::App& command, BakeOptions& options);
/// Return how users name methods and tracers.
std::vector<std::string> methodNames();
std::vector<std::string> tracerNames();
/// Adds the option for the memory of a layer for each light.
CLI::Option* addLayerMemory(CLI::App& command, BakeOptions& options);
/// Adds the option for the edge of the lightmap, and --pages.
void addSizeOption(CLI::App& command, const std::string& name, BakeOptions& options);

/// The bake that the options ask for. resolveBakeOptions() throws UsageError when they contradict each other.
struct BakeRequest {
    PrepareDesc prepare;
    BakeSettings bake;
    LightmapDesc lightmap;
};
BakeRequest resolveBakeOptions(const BakeOptions& options);
/// Prepares the request's scene, as prepareScene() does. Where its lightmap's size was chosen by a density,
/// the request bakes that one from then on.
PreparedScene prepareFor(BakeRequest& request);
/// Returns the part of it that concerns voxels; with a ratio of 0 they play no part.
VoxelSettings resolveVoxels(const BakeOptions& options);

} // namespace relume
