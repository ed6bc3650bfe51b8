#include "app/commands/command.h"
#include "app/edit/choice_options.h"
#include "app/edit/page_options.h"
#include "app/offline/command_files.h"
#include "app/text/option_checks.h"
#include "assets/atlas/lightmap_atlas.h"
#include "assets/atlas/unwrap.h"
#include "assets/base/clock.h"
#include "assets/base/error.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"
#include "assets/foreign/load_scene.h"
#include "assets/gltf/gltf.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

namespace relume {
namespace {

struct UnwrapOptions {
    std::string scene, output;
    std::string pages; // "": not given
    GltfChoice choice;
    UnwrapDesc desc;
    bool all = false, json = false;
};

constexpr uint32_t kUsualSize = 512; // [texels]

void runUnwrap(const UnwrapOptions& options) {
    if (std::filesystem::path(options.output).extension() != ".glb")
        throw UsageError(options.output + ": unwrap writes GLB: give a name that ends in .glb");
    UnwrapDesc desc = options.desc;
    desc.onlyMissing = !options.all;
    if (desc.size == 0 && desc.density <= 0.0)
        desc.size = kUsualSize; // else the size follows from the density
    const std::optional<uint32_t> pages = askedPages(options.pages);
    if (pages) checkPages(*pages, desc.size, desc.density);
    CommandFiles().readsScene("SCENE", options.scene).writes("--output", options.output).check();
    checkFileWritable(options.output, 0);
    Scene scene = loadScene(options.scene, options.choice);
    for (const std::string& warning : scene.warnings)
        spdlog::warn("{}", warning);
    requireArea(scene);
    desc.pages = pages.value_or(scene.pages);
    checkPages(desc.pages, desc.size, desc.density);
    const auto start = Clock::now();
    const UnwrapResult result = unwrap(scene, desc);
    const double seconds = secondsSince(start);
    if (result.meshes == 0 && !options.all)
        spdlog::warn(
            "{}: every mesh with an area has valid lightmap UVs, they are kept: pass --all to replace them",
            options.scene);
    saveGlb(scene, options.output);
    if (!options.json) {
        std::printf("%s: %u meshes unwrapped into %u charts at %.4g texels/m", options.output.c_str(),
                    result.meshes, result.charts, result.density);
        if (result.shortened > 0)
            std::printf(", %u longer than the lightmap with %.4g along themselves", result.shortened,
                        result.leastDensity);
        if (result.charts > 0)
            std::printf("; they cover %.1f %% of %s%u x %u texels", 100.0 * result.covered,
                        result.pages > 1 ? fmt::format("{} pages of ", result.pages).c_str() : "",
                        result.size, result.size);
        std::printf("\n");
        return;
    }
    nlohmann::ordered_json out = {{"meshes", result.meshes},
                                  {"objects", result.objects},
                                  {"charts", result.charts},
                                  {"size", result.size},
                                  {"density", result.density},
                                  {"shortened", result.shortened},
                                  {"leastDensity", result.leastDensity},
                                  {"seconds", seconds}};
    if (result.pages > 1) out["pages"] = result.pages;
    if (result.charts > 0) {
        const AtlasStatistics statistics =
            measureAtlas(scene, buildAtlas(scene, result.size, true), result.size);
        out["covered"] = result.covered;
        out["coveredWithGutters"] = result.reserved;
        out["stretch"] = statistics.stretch;
    }
    std::printf("%s\n", out.dump(2).c_str());
}

} // namespace

void addUnwrapCommand(CLI::App& app) {
    const auto options = std::make_shared<UnwrapOptions>();
    CLI::App* command =
        app.add_subcommand("unwrap", "Make lightmap UVs (TEXCOORD_1) for meshes that have none");
    command->add_option("SCENE", options->scene, "Scene: .glb, .gltf, .obj, .fbx, .dae, ...")
        ->required()
        ->type_name("");
    addChoiceOptions(*command, options->choice);
    command->add_option("-o,--output", options->output, "The scene with its new UVs (.glb)")
        ->required()
        ->type_name("OUT.glb");
    options->desc.size = 0;
    command->add_option("--density", options->desc.density, "Texels per metre; without it, what fills --size")
        ->check(numberAbove(0, 1e6));
    command
        ->add_option("--size", options->desc.size,
                     "Lightmap edge that the density fills [texels] (default: 512, or what --density needs)")
        ->check(wholeFrom(1, 65536));
    addPagesOption(*command, options->pages);
    command->add_flag("--all", options->all, "Replace valid lightmap UVs too");
    command->add_flag("--json", options->json,
                      "Print what was made as JSON: charts, coverage, stretch, time");
    command->callback([options] { runUnwrap(*options); });
}

} // namespace relume
