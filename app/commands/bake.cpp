#include "app/commands/run_bake.h"

#include "app/commands/command.h"
#include "app/offline/bake_checkpoints.h"
#include "app/offline/bake_settings.h"
#include "app/offline/bake_statistics.h"
#include "app/offline/chosen_lights.h"
#include "app/offline/command_files.h"
#include "app/offline/compression_option.h"
#include "app/offline/layer_file.h"
#include "app/offline/layer_join.h"
#include "app/offline/layer_ranks.h"
#include "app/offline/lightmap_attributes.h"
#include "app/offline/probe_bake.h"
#include "app/offline/probe_files.h"
#include "app/offline/progress.h"
#include "app/offline/rank_work.h"
#include "app/offline/solve.h"
#include "app/text/interrupt.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"
#include "assets/base/phase_clock.h"
#include "assets/gltf/gltf.h"
#include "assets/images/paged_image.h"
#include "shaders/shader_library.h"

#include <algorithm>
#include <future>
#include <memory>
#include <optional>

namespace relume {
namespace {

void checkFiles(const BakeOptions& o, uint32_t pages) {
    CommandFiles()
        .readsScene("SCENE", o.files.scene)
        .reads("--resume", o.checkpoint.resume)
        .writesLightmap("--output", o.files.output, pages)
        .writesLightmap("--picture", o.files.picture, pages)
        .writesLightmap("--error-map", o.files.errorMap, pages)
        .writes("--checkpoint", o.checkpoint.file)
        .writes("--json", o.files.json)
        .writes("--scene-out", o.files.sceneOut)
        .writes("--probes-out", o.probes.output)
        .mayBe("--checkpoint", "--resume")
        .check();
}

// Makes the device while the scene is read, since drivers take long to start and hardly a core. Where the
// scene is bad, that is told; what is wrong with the device is told by get().
class DeviceStart {
public:
    explicit DeviceStart(const MachineOptions& machine)
        : device_(std::async(std::launch::async, [desc = deviceDesc(machine)] {
              return std::make_unique<const vk::Device>(desc);
          })) {}
    /// Waits for the device; throws Error where there is none.
    std::unique_ptr<const vk::Device> get() { return device_.get(); }

private:
    std::future<std::unique_ptr<const vk::Device>> device_;
};

// Returns the layers as they are written, marked where others are baked elsewhere.
LayeredImage writtenLayers(const BakeOptions& o, const Baker& baker, const Scene& scene,
                           const BakeRequest& request) {
    LayeredImage image = layeredImage(baker, scene, request.lightmap);
    fitTo(o.files.output, image, o.files.half ? ExrType::Half : ExrType::Float);
    if (!request.bake.solver.layers.lights.empty())
        noteJob(image, *baker.layers(),
                {.lights = lightNames(scene), .fingerprint = sceneFingerprint(scene, baker.patches())});
    return image;
}

void checkOutputs(const BakeOptions& o, uint32_t pages) {
    constexpr uint64_t kBytesPerTexel = 16; // uncompressed
    checkWritable(o.files.output, uint64_t{pages} * o.patches.size * o.patches.size * kBytesPerTexel);
    if (!o.files.picture.empty()) checkWritable(o.files.picture);
    if (!o.files.errorMap.empty()) checkWritable(o.files.errorMap);
    if (!o.files.sceneOut.empty()) checkFileWritable(o.files.sceneOut, 0);
    if (!o.probes.output.empty()) checkFileWritable(o.probes.output, 0);
    if (!o.files.json.empty() && o.files.json != "-") checkFileWritable(o.files.json, 0);
}

// Returns the layers that this process has baked, with all that the file says of them.
LayeredImage ownLayers(const BakeOptions& o, const BakeRequest& request, const Scene& scene, Baker& baker) {
    LayeredImage layers = writtenLayers(o, baker, scene, request);
    addLightmapAttributes(layers.composite, o.files.scene, request.bake, request.lightmap,
                          baker.solver().progress());
    noteSceneOut(layers.composite, o.files.sceneOut);
    return layers;
}

// Leaves this rank's share of the lights that are baked, all of the scene's where none is named. Returns
// whether it has any; the first rank always has work.
bool takeLights(std::vector<std::string>& lights, const Scene& scene, const Ranks& ranks) {
    lights = dealtLights(lights.empty() ? lightNames(scene) : lights, ranks.rank(), ranks.count());
    return !lights.empty() || ranks.speaks();
}

// Writes the lightmap, of layers those of all ranks, and the maps that go with it. Returns the CPU time when
// the lightmap was made.
double writeMaps(const BakeOptions& o, const BakeRequest& request, const PreparedScene& prepared,
                 Baker& baker, LayeredImage layers) {
    if (o.layers.on && layers.layers.empty()) layers = ownLayers(o, request, prepared.scene, baker);
    FloatImage image = o.layers.on ? layers.composite : baker.lightmap(request.lightmap);
    const double made = cpuSeconds();
    if (!o.layers.on) {
        addLightmapAttributes(image, o.files.scene, request.bake, request.lightmap,
                              baker.solver().progress());
        noteSceneOut(image, o.files.sceneOut);
    }
    const ExrType type = o.files.half ? ExrType::Half : ExrType::Float;
    const ExrCompression compression = compressionOf(o.files.compression);
    if (o.layers.on) {
        writeLayers(o.files.output, layers, type, compression);
    } else {
        writeLightmap(o.files.output, image, type, compression);
    }
    if (!o.files.picture.empty()) writeLightmapPicture(o.files.picture, image);
    if (!o.files.errorMap.empty())
        writeLightmap(o.files.errorMap, baker.errorMap(), ExrType::Float, compression);
    return made;
}

// Returns what all ranks must have alike.
std::string describeBake(const BakeSettings& settings, uint32_t triangles, const vk::DeviceInfo& device) {
    return fmt::format("{} triangles on '{}' ({}), version {} {}", triangles, device.name, device.driver,
                       RELUME_VERSION, describeSettings(settings));
}

void logSolver(Method method, const SolverProgress& progress) {
    spdlog::info("{}: {}, {:.3g} Mrays in {:.2f} s ({:.1f} Mrays/s), remaining error {:.2g}",
                 methodName(method),
                 isPairMethod(method) ? fmt::format("{} passes", progress.passes)
                                      : fmt::format("{} directions per patch", progress.samples),
                 static_cast<double>(progress.rays) * 1e-6, progress.seconds,
                 static_cast<double>(progress.rays) * 1e-6 / progress.seconds, progress.error);
}

} // namespace

WholeBake runBake(BakeOptions o, double startSeconds, Ranks& ranks) {
    const auto start = Clock::now();
    const double startCpu = startSeconds > 0 ? 0.0 : cpuSeconds();
    std::vector<PhaseTime> phases;
    if (startSeconds > 0) phases.push_back({"start", startSeconds, cpuSeconds()});
    PhaseClock clock(phases);
    const InterruptGuard guard;
    BakeRequest request = resolveBakeOptions(o);
    checkSharedBake(o, request, ranks.count());
    // Each rank bakes layers of its own by itself; other bakes are shared chunk by chunk.
    const bool byLights = o.layers.on && !ranks.alone();
    Ranks& sharing = byLights ? oneProcess() : ranks;
    request.bake.ranks = &sharing;
    const uint32_t asked = request.prepare.pages.value_or(1);
    checkFiles(o, asked);
    o.solve.method = methodName(request.bake.solver.method);
    if (ranks.speaks()) checkOutputs(o, std::max(asked, 1u));
    if (!o.machine.shaders.empty()) setShaderFolder(o.machine.shaders);
    BakeCheckpoints checkpoints(o, ranks);

    std::optional<PhaseProgress> phase(std::in_place, ranks.alone());
    DeviceStart deviceStart(o.machine);
    PreparedScene prepared = prepareFor(request);
    o.patches.size = request.bake.size;
    phases.insert(phases.end(), prepared.phases.begin(), prepared.phases.end());
    if (prepared.atlas.pages.count != asked) checkFiles(o, prepared.atlas.pages.count);
    if (!o.files.sceneOut.empty()) checkGlb(prepared.scene, o.files.sceneOut);
    ProbePlan probePlan;
    if (!o.layers.lights.empty())
        request.bake.solver.layers.lights =
            chosenLights("--lights", o.layers.lights, lightNames(prepared.scene));
    const bool idle = byLights && !takeLights(request.bake.solver.layers.lights, prepared.scene, ranks);
    if (o.probes.wanted()) {
        probePlan = planProbes(o.probes, prepared.mesh);
        request.bake.probes = probeExtent(o.probes, probePlan, prepared.scene, o.layers.on);
    }
    stopIfInterrupted();
    clock.restart();
    const std::unique_ptr<const vk::Device> owned = deviceStart.get();
    const vk::Device& device = *owned;
    spdlog::info("device: {} ({})", device.info().name, device.info().driver);
    clock.end("device");

    const double cpuStart = cpuSeconds();
    requireAlike(ranks, describeBake(request.bake, prepared.mesh.triangleCount(), device.info()));
    if (idle) {
        gatherLayers(ranks, {});
        return {};
    }
    Baker baker(device, prepared.scene, std::move(prepared.mesh), request.bake);
    phases.insert(phases.end(), baker.phases().begin(), baker.phases().end());
    phase.reset();
    sharing.meet(); // a signal that comes after the next line finds all ranks past what it would end at once
    spdlog::info("{} patches", baker.patches().count);
    warnIfDark(prepared.scene, baker.patches());
    checkpoints.begin(baker, prepared.scene, request.bake, device.info());
    clock.restart();
    solve(baker.solver(), request.bake.solver, checkpoints, sharing);
    clock.end("solve");
    phase.emplace(false);
    LayeredImage joined; // of all ranks
    if (byLights)
        joined = gatherLayers(ranks, ownLayers(o, request, prepared.scene, baker));
    else if (!ranks.alone())
        baker.solver().light(); // which the first rank has from all others then
    if (!ranks.speaks()) return {};
    ProbeSet probes;
    if (o.probes.wanted()) {
        probes = bakeProbes(device, prepared.scene, baker, probePlan, o.probes.samplesOrDefault(),
                            request.bake.solver.transport.reflectivity);
        clock.end("probes");
    }
    // From here on files are written, and all of them: what Ctrl-C ends before has written nothing.
    const SolverProgress& progress = baker.solver().progress();
    const double bakeCpuSeconds = writeMaps(o, request, prepared, baker, std::move(joined)) - cpuStart;
    if (o.probes.wanted()) writeProbes(o.probes.output, probes);
    if (!o.files.sceneOut.empty()) saveGlb(withAtlas(prepared.scene, prepared.atlas), o.files.sceneOut);
    clock.end("write");

    logSolver(request.bake.solver.method, progress);
    const std::vector<std::string> files = lightmapFiles(o.files.output, prepared.atlas.pages);
    spdlog::info("wrote {}{} ({} in all)", files.front(), files.size() > 1 ? " to " + files.back() : "",
                 formatDuration(secondsSince(start)));
    failOnValidation(device.validationMessages());
    addOther(phases, startSeconds + secondsSince(start), cpuSeconds() - startCpu);
    const WholeBake whole{.tracer = baker.tracer().name(),
                          .size = baker.patches().scene.size,
                          .patches = baker.patches().count,
                          .triangles = baker.patches().scene.mesh.triangleCount(),
                          .phases = phases};
    if (!o.files.json.empty())
        writeStatistics(o.files.json, {.options = o,
                                       .prepared = prepared,
                                       .baker = baker,
                                       .device = device.info(),
                                       .phases = phases,
                                       .bakeCpuSeconds = bakeCpuSeconds});
    return whole;
}

void addBakeCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand("bake", "Bake a scene's radiosity lightmap");
    auto options = std::make_shared<BakeOptions>();
    addBakeOptions(*command, *options);
    command->callback([options] {
        const Launch launch = launchOfProcess();
        options->machine.turn = launch.localRank;
        runOnRanks(launch, [&](Ranks& ranks) { runBake(*options, processSeconds(), ranks); });
    });
}

} // namespace relume
