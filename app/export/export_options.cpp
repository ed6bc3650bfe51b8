#include "app/export/export_options.h"

#include "app/text/option_checks.h"
#include "app/text/typed_numbers.h"
#include "assets/base/error.h"

#include <CLI/CLI.hpp>

namespace relume {

void addExportOptions(CLI::App& command, ExportOptions& options) {
    command.add_option("-o,--output", options.folder, "Folder to write; it is made where it is missing")
        ->type_name("FOLDER");
    command
        .add_option("--for", options.engine,
                    "Who shows it: any (plain glTF, the light as emission), three (three.js), babylon, "
                    "playcanvas, bevy, godot, unity, blender")
        ->check(oneOf(engineNames()));
    command.add_option("--exposure", options.exposure, "EV that the engine's files ask for, or auto")
        ->capture_default_str();
    command
        .add_option("--texture-format", options.format,
                    "Of lightmap.ktx2: half (RGBA16F) or shared (RGB9E5, half as large; not for babylon and "
                    "playcanvas)")
        ->capture_default_str()
        ->check(oneOf({"half", "shared"}));
    command
        .add_option("--texture-size", options.textureSize,
                    "With --for any: edge of the texture that holds the light [texels] (default: the "
                    "lightmap's, four times that where surfaces have pictures)")
        ->check(wholeFrom(16, 8192));
    command.add_flag("--gloss", options.gloss,
                     "Keep highlights: engines then show less of the lightmap, by what a highlight reflects");
}

ExportDesc resolveExportOptions(const ExportOptions& options) {
    if (options.engine.empty() || options.folder.empty())
        throw UsageError("export: say for whom and where: --for ENGINE -o FOLDER, or --web OUT for a page");
    ExportDesc desc;
    desc.engine = engineOf(options.engine);
    desc.folder = options.folder;
    while (desc.folder.size() > 1 && desc.folder.ends_with('/'))
        desc.folder.pop_back();
    desc.gloss = options.gloss;
    desc.textureSize = options.textureSize;
    desc.format = options.format == "shared" ? Ktx2Format::SharedExponent : Ktx2Format::Half;
    desc.exposure = typedExposure(options.exposure);
    if (options.textureSize > 0 && desc.engine != Engine::Any)
        throw UsageError("--texture-size: only --for any has such a texture: leave it out");
    if (desc.format == Ktx2Format::SharedExponent &&
        (desc.engine == Engine::Babylon || desc.engine == Engine::PlayCanvas))
        throw UsageError("--texture-format shared: the loader for " + options.engine +
                         " reads half floats: leave it out");
    return desc;
}

} // namespace relume
