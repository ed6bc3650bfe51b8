#include "app/commands/command.h"
#include "app/offline/command_files.h"
#include "app/text/option_checks.h"
#include "assets/base/error.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"
#include "assets/foreign/foreign_files.h"
#include "assets/foreign/foreign_import.h"
#include "assets/foreign/load_scene.h"

#include <cstdio>
#include <memory>

#include <fmt/format.h>

namespace relume {
namespace {

struct ImportOptions {
    ImportDesc desc;
    std::string output, up = "y";
    double memory = 0; // [GiB], 0: the usual bound
};

constexpr double kGiB = 1024.0 * 1024.0 * 1024.0; // [bytes]

void runImport(const ImportOptions& options) {
    ImportDesc desc = options.desc;
    CommandFiles().readsScene("IN", desc.path).writes("--output", options.output).check();
    if (lowerEnding(options.output) != ".glb")
        throw UsageError(options.output + ": import writes GLB: give a name that ends in .glb");
    checkFileWritable(options.output, 0);
    if (const std::string ending = lowerEnding(desc.path); ending == ".glb" || ending == ".gltf")
        throw Error(desc.path + ": is a glTF file, which needs no import: open it as it is");
    desc.choice.up = options.up.front();
    if (options.memory > 0) desc.limits.memory = static_cast<uint64_t>(options.memory * kGiB);
    const ImportedFile file = importForeign(desc);
    const Scene scene = loadImported(desc.path, file); // so that what is wrong with it shows now
    for (const std::string& warning : scene.warnings)
        spdlog::warn("{}", warning);
    file.save(options.output);
    std::printf("%s: %zu meshes in %zu instances, %zu lights, %zu cameras\n", options.output.c_str(),
                scene.meshes.size(), scene.instances.size(), scene.lights.size(), scene.cameras.size());
}

} // namespace

void addImportCommand(CLI::App& app) {
    const auto options = std::make_shared<ImportOptions>();
    CLI::App* command = app.add_subcommand(
        "import", "Convert a scene of another kind (.obj, .fbx, .dae, .3ds, .blend, ...) to a .glb");
    std::string endings;
    for (const std::string& ending : foreignEndings())
        endings += (endings.empty() ? "" : " ") + ending;
    command->add_option("in", options->desc.path, "The file to convert")->required()->type_name("IN");
    command->add_option("-o,--output", options->output, "The converted scene (.glb)")
        ->required()
        ->type_name("OUT.glb");
    command->add_option("--scale", options->desc.choice.scale, "Factor on all lengths: 0.001 for millimetres")
        ->capture_default_str()
        ->check(numberFrom(1e-6, 1e6));
    command
        ->add_option("--up", options->up, "Axis that points up in the file, where it does not tell: x, y, z")
        ->capture_default_str()
        ->check(oneOf({"x", "y", "z"}));
    command
        ->add_option("--time-limit", options->desc.limits.seconds,
                     "Give up when reading takes longer [seconds]")
        ->capture_default_str()
        ->check(numberFrom(0.01, 1e6));
    command
        ->add_option("--memory-limit", options->memory,
                     "Give up when reading takes more [GiB] (default: 3/4 of the machine's, at most 16)")
        ->check(numberFrom(0.001, 1e6));
    command->footer("These kinds are known: " + endings +
                    "\nAll commands open them as they open .glb and .gltf files.");
    command->callback([options] { runImport(*options); });
}

} // namespace relume
