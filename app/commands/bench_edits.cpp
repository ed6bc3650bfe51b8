#include "app/bench/edits_bench.h"
#include "app/commands/command.h"
#include "app/edit/choice_options.h"
#include "app/offline/bake_options.h"
#include "app/offline/command_files.h"
#include "app/text/interrupt.h"
#include "app/text/option_checks.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"
#include "bake/links/link_solver.h"
#include "bake/trace/make_tracer.h"

#include <algorithm>
#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

namespace relume {
namespace {

struct BenchEditsOptions {
    EditsBenchDesc bench;
    std::string device, tracer = "auto", json, plot;
};

// Returns what somebody types to get this report again.
std::string commandOf(const BenchEditsOptions& o) {
    const EditsBenchDesc& b = o.bench;
    std::string text = fmt::format("relume bench edits {} --lights {} --size {} --error {:g} --samples {} "
                                   "--reference-samples {} --runs {} --batch-ms {:g} --tracer {}",
                                   b.scene, fmt::join(b.lamps, ","), b.size, b.error, b.samples,
                                   b.referenceSamples, b.runs, b.batchMs, o.tracer);
    if (!b.onlyLamps) text += " --all-lights";
    if (!o.device.empty()) text += " --device '" + o.device + "'";
    return text + typedChoice(b.choice);
}

void runBench(BenchEditsOptions o) {
    const InterruptGuard guard;
    o.bench.tracer = parseTracerKind(o.tracer);
    std::sort(o.bench.lamps.begin(), o.bench.lamps.end());
    o.bench.lamps.erase(std::unique(o.bench.lamps.begin(), o.bench.lamps.end()), o.bench.lamps.end());
    CommandFiles()
        .readsScene("SCENE", o.bench.scene)
        .writes("--json", o.json)
        .writes("--plot", o.plot)
        .writes("--write-scene", o.bench.sceneOutput)
        .check();
    if (!o.json.empty() && o.json != "-") checkFileWritable(o.json, 0);
    if (!o.plot.empty()) checkFileWritable(o.plot, 0);
    if (!o.bench.sceneOutput.empty()) checkFileWritable(o.bench.sceneOutput, 0);
    const vk::Device device({.select = o.device});
    EditsReport report =
        benchEdits(device, o.bench, [](const EditsRun& run) { spdlog::info("{} lamps: done", run.lamps); });
    report.command = commandOf(o);
    if (o.json != "-") {
        std::cout << fmt::format("device: {} ({})\ntracer: {}\nlightmap: {}², {} patches\nlamps: {}\n",
                                 report.device, report.driver, report.tracer, report.size, report.patches,
                                 report.placement);
        std::cout << (report.onlyLamps ? "materials and sky of the scene do not shine\n"
                                       : "materials and sky of the scene shine as well\n")
                  << editsTable(report) << std::flush;
    }
    if (!o.plot.empty()) writeFileAtomically(o.plot, logLogPlotFile(editsPlot(report)));
    if (o.json.empty()) return;
    const std::string json =
        editsJson(report).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    if (o.json == "-")
        std::cout << json << std::flush;
    else
        writeFileAtomically(o.json, json);
}

} // namespace

void addBenchEditsCommand(CLI::App& bench) {
    CLI::App* command = bench.add_subcommand(
        "edits", "What edits of lights and colours cost in a baked scene, against baking it anew");
    const auto options = std::make_shared<BenchEditsOptions>();
    EditsBenchDesc& b = options->bench;
    command->add_option("SCENE", b.scene, "glTF scene")->required()->type_name("");
    addChoiceOptions(*command, b.choice);
    command->add_option("--lights", b.lamps, "Numbers of lamps; as many are added as the scene has too few")
        ->delimiter(',')
        ->capture_default_str()
        ->check(wholeFrom(1, 1024));
    command
        ->add_flag("--only-lamps,!--all-lights", b.onlyLamps,
                   "Materials and sky of the scene do not shine (default), or do as well")
        ->default_str("true");
    command->add_option("--size", b.size, "Lightmap edge in texels")
        ->capture_default_str()
        ->check(wholeFrom(8, Baker::kMaxSize));
    command->add_option("--error", b.error, "That every light is to reach, relRMSE as it is told")
        ->capture_default_str()
        ->check(numberFrom(1e-4, 1.0));
    command
        ->add_option("--samples", b.samples,
                     "Directions per patch where the sum of layers is compared with fresh bakes")
        ->capture_default_str()
        ->check(wholeFrom(1, LinkSolver::kMaxSamples));
    command
        ->add_option("--reference-samples", b.referenceSamples,
                     "Directions per patch of the bakes that errors refer to")
        ->capture_default_str()
        ->check(wholeFrom(1, LinkSolver::kMaxSamples));
    command->add_option("--runs", b.runs, "Of each edit and fresh bake; medians are told")
        ->capture_default_str()
        ->check(wholeFrom(1, 100));
    command->add_option("--batch-ms", b.batchMs, "Aim of one submit in milliseconds")
        ->capture_default_str()
        ->check(numberFrom(0.1, 45.0));
    command->add_option("--tracer", options->tracer, "What traces rays")
        ->capture_default_str()
        ->check(oneOf(tracerNames()));
    command
        ->add_option(
            "--write-scene", b.sceneOutput,
            "Write the scene after the move, with the most lamps, to this file of the scene's ending")
        ->type_name("OUT");
    command->add_option("--device", options->device, "Vulkan device: index or part of its name");
    command->add_option("--json", options->json, "Write the results to this file, - for standard output");
    command->add_option("--plot", options->plot, "Write error over time after a move to this SVG file");
    command->callback([options] { runBench(*options); });
}

} // namespace relume
