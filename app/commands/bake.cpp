#include "app/commands/command.h"
#include "app/offline/bake_checkpoints.h"
#include "app/offline/bake_statistics.h"
#include "app/offline/command_files.h"
#include "app/offline/compression_option.h"
#include "app/offline/layer_file.h"
#include "app/offline/lightmap_attributes.h"
#include "app/offline/probe_bake.h"
#include "app/offline/probe_files.h"
#include "app/offline/progress.h"
#include "app/offline/solve.h"
#include "app/text/interrupt.h"
#include "assets/base/clock.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"
#include "assets/gltf/gltf.h"
#include "assets/images/image_file.h"
#include "shaders/shader_library.h"

#include <ctime>
#include <memory>
#include <optional>

namespace relume {
namespace {

// Returns the CPU time of all threads, the drivers' too [s].
double cpuSeconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void checkFiles(const BakeOptions& o) {
    CommandFiles()
        .readsScene("SCENE", o.files.scene)
        .reads("--resume", o.checkpoint.resume)
        .writes("--output", o.files.output)
        .writes("--picture", o.files.picture)
        .writes("--error-map", o.files.errorMap)
        .writes("--checkpoint", o.checkpoint.file)
        .writes("--json", o.files.json)
        .writes("--scene-out", o.files.sceneOut)
        .writes("--probes-out", o.probes.output)
        .mayBe("--checkpoint", "--resume")
        .check();
}

void bake(BakeOptions o) {
    const auto start = Clock::now();
    const InterruptGuard guard;
    BakeRequest request = resolveBakeOptions(o);
    checkFiles(o);
    o.solve.method = methodName(request.bake.solver.method);
    constexpr uint64_t kBytesPerTexel = 16; // uncompressed
    checkWritable(o.files.output, uint64_t{o.patches.size} * o.patches.size * kBytesPerTexel);
    if (!o.files.picture.empty()) checkWritable(o.files.picture);
    if (!o.files.errorMap.empty()) checkWritable(o.files.errorMap);
    if (!o.files.sceneOut.empty()) checkFileWritable(o.files.sceneOut, 0);
    if (!o.probes.output.empty()) checkFileWritable(o.probes.output, 0);
    if (!o.files.json.empty() && o.files.json != "-") checkFileWritable(o.files.json, 0);
    if (!o.machine.shaders.empty()) setShaderFolder(o.machine.shaders);
    BakeCheckpoints checkpoints(o);

    std::optional<PhaseProgress> phase(std::in_place, true);
    PreparedScene prepared = prepareScene(request.prepare);
    if (!o.files.sceneOut.empty()) checkGlb(prepared.scene, o.files.sceneOut);
    ProbePlan probePlan;
    if (o.probes.wanted()) {
        probePlan = planProbes(o.probes, prepared.mesh);
        request.bake.probes = probeExtent(o.probes, probePlan, prepared.scene, o.layers.on);
    }
    stopIfInterrupted();
    const auto deviceStart = Clock::now();
    const vk::Device device({.select = o.machine.device, .validation = o.machine.validate});
    spdlog::info("device: {} ({})", device.info().name, device.info().driver);
    const double deviceSeconds = secondsSince(deviceStart);

    const double cpuStart = cpuSeconds();
    Baker baker(device, prepared.scene, std::move(prepared.mesh), request.bake);
    spdlog::info("{} patches", baker.patches().count);
    warnIfDark(prepared.scene, baker.patches());
    checkpoints.begin(baker, prepared.scene, request.bake, device.info());
    phase.reset();
    solve(baker.solver(), request.bake.solver, checkpoints);
    phase.emplace(false);
    const auto probesStart = Clock::now();
    ProbeSet probes;
    if (o.probes.wanted())
        probes = bakeProbes(device, prepared.scene, baker, probePlan, o.probes.samplesOrDefault(),
                            request.bake.solver.transport.reflectivity);
    // From here on files are written, and all of them: what Ctrl-C ends before has written nothing.
    const auto writeStart = Clock::now();
    FloatImage image = baker.lightmap(request.lightmap);
    const double bakeCpuSeconds = cpuSeconds() - cpuStart;
    const SolverProgress& progress = baker.solver().progress();
    addLightmapAttributes(image, o.files.scene, request.bake, request.lightmap, progress);
    const ExrType type = o.files.half ? ExrType::Half : ExrType::Float;
    const ExrCompression compression = compressionOf(o.files.compression);
    if (o.layers.on)
        writeLayers(o.files.output, layeredImage(baker, prepared.scene, request.lightmap, image.attributes),
                    type, compression);
    else
        writeImage(o.files.output, image, type, compression);
    if (!o.files.picture.empty()) writeImage(o.files.picture, image);
    if (!o.files.errorMap.empty())
        writeImage(o.files.errorMap, baker.errorMap(), ExrType::Float, compression);
    if (o.probes.wanted()) writeProbes(o.probes.output, probes);
    if (!o.files.sceneOut.empty()) saveGlb(withAtlas(prepared.scene, prepared.atlas), o.files.sceneOut);

    spdlog::info("{}: {}, {:.3g} Mrays in {:.2f} s ({:.1f} Mrays/s), remaining error {:.2g}", o.solve.method,
                 isPairMethod(request.bake.solver.method)
                     ? fmt::format("{} passes", progress.passes)
                     : fmt::format("{} directions per patch", progress.samples),
                 static_cast<double>(progress.rays) * 1e-6, progress.seconds,
                 static_cast<double>(progress.rays) * 1e-6 / progress.seconds, progress.error);
    spdlog::info("wrote {} ({} in all)", o.files.output, formatDuration(secondsSince(start)));
    failOnValidation(device.validationMessages());
    if (o.files.json.empty()) return;
    std::vector<PhaseTime> phases = {
        {"load", prepared.loadSeconds}, {"atlas", prepared.atlasSeconds}, {"device", deviceSeconds}};
    phases.insert(phases.end(), baker.phases().begin(), baker.phases().end());
    phases.push_back({"solve", progress.seconds});
    if (o.probes.wanted())
        phases.push_back({"probes", std::chrono::duration<double>(writeStart - probesStart).count()});
    phases.push_back({"write", secondsSince(writeStart)});
    writeStatistics(o.files.json, {.options = o,
                                   .prepared = prepared,
                                   .baker = baker,
                                   .device = device.info(),
                                   .phases = phases,
                                   .bakeCpuSeconds = bakeCpuSeconds});
}

} // namespace

void addBakeCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand("bake", "Bake a scene's radiosity lightmap");
    auto options = std::make_shared<BakeOptions>();
    addBakeOptions(*command, *options);
    command->callback([options] { bake(*options); });
}

} // namespace relume
