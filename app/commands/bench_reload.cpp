#include "app/bench/reload_bench.h"
#include "app/commands/command.h"
#include "app/edit/choice_options.h"
#include "app/offline/bake_options.h"
#include "app/offline/command_files.h"
#include "app/text/interrupt.h"
#include "app/text/option_checks.h"
#include "assets/base/file_write.h"
#include "bake/links/link_solver.h"

#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

namespace relume {
namespace {

struct BenchReloadOptions {
    ReloadBenchDesc bench;
    std::string tracer = "auto", json;
};

void print(const ReloadReport& report) {
    fmt::print("device: {}\ntracer: {}\nlightmap: {}², {} patches, {} lamps\nreading the file: {:.1f} ms\n",
               report.device, report.tracer, report.size, report.patches, report.lamps,
               1e3 * report.readSeconds);
    fmt::print("{:<15} {:>10} {:>10} {:>8} {:>12} {:>12} {:>8}\n", "first picture", "file ms", "viewer ms",
               "ratio", "file rays", "viewer rays", "kept");
    for (const MeasuredReload& edit : report.edits)
        fmt::print("{:<15} {:>10.1f} {:>10.1f} {:>8.2f} {:>12} {:>12} {:>8}\n", edit.edit,
                   1e3 * edit.fileSeconds, 1e3 * edit.viewerSeconds,
                   edit.fileSeconds / (edit.viewerSeconds + report.readSeconds), edit.fileRays,
                   edit.viewerRays,
                   edit.layersAll > 0 ? fmt::format("{}/{}", edit.layersKept, edit.layersAll) : "");
    fmt::print("ratio: against the viewer's edit and reading the file; kept: layers of other lights that are "
               "the same to the bit\nthe bake began {} time{}\n",
               report.beginnings, report.beginnings == 1 ? "" : "s");
    if (report.difference)
        fmt::print("after {} random changes: relRMSE {:.2g} against a fresh bake\n", report.changes,
                   *report.difference);
    std::cout << std::flush;
}

nlohmann::ordered_json describe(const ReloadReport& report) {
    nlohmann::ordered_json json = {{"version", RELUME_VERSION},
                                   {"scene", report.scene},
                                   {"device", report.device},
                                   {"tracer", report.tracer},
                                   {"size", report.size},
                                   {"patches", report.patches},
                                   {"lamps", report.lamps},
                                   {"readSeconds", report.readSeconds},
                                   {"beginnings", report.beginnings}};
    for (const MeasuredReload& edit : report.edits)
        json["edits"].push_back({{"edit", edit.edit},
                                 {"fileSeconds", edit.fileSeconds},
                                 {"viewerSeconds", edit.viewerSeconds},
                                 {"fileRays", edit.fileRays},
                                 {"viewerRays", edit.viewerRays},
                                 {"otherLayersKept", edit.layersKept},
                                 {"otherLayers", edit.layersAll}});
    json["randomChanges"] = report.changes;
    json["differenceFromFresh"] = report.difference ? nlohmann::ordered_json(*report.difference) : nullptr;
    return json;
}

void runBench(BenchReloadOptions o) {
    const InterruptGuard guard;
    o.bench.tracer = parseTracerKind(o.tracer);
    CommandFiles().readsScene("SCENE", o.bench.scene).writes("--json", o.json).check();
    if (!o.json.empty() && o.json != "-") checkFileWritable(o.json, 0);
    const ReloadReport report = benchReload(o.bench);
    if (o.json != "-") print(report);
    if (o.json.empty()) return;
    // A file name need not be UTF-8.
    const std::string text =
        describe(report).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    if (o.json == "-")
        std::cout << text << std::flush;
    else
        writeFileAtomically(o.json, text);
}

} // namespace

void addBenchReloadCommand(CLI::App& bench) {
    CLI::App* command = bench.add_subcommand(
        "reload", "What it costs when another program writes the scene's file, against edits in the viewer");
    const auto options = std::make_shared<BenchReloadOptions>();
    ReloadBenchDesc& b = options->bench;
    command->add_option("SCENE", b.scene, "glTF scene; a copy of it is edited")->required()->type_name("");
    addChoiceOptions(*command, b.choice);
    command->add_option("--lights", b.lamps, "How many lamps light the scene, alone")
        ->capture_default_str()
        ->check(wholeFrom(1, 1024));
    command->add_option("--size", b.size, "Lightmap edge in texels")
        ->capture_default_str()
        ->check(wholeFrom(8, Baker::kMaxSize));
    CLI::Option* error =
        command->add_option("--error", b.error, "That the bake is to reach, relRMSE as it is told")
            ->capture_default_str()
            ->check(numberFrom(1e-4, 1.0));
    command->add_option("--samples", b.samples, "Take so many directions per patch instead")
        ->check(wholeFrom(1, LinkSolver::kMaxSamples))
        ->excludes(error);
    command->add_option("--runs", b.runs, "Of each edit; medians are told")
        ->capture_default_str()
        ->check(wholeFrom(1, 100));
    command
        ->add_option(
            "--changes", b.changes,
            "So many random changes, one file after another; then the light is compared with a fresh bake")
        ->capture_default_str()
        ->check(wholeFrom(0, 100000));
    command->add_option("--batch-ms", b.batchMs, "Aim of one submit in milliseconds")
        ->capture_default_str()
        ->check(numberFrom(0.1, 45.0));
    command->add_option("--tracer", options->tracer, "What traces rays")
        ->capture_default_str()
        ->check(oneOf(tracerNames()));
    command->add_option("--device", b.device, "Vulkan device: index or part of its name");
    command->add_option("--json", options->json, "Write the results to this file, - for standard output");
    command->callback([options] { runBench(*options); });
}

} // namespace relume
