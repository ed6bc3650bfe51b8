#include "app/commands/command.h"
#include "app/commands/export_probes.h"
#include "app/commands/export_web.h"
#include "app/edit/choice_options.h"
#include "app/export/export_options.h"
#include "app/offline/bake_checkpoints.h"
#include "app/offline/command_files.h"
#include "app/offline/lightmap_attributes.h"
#include "app/offline/progress.h"
#include "app/offline/solve.h"
#include "app/text/interrupt.h"
#include "assets/base/clock.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/images/paged_image.h"
#include "shaders/shader_library.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

namespace relume {
namespace {

struct ExportCommand {
    BakeOptions bake;
    ExportOptions out;
    WebOptions web;
    std::string lightmap, layers; // "": bake
    std::string probes;           // "": none
};

FloatImage bakedLightmap(const vk::Device& device, const PreparedScene& prepared, const BakeRequest& request,
                         const BakeOptions& options) {
    Baker baker(device, prepared.scene, prepared.mesh, request.bake);
    spdlog::info("{} patches", baker.patches().count);
    warnIfDark(prepared.scene, baker.patches());
    BakeCheckpoints none(options);
    solve(baker.solver(), request.bake.solver, none);
    FloatImage image = baker.lightmap(request.lightmap);
    addLightmapAttributes(image, options.files.scene, request.bake, request.lightmap,
                          baker.solver().progress());
    return image;
}

// Returns the lightmap that is given, nothing where one is to be baked, and reads the probes that come along.
std::optional<FloatImage> givenLight(const ExportCommand& o, ExportDesc& desc) {
    std::optional<LayeredImage> layers;
    if (!o.layers.empty()) layers = readLayeredLightmap(o.layers);
    if (layers) warnAboutLayers(*layers, o.layers, o.bake.files.scene);
    desc.extras = readProbeExtras(desc.engine, o.probes, layers ? &*layers : nullptr);
    if (layers) return std::move(layers->composite);
    if (!o.lightmap.empty()) return readLightmap(o.lightmap, o.bake.files.scene);
    return std::nullopt;
}

// Throws Error where a file that is exported is one of those that are read.
void checkExportFiles(CommandFiles files, const ExportDesc& desc) {
    for (const std::string& path : exportedFiles(desc))
        files.writes("--output", path);
    files.check();
}

void exportScene(const ExportCommand& o) {
    const auto start = Clock::now();
    const InterruptGuard guard;
    ExportDesc desc = resolveExportOptions(o.out);
    desc.extras = probeExtras(desc.engine, o.probes);
    BakeRequest request = resolveBakeOptions(o.bake);
    if (request.prepare.pages.value_or(0) > 0) desc.pages = {*request.prepare.pages};
    CommandFiles files;
    files.readsScene("SCENE", o.bake.files.scene).readsLightmap("--lightmap", o.lightmap);
    files.readsLightmap("--layers", o.layers);
    files.reads("--probes", o.probes);
    checkExportFiles(files, desc);
    checkExport(desc);
    if (!o.bake.machine.shaders.empty()) setShaderFolder(o.bake.machine.shaders);
    std::optional<FloatImage> lightmap = givenLight(o, desc);
    if (lightmap) checkLightmap(*lightmap, o.lightmap.empty() ? o.layers : o.lightmap);
    if (lightmap) {
        matchLightmap(request.prepare, *lightmap);
        desc.pages = lightmapPagesOf(*lightmap);
        checkExportFiles(files, desc); // now that the number of pages is known
    }
    std::optional<PhaseProgress> phase(std::in_place, true);
    const PreparedScene prepared = prepareFor(request);
    stopIfInterrupted();
    const vk::Device device(deviceDesc(o.bake.machine));
    spdlog::info("device: {} ({})", device.info().name, device.info().driver);
    phase.reset();
    if (!lightmap) desc.onFailure = OnFailure::Keep;
    if (!lightmap) lightmap = bakedLightmap(device, prepared, request, o.bake);
    stopIfInterrupted();
    const ExportResult result =
        exportLevel(desc, device, {prepared.scene, prepared.atlas, prepared.mesh}, *lightmap);
    for (const std::string& path : result.files)
        std::printf("%s\n", path.c_str());
    spdlog::info("wrote {} for {}, exposure {:.2f} EV ({} in all)", desc.folder, o.out.engine,
                 result.exposure, formatDuration(secondsSince(start)));
    failOnValidation(device.validationMessages());
}

} // namespace

void addExportCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "export",
        "Write a scene with its lightmap as a game engine reads it: GLB, KTX2, loader; or as a web page");
    const auto o = std::make_shared<ExportCommand>();
    command
        ->add_option("SCENE", o->bake.files.scene,
                     "Scene: .glb, .gltf, .obj, .fbx, .dae, ...; with --web also its layers: .exr")
        ->required()
        ->type_name("");
    addChoiceOptions(*command, o->bake.files.choice);
    addExportOptions(*command, o->out);
    CLI::Option* lightmap = command
                                ->add_option("--lightmap", o->lightmap,
                                             "Take this lightmap, .exr, .ktx2 or .png, and do not bake")
                                ->type_name("FILE");
    CLI::Option* layers =
        command
            ->add_option(
                "--layers", o->layers,
                "Take the sum of these layers ('relume bake --layers', 'relume mix --layers-out'), and "
                "do not bake")
            ->type_name("LAYERS.exr")
            ->excludes(lightmap);
    CLI::Option* probes =
        command
            ->add_option("--probes", o->probes,
                         "Take these light probes along ('relume bake --probes-out'): as they are, for three "
                         "also as its LightProbe objects, for bevy as its volume")
            ->type_name("FILE.json");
    addSizeOption(*command, "--size", o->bake);
    // The surfaces are drawn on the device, whoever bakes.
    addSolverOptionsBeside(*command, o->bake, {lightmap, layers}, {"--device", "--validate"});
    for (CLI::Option* given : {lightmap, layers})
        for (const char* size : {"--size", "--pages"})
            command->get_option(size)->excludes(given);
    CLI::Option* web =
        command
            ->add_option(
                "--web", o->web.path,
                "Write a web page in this folder, on which the lights are mixed, in place of --for and "
                "-o; it needs layers, and opens without a network")
            ->type_name("OUT")
            ->excludes(lightmap)
            ->excludes(probes);
    for (const char* engines :
         {"--for", "--output", "--texture-format", "--texture-size", "--gloss", "--size", "--pages"})
        web->excludes(command->get_option(engines));
    command->add_flag("--single-file", o->web.single, "With --web: one file, OUT.html")->needs(web);
    command
        ->add_option("--timelapse", o->web.timelapse,
                     "With --web: show these pictures of the bake, too ('relume timelapse')")
        ->type_name("FOLDER")
        ->needs(web);
    command->callback([o] {
        if (o->web.path.empty()) return exportScene(*o);
        exportWeb(o->web, o->bake, o->layers, o->out.exposure);
    });
}

} // namespace relume
