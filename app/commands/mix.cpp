#include "app/commands/command.h"
#include "app/offline/command_files.h"
#include "app/offline/compression_option.h"
#include "app/offline/layer_join.h"
#include "app/offline/light_mix.h"
#include "app/offline/probe_files.h"
#include "assets/base/error.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"
#include "assets/base/warnings.h"
#include "assets/images/finite_image.h"
#include "assets/images/paged_image.h"

#include <cstdio>
#include <memory>
#include <optional>

namespace relume {
namespace {

struct MixOptions {
    std::vector<std::string> layers;
    std::string output, compression, probesIn, probesOut;
    std::vector<std::string> sets, muted, solo;
    bool list = false, layersOut = false, half = false, join = false;

    bool writesLayers() const { return layersOut || join; }
    ExrType type() const { return half ? ExrType::Half : ExrType::Float; }
};

MixDesc resolve(const MixOptions& options) {
    if (options.output.empty() && options.probesOut.empty() && !options.list)
        throw UsageError("mix: nothing to do: give -o FILE.exr or .png, --probes-out FILE, or --list");
    if (options.probesIn.empty() && !options.probesOut.empty())
        throw UsageError("--probes-out: there are no probes to weigh: add --probes-in FILE.json");
    if (!options.probesIn.empty() && options.probesOut.empty())
        throw UsageError("--probes-in: nothing says where the weighed probes go: add --probes-out FILE");
    if (!options.probesOut.empty()) probeFormOf("--probes-out", options.probesOut);
    if (options.layersOut && !options.output.ends_with(".exr"))
        throw UsageError("--layers-out: layers are kept in OpenEXR only: give -o a name that ends in .exr");
    checkCompression(options.compression, {options.output});
    if (options.join && !options.output.empty() && !options.output.ends_with(".exr"))
        throw UsageError("--join: layers are kept in OpenEXR only: give -o a name that ends in .exr");
    if (!options.join && options.layers.size() > 1)
        throw UsageError(fmt::format("mix: {} files: name one, or add --join to put their layers into one",
                                     options.layers.size()));
    MixDesc desc;
    for (const std::string& text : options.sets) {
        try {
            desc.edits.push_back(weightEditOf(text));
        } catch (const UsageError& error) {
            throw UsageError("--set '" + text + "': " + error.what());
        }
    }
    desc.muted = options.muted;
    desc.solo = options.solo;
    return desc;
}

std::string attribute(const LayeredImage::Layer& layer, const char* name) {
    const auto found = layer.attributes.find(name);
    return found == layer.attributes.end() ? "" : found->second;
}

void printList(const LayeredImage& image) {
    std::printf("%-24s %-12s %12s %-7s %-24s %s\n", "light", "type", "intensity", "", "colour", "");
    for (const LayeredImage::Layer& layer : image.layers) {
        const glm::vec3 color = colorOf(layer);
        const std::string stale = attribute(layer, layer_attribute::kStale);
        std::string state;
        const auto add = [&](const std::string& text) { state += (state.empty() ? "" : ", ") + text; };
        if (const size_t members = membersOf(layer).size(); members > 0)
            add(fmt::format("{} lights", members));
        if (layer.weight == glm::vec3(0.0f)) add("off");
        if (!stale.empty()) add("stale: " + stale);
        std::printf("%-24s %-12s %12.6g %-7s %-24s %s\n", layer.name.c_str(),
                    attribute(layer, layer_attribute::kType).c_str(), double(intensityOf(layer)),
                    attribute(layer, layer_attribute::kUnit).c_str(),
                    fmt::format("{:.4g},{:.4g},{:.4g}", color.r, color.g, color.b).c_str(), state.c_str());
    }
}

// Reads the layers, of all files where they are to be joined.
LayeredImage readLayers(const MixOptions& options) {
    std::vector<LayerFile> files;
    for (const std::string& path : options.layers)
        files.push_back({path, readLayeredLightmap(path)});
    LayeredImage image = joinLayers(std::move(files));
    if (!options.join) return image;
    const std::vector<std::string> missing = missingLights(image);
    std::string names;
    for (const std::string& name : missing)
        names += (names.empty() ? "" : ", ") + inQuotes(name);
    if (!missing.empty())
        spdlog::warn("{} lights of the scene are in none of the files: {}: join the result with theirs",
                     missing.size(), names);
    return image;
}

ProbeSet weighedProbes(const MixOptions& options, const LayeredImage& image) {
    ProbeSet probes = readProbes(options.probesIn);
    try {
        weighLike(probes, image);
    } catch (const Error& error) {
        throw Error(options.probesIn + ": " + error.what());
    }
    return probes;
}

void writeSum(const MixOptions& options, const LayeredImage& image) {
    requireFinite(image.composite, options.output);
    const ExrCompression compression = compressionOf(options.compression);
    if (options.writesLayers())
        writeLayeredLightmap(options.output, image, options.type(), compression);
    else
        writeLightmap(options.output, image.composite, options.type(), compression);
    spdlog::info("wrote {}: {} lights", options.output, image.layers.size());
}

void runMix(const MixOptions& options) {
    const MixDesc desc = resolve(options);
    CommandFiles files;
    for (const std::string& path : options.layers)
        files.readsLightmap("LAYERS", path);
    files.reads("--probes-in", options.probesIn)
        .writes("--output", options.output)
        .writes("--probes-out", options.probesOut)
        .check();
    if (!options.output.empty()) checkWritable(options.output);
    if (!options.probesOut.empty()) checkFileWritable(options.probesOut, 0);
    LayeredImage image = readLayers(options);
    const std::string& first = options.layers.front();
    if (options.writesLayers() && !options.output.empty()) roundLayers(options.output, image, options.type());
    try {
        mixLayers(image, desc);
    } catch (const UsageError&) {
        throw;
    } catch (const Error& error) {
        throw Error(first + ": " + error.what());
    }
    if (options.list) printList(image);
    // Both are made before either is written.
    std::optional<ProbeSet> probes;
    if (!options.probesIn.empty()) probes = weighedProbes(options, image);
    if (options.output.empty() && !probes) return;
    for (const LayeredImage::Layer& layer : image.layers) {
        const std::string stale = attribute(layer, layer_attribute::kStale);
        if (!stale.empty() && layer.weight != glm::vec3(0.0f))
            spdlog::warn("{}: stale: {}: bake it again", first, stale);
    }
    if (!options.output.empty()) writeSum(options, image);
    if (probes) writeProbes(options.probesOut, *probes);
}

} // namespace

void addMixCommand(CLI::App& app) {
    const auto options = std::make_shared<MixOptions>();
    CLI::App* command = app.add_subcommand(
        "mix", "Weigh the lights of a lightmap anew, without a bake: intensity, colour, on/off");
    command
        ->add_option("layers", options->layers,
                     "OpenEXR file that 'relume bake --layers' wrote; with --join several")
        ->required()
        ->type_name("LAYERS.exr");
    command->add_flag(
        "--join", options->join,
        "Put the layers of several files into one that has the bytes of one bake: those of 'relume "
        "bake --layers --lights', each with other lights");
    command->add_option("-o,--output", options->output, "The sum, .exr or .png")->type_name("FILE");
    const auto names = [&](const char* option, std::vector<std::string>& to, const char* help) {
        return command->add_option(option, to, help)
            ->expected(1)
            ->allow_extra_args(false)
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    };
    names("--set", options->sets,
          "Another intensity, in the light's unit, and colour: #rrggbb (sRGB) or linear r,g,b; NAME*=FACTOR "
          "scales the intensity")
        ->type_name("NAME=INTENSITY[,COLOR]");
    names("--mute", options->muted, "Turn this light off")->type_name("NAME");
    names("--solo", options->solo, "Only this light, and others with --solo")->type_name("NAME");
    command
        ->add_option("--probes-in", options->probesIn,
                     "Light probes of the same bake, by 'relume bake --layers --probes', to be weighed alike")
        ->type_name("PROBES.json");
    command->add_option("--probes-out", options->probesOut, "The weighed probes, .json, .three.json or .ktx2")
        ->type_name("FILE");
    command->add_flag("--list", options->list, "Print the lights, as they are mixed");
    command->add_flag("--layers-out", options->layersOut, "Write the layers too, with their new weights");
    command->add_flag("--half", options->half, "16-bit floats in an .exr");
    addCompressionOption(*command, options->compression);
    command->callback([options] { runMix(*options); });
}

} // namespace relume
