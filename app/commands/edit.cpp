#include "app/commands/command.h"
#include "app/edit/choice_options.h"
#include "app/edit/edit_options.h"
#include "app/offline/bake_edits.h"
#include "app/offline/command_files.h"
#include "app/offline/compression_option.h"
#include "app/text/option_checks.h"
#include "assets/base/error.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"
#include "assets/foreign/foreign_files.h"
#include "assets/foreign/load_scene.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "bake/links/link_solver.h"
#include "shaders/shader_library.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

namespace relume {
namespace {

struct EditOptions {
    std::string scene, output;
    BakeOptions bake; // files.output "": none
};

// Returns the options of the bake, with layers where the file can hold them. Contradictions are told before
// anything is written.
BakeOptions bakeOptionsOf(const EditOptions& options) {
    BakeOptions bake = options.bake;
    bake.files.scene = options.scene;
    bake.layers.on = bake.files.output.ends_with(".exr");
    if (!bake.layers.on && !bake.layers.memory.empty())
        throw UsageError("--layer-memory: '" + bake.files.output + "' holds no layers: end its name in .exr");
    resolveBakeOptions(bake);
    return bake;
}

// Adds the options of the baked lightmap alone.
void addOptionsOfBake(CLI::App& command, BakeOptions& bake) {
    CLI::Option* output =
        command
            .add_option("--bake", bake.files.output,
                        "Bake the edited scene into this lightmap, .exr (light by light, for `relume mix`) "
                        "or .png; what follows is of it")
            ->type_name("OUT");
    const std::vector<CLI::Option*> before = command.get_options();
    addSizeOption(command, "--size", bake);
    command.add_option("--error", bake.solve.error, "Stop when the remaining error is below this (0.01)")
        ->check(numberFrom(1e-6, 1.0));
    command.add_option("--samples", bake.links.samples, "Directions per patch, whatever the error")
        ->check(wholeFrom(1, LinkSolver::kMaxSamples));
    addMachineOptions(command, bake);
    addLayerMemory(command, bake);
    addCompressionOption(command, bake.files.compression);
    for (CLI::Option* option : command.get_options())
        if (std::find(before.begin(), before.end(), option) == before.end()) option->needs(output);
}

std::vector<Setting> settingsOf(const SceneEdit& edit) {
    if (const auto* set = std::get_if<SetEdit>(&edit)) return {set->setting};
    if (const auto* light = std::get_if<AddLightEdit>(&edit)) return light->settings;
    if (const auto* sky = std::get_if<AddSkyEdit>(&edit)) return sky->settings;
    return {};
}

// Checks the files. Pictures that edits give the sky are read by --bake.
void checkFiles(const EditOptions& options, const std::vector<TypedEdit>& typed) {
    CommandFiles files;
    files.readsScene("SCENE", options.scene).writes("--output", options.output).mayBe("--output", "SCENE");
    files.writes("--bake", options.bake.files.output);
    for (const TypedEdit& edit : typed)
        for (const Setting& setting : settingsOf(edit.edit))
            if (setting.property == Property::File)
                files.reads(edit.option, std::get<std::string>(setting.value));
    files.check();
}

void runEdit(const EditOptions& options, const std::vector<TypedEdit>& typed) {
    const bool nothing = options.output.empty() && options.bake.files.output.empty();
    if (nothing && isForeign(options.scene))
        throw UsageError(
            fmt::format("{}: is no glTF file, so edits are saved into a new one: give -o OUT.glb, or "
                        "make it with 'relume import {} -o OUT.glb' first",
                        options.scene, options.scene));
    if (nothing)
        throw UsageError(
            "edit: nothing to do: give -o for the edited scene, --bake for its lightmap, or both");
    const bool bakes = !options.bake.files.output.empty();
    const BakeOptions bake = bakes ? bakeOptionsOf(options) : BakeOptions{};
    if (typed.empty())
        throw UsageError("edit: no edit is given: add --set, --move, --add, --delete or another one");
    checkFiles(options, typed);
    if (!options.output.empty()) requireSavable(options.scene, options.output);
    std::error_code code; // the reader tells of a missing scene
    const auto bytes = std::filesystem::file_size(options.scene, code);
    if (!options.output.empty()) checkFileWritable(options.output, code ? 0 : bytes);
    if (bakes) checkWritable(bake.files.output);
    if (!bake.machine.shaders.empty()) setShaderFolder(bake.machine.shaders);
    const Scene before = loadScene(options.scene, options.bake.files.choice);
    for (const std::string& warning : before.warnings)
        spdlog::warn("{}", warning);
    SceneEdits edits = editsOf(before);
    const std::vector<std::string> done = applyEdits(before, typed, edits);
    Scene after = partsOfEdits(before);
    applyEdits(after, edits);
    if (!options.output.empty()) {
        saveEditedScene(options.scene, before, after, options.output);
        spdlog::info("wrote {}", options.output);
    }
    for (const std::string& line : done)
        std::printf("%s\n", line.c_str());
    if (bakes) bakeEdited(bake, edits);
}

} // namespace

void addEditCommand(CLI::App& app) {
    const auto options = std::make_shared<EditOptions>();
    CLI::App* command =
        app.add_subcommand("edit", "Edit lights, materials, the sky and where objects are; all else in the "
                                   "file stays as it is");
    command->add_option("SCENE", options->scene, "Scene: .glb, .gltf, .obj, .fbx, .dae, ...")
        ->required()
        ->type_name("");
    addChoiceOptions(*command, options->bake.files.choice);
    command
        ->add_option("-o,--output", options->output,
                     "The edited scene, of the ending that SCENE has; may be SCENE itself")
        ->type_name("OUT");
    addEditOptions(*command);
    addOptionsOfBake(*command, options->bake);
    command->footer("NAME is what `relume info` calls a light, or an object or a material of the file; a "
                    "second \"Lamp\" is\n"
                    "\"Lamp 2\". Where a light, an object and a material share a name: light:NAME, "
                    "object:NAME, material:NAME.");
    command->callback([options, command] { runEdit(*options, typedEdits(*command)); });
}

} // namespace relume
