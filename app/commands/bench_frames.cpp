#include "app/bench/frames_bench.h"
#include "app/commands/command.h"
#include "app/edit/choice_options.h"
#include "app/offline/command_files.h"
#include "app/text/option_checks.h"
#include "app/viewer/shell/view_options.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"
#include "shaders/shader_library.h"

#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

namespace relume {
namespace {

struct BenchFramesOptions {
    FramesBenchDesc bench;
    std::string display = "auto", json;
};

nlohmann::ordered_json describe(const FramesPart& part) {
    return {{"seconds", part.seconds},
            {"frames", part.frames.size()},
            {"p50Ms", percentile(part.frames, 0.5)},
            {"p95Ms", percentile(part.frames, 0.95)},
            {"p99Ms", percentile(part.frames, 0.99)},
            {"raysPerSecond", part.raysPerSecond}};
}

void print(const FramesReport& report) {
    fmt::print("{:<20} {:>8} {:>8} {:>8} {:>8} {:>10} {:>8}\n", "", "frames/s", "p50 ms", "p95 ms", "p99 ms",
               "Mrays/s", "of alone");
    for (const FramesPart* part : {&report.alone, &report.bakeAlone, &report.moving, &report.still}) {
        std::string line = fmt::format("{:<20}", part->name);
        if (part->frames.empty())
            line += std::string(36, ' ');
        else
            line += fmt::format(" {:>8.1f} {:>8.2f} {:>8.2f} {:>8.2f}",
                                static_cast<double>(part->frames.size()) / part->seconds,
                                percentile(part->frames, 0.5), percentile(part->frames, 0.95),
                                percentile(part->frames, 0.99));
        if (part != &report.alone) line += fmt::format(" {:>10.1f}", 1e-6 * part->raysPerSecond);
        if (part != &report.alone && report.bakeAlone.raysPerSecond > 0)
            line += fmt::format(" {:>7.0f}%", 100.0 * part->raysPerSecond / report.bakeAlone.raysPerSecond);
        fmt::print("{}\n", line);
    }
}

void benchFrames(BenchFramesOptions o) {
    CommandFiles().readsScene("SCENE", o.bench.bake.files.scene).writes("--json", o.json).check();
    if (!o.json.empty() && o.json != "-") checkFileWritable(o.json, 0);
    if (!o.bench.bake.machine.shaders.empty()) setShaderFolder(o.bench.bake.machine.shaders);
    o.bench.display = displayModeOf(o.display);
    const FramesReport report = measureFrames(o.bench);
    if (o.json != "-") print(report);
    if (o.json.empty()) return;
    const nlohmann::ordered_json json = {{"version", RELUME_VERSION},
                                         {"scene", o.bench.bake.files.scene},
                                         {"size", o.bench.bake.patches.size},
                                         {"width", o.bench.width},
                                         {"height", o.bench.height},
                                         {"device", report.device},
                                         {"opengl", report.opengl},
                                         {"display", report.display},
                                         {"framesAlone", describe(report.alone)},
                                         {"bakeAlone", describe(report.bakeAlone)},
                                         {"cameraMoves", describe(report.moving)},
                                         {"cameraStill", describe(report.still)}};
    // A file name need not be UTF-8.
    const std::string text =
        json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    if (o.json == "-")
        std::cout << text << std::flush;
    else
        writeFileAtomically(o.json, text);
}

} // namespace

void addBenchFramesCommand(CLI::App& bench) {
    CLI::App* command = bench.add_subcommand(
        "frames", "Frame times while a scene is baked, and what drawing leaves of the bake's speed");
    const auto options = std::make_shared<BenchFramesOptions>();
    FramesBenchDesc& b = options->bench;
    command->add_option("SCENE", b.bake.files.scene, "glTF scene")->required()->type_name("");
    addChoiceOptions(*command, b.bake.files.choice);
    addSizeOption(*command, "--lightmap-size", b.bake);
    addSolverOptions(*command, b.bake);
    command->add_option("--width", b.width, "Of the pictures, in pixels")
        ->capture_default_str()
        ->check(wholeFrom(16, 16384));
    command->add_option("--height", b.height, "Of the pictures, in pixels")
        ->capture_default_str()
        ->check(wholeFrom(16, 16384));
    command->add_option("--seconds", b.seconds, "Of each part")
        ->capture_default_str()
        ->check(numberFrom(0.1, 600.0));
    command->add_option("--rate", b.rate, "Frames per second at most; 0: as many as there can be")
        ->capture_default_str()
        ->check(numberFrom(0.0, 1000.0));
    command->add_option("--budget", b.budget, "Aim of one batch of the bake in milliseconds")
        ->capture_default_str()
        ->check(numberFrom(0.1, 45.0));
    command->add_option("--msaa", b.samples, "Samples of each pixel")
        ->capture_default_str()
        ->check(oneOf({"0", "2", "4", "8"}));
    addDisplayOption(*command, options->display);
    command->add_option("--json", options->json, "Write the results to this file, - for standard output");
    command->callback([options] { benchFrames(*options); });
}

} // namespace relume
