#include "app/command.h"
#include "app/edit_options.h"
#include "assets/error.h"
#include "assets/file_write.h"
#include "assets/gltf.h"
#include "assets/gltf_edit.h"
#include "assets/log.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

namespace relume {
namespace {

struct EditOptions {
    std::string scene, output;
};

void runEdit(const EditOptions& options, const std::vector<TypedEdit>& typed) {
    if (typed.empty())
        throw UsageError("edit: no edit is given: add --set, --move, --add, --delete or another one");
    std::error_code code; // a missing scene is told by who reads it
    const auto bytes = std::filesystem::file_size(options.scene, code);
    checkFileWritable(options.output, code ? 0 : bytes);
    const Scene before = loadGltf(options.scene);
    for (const std::string& warning : before.warnings)
        spdlog::warn("{}", warning);
    SceneEdits edits = editsOf(before);
    const std::vector<std::string> done = applyEdits(before, typed, edits);
    const auto isHidden = [](const Placement& placement) { return placement.hidden; };
    if (std::any_of(edits.placements.begin(), edits.placements.end(), isHidden))
        spdlog::warn("{}: a glTF file cannot say that an object is hidden: it is shown when it is read again",
                     options.output);
    Scene after = partsOfEdits(before);
    applyEdits(after, edits);
    saveEditedGltf(options.scene, before, after, options.output);
    for (const std::string& line : done)
        std::printf("%s\n", line.c_str());
    spdlog::info("wrote {}", options.output);
}

} // namespace

void addEditCommand(CLI::App& app) {
    const auto options = std::make_shared<EditOptions>();
    CLI::App* command =
        app.add_subcommand("edit", "Edit lights, materials, the sky and where objects are; all else in the "
                                   "file stays as it is");
    command->add_option("scene", options->scene, "glTF 2.0 file (.gltf or .glb)")
        ->required()
        ->type_name("SCENE");
    command
        ->add_option("-o,--output", options->output,
                     "The edited scene, of the ending that SCENE has; may be SCENE itself")
        ->required()
        ->type_name("OUT");
    addEditOptions(*command);
    command->footer("NAME is what `relume info` calls a light, or an object or a material of the file; a "
                    "second \"Lamp\" is\n"
                    "\"Lamp 2\". Where a light, an object and a material share a name: light:NAME, "
                    "object:NAME, material:NAME.");
    command->callback([options, command] { runEdit(*options, typedEdits(*command)); });
}

} // namespace relume
