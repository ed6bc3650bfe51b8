#include "app/commands/command.h"
#include "app/edit/choice_options.h"
#include "app/offline/command_files.h"
#include "app/text/option_checks.h"
#include "assets/atlas/unwrap.h"
#include "assets/base/error.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"
#include "assets/gltf/gltf.h"

#include <cstdio>
#include <filesystem>
#include <memory>

namespace relume {
namespace {

struct UnwrapOptions {
    std::string scene, output;
    GltfChoice choice;
    UnwrapDesc desc;
    bool all = false;
};

void runUnwrap(const UnwrapOptions& options) {
    if (std::filesystem::path(options.output).extension() != ".glb")
        throw UsageError(options.output + ": unwrap writes GLB: give a name that ends in .glb");
    CommandFiles().readsScene("SCENE", options.scene).writes("--output", options.output).check();
    checkFileWritable(options.output, 0);
    Scene scene = loadGltf(options.scene, options.choice);
    for (const std::string& warning : scene.warnings)
        spdlog::warn("{}", warning);
    requireArea(scene);
    UnwrapDesc desc = options.desc;
    desc.onlyMissing = !options.all;
    const UnwrapResult result = unwrap(scene, desc);
    if (result.meshes == 0 && !options.all)
        spdlog::warn(
            "{}: every mesh with an area has valid lightmap UVs, they are kept: pass --all to replace them",
            options.scene);
    saveGlb(scene, options.output);
    std::printf("%s: %u meshes unwrapped into %u charts at %.4g texels/m\n", options.output.c_str(),
                result.meshes, result.charts, result.density);
}

} // namespace

void addUnwrapCommand(CLI::App& app) {
    const auto options = std::make_shared<UnwrapOptions>();
    CLI::App* command =
        app.add_subcommand("unwrap", "Make lightmap UVs (TEXCOORD_1) for meshes that have none");
    command->add_option("scene", options->scene, "glTF 2.0 file (.gltf or .glb)")
        ->required()
        ->type_name("SCENE");
    addChoiceOptions(*command, options->choice);
    command->add_option("-o,--output", options->output, "The scene with its new UVs (.glb)")
        ->required()
        ->type_name("OUT.glb");
    command->add_option("--density", options->desc.density, "Texels per metre; without it, what fills --size")
        ->check(numberAbove(0, 1e6));
    command->add_option("--size", options->desc.size, "Lightmap edge the density aims at [texels]")
        ->capture_default_str()
        ->check(wholeFrom(1, 65536));
    command->add_flag("--all", options->all, "Replace valid lightmap UVs too");
    command->callback([options] { runUnwrap(*options); });
}

} // namespace relume
