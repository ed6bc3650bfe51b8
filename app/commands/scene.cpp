#include "app/commands/command.h"

#include "app/text/option_checks.h"
#include "assets/base/error.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"
#include "assets/generate/generate.h"
#include "assets/generate/finer.h"
#include "assets/gltf/gltf.h"

#include <iostream>
#include <memory>

namespace relume {
namespace {

struct SceneOptions {
    std::string name, output;
    bool list = false;
    uint32_t split = 1;
};

void listScenes() {
    for (const SceneName& scene : generatedSceneNames())
        std::cout << scene.name << std::string(16 - scene.name.size(), ' ') << scene.description << "\n";
}

void makeScene(const SceneOptions& options) {
    if (options.list) {
        listScenes();
        return;
    }
    if (options.name.empty()) throw UsageError("scene: which one? 'relume scene --list' shows the names");
    if (options.output.empty()) throw UsageError("scene: where to? Pass -o FILE.glb");
    if (!options.output.ends_with(".glb"))
        throw UsageError("scene: '" + options.output +
                         "' does not end in .glb: scenes are written as binary glTF");
    checkFileWritable(options.output, 0);
    Scene scene = generateScene(options.name);
    splitTriangles(scene, options.split);
    saveGlb(scene, options.output);
    size_t triangles = 0;
    for (const Mesh& mesh : scene.meshes)
        for (const Primitive& primitive : mesh.primitives)
            triangles += primitive.indices.size() / 3;
    spdlog::info("{}: {} triangles in {} meshes", options.output, triangles, scene.meshes.size());
}

} // namespace

void addSceneCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand("scene", "Make one of the scenes that ship with Relume");
    auto options = std::make_shared<SceneOptions>();
    command->add_option("name", options->name, "The scene, see --list");
    command->add_option("-o,--output", options->output, "The file to write (.glb)");
    command->add_flag("-l,--list", options->list, "List the scenes and stop");
    command
        ->add_option("--split", options->split,
                     "Split each triangle into N * N ones: a level that looks the same and is as large as "
                     "one would like to try")
        ->type_name("N")
        ->check(wholeFrom(1, kMostParts));
    command->callback([options] { makeScene(*options); });
}

} // namespace relume
