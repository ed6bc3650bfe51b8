#include "app/offline/bake_options.h"

#include "app/edit/choice_options.h"
#include "app/edit/furnishing_options.h"
#include "app/edit/page_options.h"
#include "app/offline/compression_option.h"
#include "app/text/option_checks.h"
#include "app/text/typed_numbers.h"
#include "bake/links/link_solver.h"
#include "bake/trace/make_tracer.h"
#include "bake/trace/voxel_map.h"

#include <CLI/CLI.hpp>

namespace relume {
namespace {

constexpr double kDefaultError = 0.01;
// The local error that is asked for where only the error of the whole is given.
constexpr double kLocalErrorShare = 5.0;

// Adds the options of the methods that follow directions.
void addLinkOptions(CLI::App& command, LinkOptions& o) {
    command
        .add_option(
            "--samples", o.samples,
            "directional, hybrid: directions per patch, in whole sample passes (default: what --error needs)")
        ->check(wholeFrom(1, LinkSolver::kMaxSamples));
    command
        .add_option("--directions", o.directions,
                    "directional, hybrid: sobol (default), or lec, the thesis' largest-empty-circle sets")
        ->check(oneOf({"sobol", "lec"}));
    command
        .add_option(
            "--rotate", o.rotate,
            "directional, hybrid: directions differ from patch to patch (default), interleaved in 4x4 "
            "patches, or from tile to tile")
        ->check(oneOf({"patch", "interleaved", "tile"}));
    command
        .add_option(
            "--points", o.points,
            "directional, hybrid: samples start all over the texel (texel, default), so that edges of "
            "shadows are averaged, or in its middle (centre)")
        ->check(oneOf({"texel", "centre"}));
    command
        .add_option("--indirect-scale", o.indirectScale,
                    "directional, hybrid: follow directions from one patch of so many by so many texels and "
                    "interpolate: 1 (default), 2 or 4")
        ->check(oneOf({"1", "2", "4"}));
    command.add_flag("--footprint", o.footprint,
                     "directional, hybrid: read the mean light over what each direction stands for, within a "
                     "chart: less noise from few directions, but biased, which --error does not tell");
    command.add_flag(
        "--per-chunk", o.perChunk,
        "directional, hybrid: samples go, chunk by chunk of the lightmap, where light is still off; on the "
        "CPU only: a GPU gives every patch as many");
    command.add_flag("--no-smooth", o.noSmooth, "hybrid: leave the indirect light as it was sampled");
}

void addCheckpointOptions(CLI::App& command, CheckpointOptions& o) {
    CLI::Option* checkpoint = command.add_option(
        "--checkpoint", o.file, "Save to this file every so often, and on Ctrl-C, what --resume needs");
    command.add_option("--checkpoint-every", o.every, "Seconds between two of these")
        ->capture_default_str()
        ->check(numberFrom(0.05, 86400.0))
        ->needs(checkpoint);
    command.add_option("--resume", o.resume,
                       "Go on from a checkpoint of the same bake: the result will be the same");
}

void resolveLinkOptions(const BakeOptions& o, SolverSettings& solver) {
    const bool links = !isPairMethod(solver.method);
    if (o.links.samples > 0 && !links)
        throw UsageError("--samples: only with --method directional or hybrid, others have no directions");
    if (!o.links.directions.empty() && !links)
        throw UsageError("--directions: only with --method directional or hybrid, others have none");
    if (!o.links.rotate.empty() && !links)
        throw UsageError("--rotate: only with --method directional or hybrid, others have no directions");
    if (!o.links.points.empty() && !links)
        throw UsageError("--points: only with --method directional or hybrid, others take a texel's middle");
    if (o.links.noSmooth && solver.method != Method::Hybrid)
        throw UsageError("--no-smooth: only with --method hybrid, others are never smoothed");
    if (o.links.indirectScale > 0 && !links)
        throw UsageError("--indirect-scale: only with --method directional or hybrid, others know no "
                         "indirect light apart");
    if (o.links.perChunk && !links)
        throw UsageError("--per-chunk: only with --method directional or hybrid, others have no samples");
    if (o.solve.localError >= 0 && !links)
        throw UsageError("--local-error: only with --method directional or hybrid, others cannot tell it");
    if (o.links.footprint && !links)
        throw UsageError("--footprint: only with --method directional or hybrid, others have no directions");
    if (links && solver.transport.rtrad) {
        throw UsageError(std::string("--method ") + methodName(solver.method) +
                         ": RTRad has no right one, --preset rtrad goes with pure and its samplings only");
    }
    if (o.layers.on && solver.method != Method::Hybrid)
        throw UsageError("--layers: only with --method hybrid, others do not tell lights apart");
    if (o.layers.on && (o.links.indirectScale > 1 || o.links.footprint || o.links.directions == "lec"))
        throw UsageError("--layers: not with --indirect-scale, --footprint or --directions lec");
    solver.layers.on = o.layers.on;
    solver.layers.error = o.layers.error;
    if (!o.layers.memory.empty()) solver.layers.bytes = typedMemory("--layer-memory", o.layers.memory);
    solver.links.samples = o.links.samples;
    solver.links.smooth = !o.links.noSmooth;
    solver.links.directions = o.links.directions == "lec" ? DirectionSet::Lec : DirectionSet::Sobol;
    solver.links.rotation = o.links.rotate == "interleaved" ? Rotation::Interleaved
                            : o.links.rotate == "tile"      ? Rotation::Tile
                                                            : Rotation::Patch;
    solver.links.indirectScale = std::max(o.links.indirectScale, 1u);
    solver.links.footprint = o.links.footprint;
    solver.links.allOver = o.links.points != "centre";
    // The passes of these methods are bounces: how many samples they need is another question.
    if (!links) return;
    solver.links.perChunk = o.links.perChunk;
    solver.error = o.solve.error > 0 ? o.solve.error : o.links.samples > 0 ? 0.0 : kDefaultError;
    solver.localError = o.solve.localError >= 0 ? o.solve.localError : kLocalErrorShare * solver.error;
}

void addVoxelOptions(CLI::App& command, VoxelOptions& o) {
    command
        .add_option("--voxels", o.resolution,
                    "Voxels along each edge of the voxel map (default 128; --tracer voxel, --voxel-ratio)")
        ->check(wholeFrom(kMinVoxels, kMaxVoxels));
    command
        .add_option("--voxel-ratio", o.ratio,
                    "One sender in this many marches through voxels; 0: none, 1: all")
        ->capture_default_str()
        ->check(wholeFrom(0, 256));
}

} // namespace

std::vector<std::string> methodNames() {
    std::vector<std::string> names;
    for (const Method method : {Method::Pure, Method::Static, Method::MonteCarlo, Method::Mipmapped,
                                Method::Adaptive, Method::Directional, Method::Hybrid})
        names.emplace_back(methodName(method));
    return names;
}

std::vector<std::string> tracerNames() {
    std::vector<std::string> names;
    for (const TracerKind kind : {TracerKind::Auto, TracerKind::Rtp, TracerKind::Query, TracerKind::Bvh,
                                  TracerKind::Embree, TracerKind::Voxel})
        names.emplace_back(tracerName(kind));
    return names;
}

void addSolverOptions(CLI::App& command, BakeOptions& o) {
    command
        .add_option(
            "--method", o.solve.method,
            "How light is gathered: hybrid (default), directional, pure, static, montecarlo, mipmapped or "
            "adaptive")
        ->check(oneOf(methodNames()));
    addPairOptions(command, o.pairs);
    command.add_option("--passes", o.solve.passes, "Stop after this many passes (bounces)")
        ->check(wholeFrom(1, Solver::kMaxPasses));
    command
        .add_option("--error", o.solve.error,
                    "Stop when the remaining error is below this (default 0.01 without --passes)")
        ->check(numberFrom(1e-6, 1.0));
    command
        .add_option(
            "--local-error", o.solve.localError,
            "directional, hybrid: and when the local error of 95 % of all texels, relative to their own "
            "light, is below this; 0: it may be any (default: five times --error)")
        ->check(numberFrom(0.0, 100.0));
    addLinkOptions(command, o.links);
    addVoxelOptions(command, o.voxels);
    addMachineOptions(command, o);
}

void addSolverOptionsBeside(CLI::App& command, BakeOptions& options,
                            const std::vector<CLI::Option*>& lightmaps,
                            const std::vector<std::string>& alsoUsed) {
    const std::vector<CLI::Option*> before = command.get_options();
    addSolverOptions(command, options);
    std::vector<std::string> used = {"--unwrap", "--density", "--daylight", "--strict",
                                     "--shaders"}; // also without a bake
    used.insert(used.end(), alsoUsed.begin(), alsoUsed.end());
    for (CLI::Option* option : command.get_options()) {
        const bool ofSolver = std::find(before.begin(), before.end(), option) == before.end();
        if (!ofSolver || std::find(used.begin(), used.end(), option->get_name()) != used.end()) continue;
        for (CLI::Option* lightmap : lightmaps)
            option->excludes(lightmap);
    }
}

vk::Device::Desc deviceDesc(const MachineOptions& machine) {
    return {.select = machine.device,
            .turn = machine.turn,
            .validation = machine.validate,
            .memoryLimit = machine.memory};
}

void addMachineOptions(CLI::App& command, BakeOptions& o) {
    command.add_option("--tracer", o.machine.tracer, "What traces rays")
        ->capture_default_str()
        ->check(oneOf(tracerNames()));
    command.add_option("--device", o.machine.device,
                       "Vulkan device: index or part of its name (relume devices)");
    command.add_option_function<std::string>(
        "--device-memory",
        [&o](const std::string& text) { o.machine.memory = typedMemory("--device-memory", text); },
        "At most so much of the device's memory, as 512M or 2G (default: what is free); what does not fit is "
        "read from the machine's own");
    command
        .add_option("--reflectivity", o.solve.reflectivity, "Scales the albedo (default 1; preset rtrad 0.9)")
        ->check(numberFrom(0.0, 10.0));
    command.add_option("--dilate", o.lightmap.dilate, "Rings of texels filled around charts")
        ->capture_default_str()
        ->check(wholeFrom(0, 64));
    command.add_flag("--no-sew", o.lightmap.noSew, "Leave the texels around charts empty");
    command.add_flag("--conservative", o.patches.conservative,
                     "Every texel that a triangle touches becomes a patch");
    addFurnishingOptions(command, o.patches.furnishing);
    command.add_flag("--device-gather", o.machine.deviceGather,
                     "Gather by the device's shaders also where it is the CPU, whose own loops are faster");
    command.add_option("--batch-ms", o.machine.batchMs, "Aim of one submit in milliseconds")
        ->capture_default_str()
        ->check(numberFrom(0.1, 45.0));
    command
        .add_option("--shaders", o.machine.shaders,
                    "Compile the shaders from this folder instead of the built-in ones")
        ->check(existingFolder());
    command.add_flag("--validate", o.machine.validate, "Run under the Vulkan validation layers");
}

void addSizeOption(CLI::App& command, const std::string& name, BakeOptions& o) {
    command
        .add_option_function<uint32_t>(
            name,
            [&o](uint32_t size) {
                o.patches.size = size;
                o.patches.sizeTyped = true;
            },
            fmt::format(
                "Lightmap edge in texels, that of each page (default: {}, or more where --density needs it)",
                o.patches.size))
        ->check(wholeFrom(8, Baker::kMaxSize));
    addPagesOption(command, o.patches.pages);
}

CLI::Option* addLayerMemory(CLI::App& command, BakeOptions& o) {
    return command.add_option("--layer-memory", o.layers.memory,
                              "Layers take at most so much, as 512M or 2G (default: a third of the free "
                              "device memory, beside a GPU "
                              "a quarter of the machine's, too); lights beyond share layers");
}

void addBakeOptions(CLI::App& command, BakeOptions& o) {
    command.add_option("SCENE", o.files.scene, "Scene: .glb, .gltf, .obj, .fbx, .dae, ...")
        ->required()
        ->type_name("");
    addChoiceOptions(command, o.files.choice);
    command.add_option("-o,--output", o.files.output, "Lightmap to write, .exr or .png")->required();
    command.add_option("--picture", o.files.picture, "Write the lightmap to this .png as well");
    addSizeOption(command, "--size", o);
    addSolverOptions(command, o);
    command.add_option("--error-map", o.files.errorMap,
                       "Write each texel's standard error as an image, .exr or .png");
    command
        .add_option("--quantity", o.lightmap.quantity,
                    "lighting: irradiance / pi; radiance: emission + albedo * lighting")
        ->check(oneOf({"lighting", "radiance"}));
    command.add_option("--preset", o.solve.preset, "rtrad: the reference implementation to the letter")
        ->check(oneOf({"rtrad"}));
    command.add_option("--distance-factor", o.solve.distanceFactor, "Scales distances, preset rtrad only")
        ->check(numberFrom(0.0, 2.0));
    CLI::Option* layers = command.add_flag(
        "--layers", o.layers.on,
        "Bake each light by itself and write its share of the lightmap, too: a multi-part .exr "
        "that 'relume mix' weighs anew");
    addLayerMemory(command, o)->needs(layers);
    command
        .add_option("--layer-error", o.layers.error,
                    "Go on until the remaining error of each layer by itself is below this (default: "
                    "--error is about all of them together)")
        ->check(numberFrom(1e-6, 1.0))
        ->needs(layers);
    command
        .add_option(
            "--lights", o.layers.lights,
            "Bake the layers of these lights alone, as a job beside others ('relume info --light-names' "
            "names all); 'relume mix --join' puts the files of all jobs together. The bytes are those "
            "of one bake where each layer stops by itself: give all jobs the same --samples, with or "
            "without --layer-error, and no --error")
        ->type_name("NAME,...")
        ->expected(1)
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->needs(layers);
    command.add_flag("--half", o.files.half, "Write 16-bit floats");
    addCompressionOption(command, o.files.compression);
    addCheckpointOptions(command, o.checkpoint);
    addProbeOptions(command, o.probes);
    command.add_option("--json", o.files.json, "Write statistics to this file, - for standard output");
    command.add_option("--scene-out", o.files.sceneOut,
                       "Write the scene with the lightmap UVs that were used, .glb");
}

VoxelSettings resolveVoxels(const BakeOptions& o) {
    const bool voxelTracer = parseTracerKind(o.machine.tracer) == TracerKind::Voxel;
    if (voxelTracer && o.voxels.ratio > 1) {
        throw UsageError("--voxel-ratio " + std::to_string(o.voxels.ratio) +
                         ": mixes voxels into another tracer; leave out --tracer voxel");
    }
    if (o.voxels.resolution > 0 && !voxelTracer && o.voxels.ratio == 0)
        throw UsageError("--voxels: only with --tracer voxel or --voxel-ratio");
    VoxelSettings voxels{.ratio = voxelTracer ? 1 : o.voxels.ratio};
    if (o.voxels.resolution > 0) voxels.resolution = o.voxels.resolution;
    return voxels;
}

BakeRequest resolveBakeOptions(const BakeOptions& o) {
    const bool rtrad = o.solve.preset == "rtrad";
    if (rtrad && o.lightmap.quantity == "lighting") {
        throw UsageError("--quantity lighting: --preset rtrad computes RTRad's radiosity only; leave it "
                         "out or use radiance");
    }
    if (!rtrad && o.solve.distanceFactor >= 0) {
        throw UsageError("--distance-factor: only with --preset rtrad, it has no physical meaning");
    }
    checkFurnishing(o.patches.furnishing);
    if (!o.patches.pages.empty())
        checkPages(*askedPages(o.patches.pages), o.patches.size, o.patches.furnishing.density);
    if (!o.files.picture.empty() && !o.files.picture.ends_with(".png"))
        throw UsageError("--picture: '" + o.files.picture + "' does not end in .png");
    if (!o.files.sceneOut.empty() && !o.files.sceneOut.ends_with(".glb"))
        throw UsageError("--scene-out: '" + o.files.sceneOut +
                         "' does not end in .glb: scenes are written as binary glTF");
    if (o.layers.on && !o.files.output.ends_with(".exr"))
        throw UsageError("--layers: layers are kept in OpenEXR only: give -o a name that ends in .exr");
    if (o.layers.on && o.lightmap.quantity == "radiance")
        throw UsageError("--layers: of lighting only, as radiance is no sum of lights: leave out --quantity");
    checkCompression(o.files.compression, {o.files.output, o.files.errorMap});
    BakeRequest request;
    request.prepare = {.path = o.files.scene,
                       .choice = o.files.choice,
                       .size = o.patches.size,
                       .pages = askedPages(o.patches.pages),
                       .leastDensity = o.patches.sizeTyped ? 0.0 : o.patches.furnishing.density,
                       .furnishing = o.patches.furnishing};
    request.bake.size = o.patches.size;
    request.bake.conservative = o.patches.conservative;
    request.bake.tracer = parseTracerKind(o.machine.tracer);
    request.bake.voxels = resolveVoxels(o);
    SolverSettings& solver = request.bake.solver;
    solver.transport.rtrad = rtrad;
    solver.transport.deviceGather = o.machine.deviceGather;
    solver.transport.reflectivity = static_cast<float>(o.solve.reflectivity >= 0 ? o.solve.reflectivity
                                                       : rtrad                   ? double(kRtradReflectivity)
                                                                                 : 1.0);
    solver.transport.distanceFactor =
        o.solve.distanceFactor >= 0 ? static_cast<float>(o.solve.distanceFactor) : 1.0f;
    solver.passes = o.solve.passes;
    solver.error = o.solve.error > 0 ? o.solve.error : o.solve.passes > 0 ? 0.0 : kDefaultError;
    solver.batchMs = o.machine.batchMs;
    if (!o.solve.method.empty())
        solver.method = parseMethod(o.solve.method);
    else
        solver.method = rtrad ? Method::Pure : Method::Hybrid;
    resolvePairOptions(o.pairs, solver);
    resolveLinkOptions(o, solver);
    const bool radiance = rtrad || o.lightmap.quantity == "radiance";
    request.lightmap = {.quantity = radiance ? Quantity::Radiance : Quantity::Lighting,
                        .reflectivity = solver.transport.reflectivity,
                        .sew = !o.lightmap.noSew && o.lightmap.dilate > 0,
                        .dilate = o.lightmap.dilate,
                        .rtrad = rtrad};
    checkProbeOptions(o.probes, request.bake, o.lightmap.quantity == "radiance");
    return request;
}

PreparedScene prepareFor(BakeRequest& request) {
    PreparedScene prepared = prepareScene(request.prepare);
    request.prepare.size = request.bake.size = prepared.size;
    return prepared;
}

} // namespace relume
