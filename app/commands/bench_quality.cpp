#include "app/bench/quality/quality_bench.h"
#include "app/commands/command.h"
#include "app/edit/choice_options.h"
#include "app/offline/bake_options.h"
#include "app/offline/command_files.h"
#include "app/text/interrupt.h"
#include "app/text/option_checks.h"
#include "assets/base/error.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"
#include "assets/foreign/load_scene.h"
#include "bake/links/link_solver.h"
#include "bake/trace/make_tracer.h"

#include <filesystem>
#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

namespace relume {
namespace {

struct BenchQualityOptions {
    QualityBenchDesc bench;
    std::string device, tracer = "auto", json, plot, plotRays;
    bool noPictures = false;
};

// Returns what somebody types to get this report again.
std::string commandOf(const BenchQualityOptions& o) {
    const QualityBenchDesc& b = o.bench;
    std::string text =
        fmt::format("relume bench quality {} --size {} --modes {} --error {:g} --local-error {:g} "
                    "--seconds {:g} --rays {:g} --reference-samples {} --batch-ms {:g} --tracer {}",
                    b.scene, b.size, fmt::join(b.modes, ","), b.error, b.localError, b.seconds, b.rays,
                    b.referenceSamples, b.batchMs, o.tracer);
    if (!b.reference.empty()) text += " --reference " + b.reference;
    if (o.noPictures) text += " --no-pictures";
    if (!o.device.empty()) text += " --device '" + o.device + "'";
    return text + typedChoice(b.choice);
}

// A reference that is there is read, and one that is missing is written.
void checkFiles(const BenchQualityOptions& o) {
    const std::string& reference = o.bench.reference;
    if (!reference.empty() && !reference.ends_with(".exr"))
        throw UsageError("--reference: '" + reference + "' does not end in .exr");
    if (o.noPictures && !o.bench.pictures.empty())
        throw UsageError("--pictures: says where pictures go, and --no-pictures that there are none");
    const bool there = std::filesystem::exists(reference);
    CommandFiles files;
    files.readsScene("SCENE", o.bench.scene)
        .writes("--json", o.json)
        .writes("--plot", o.plot)
        .writes("--plot-rays", o.plotRays);
    (there ? files.reads("--reference", reference) : files.writes("--reference", reference)).check();
    if (!o.json.empty() && o.json != "-") checkFileWritable(o.json, 0);
    for (const std::string& plot : {o.plot, o.plotRays})
        if (!plot.empty()) checkFileWritable(plot, 0);
    if (!reference.empty() && !there) checkFileWritable(reference, 0);
}

void runBench(BenchQualityOptions o) {
    const InterruptGuard guard;
    o.bench.tracer = parseTracerKind(o.tracer);
    o.bench.flip = !o.noPictures;
    checkFiles(o);
    loadScene(o.bench.scene, o.bench.choice); // a bad file leaves one line, its error
    const vk::Device device({.select = o.device});
    QualityReport report = benchQuality(device, o.bench, [](const QualityRun& run) {
        spdlog::info("{}: {} looks", run.mode, run.points.size());
    });
    report.command = commandOf(o);
    if (o.json != "-") {
        std::cout << fmt::format("device: {} ({})\ntracer: {}\nreference: {}\n", report.device, report.driver,
                                 report.tracer, report.reference);
        for (size_t i = 0; i < report.pictures.size(); ++i)
            std::cout << fmt::format("picture {}: {}\n", i + 1, report.pictures[i]);
        std::cout << qualityTable(report) << std::flush;
    }
    if (!o.plot.empty()) writeFileAtomically(o.plot, logLogPlotFile(qualityPlot(report, false)));
    if (!o.plotRays.empty()) writeFileAtomically(o.plotRays, logLogPlotFile(qualityPlot(report, true)));
    const std::string json =
        qualityJson(report).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    if (o.json == "-")
        std::cout << json << std::flush;
    else if (!o.json.empty())
        writeFileAtomically(o.json, json);
    if (report.interrupted) throw Error("interrupted: what was measured until then was written");
}

} // namespace

void addBenchQualityCommand(CLI::App& bench) {
    CLI::App* command = bench.add_subcommand(
        "quality", "How clean a bake is over time and rays, against a long one: also where it is dark");
    const auto options = std::make_shared<BenchQualityOptions>();
    QualityBenchDesc& b = options->bench;
    command->add_option("SCENE", b.scene, "glTF scene")->required()->type_name("");
    addChoiceOptions(*command, b.choice);
    command->add_option("--size", b.size, "Lightmap edge in texels")
        ->capture_default_str()
        ->check(wholeFrom(8, Baker::kMaxSize));
    command->add_option("--modes", b.modes, "Bakes that are measured: plain, layers, per-chunk, uniform")
        ->delimiter(',')
        ->capture_default_str()
        ->check(oneOf({"plain", "layers", "per-chunk", "uniform"}));
    command->add_option("--error", b.error, "At which a bake ends, relRMSE as it is told")
        ->capture_default_str()
        ->check(numberFrom(1e-6, 1.0));
    command->add_option("--local-error", b.localError, "And the local error, as it is told; 0: not asked for")
        ->capture_default_str()
        ->check(numberFrom(0.0, 1.0));
    command->add_option("--seconds", b.seconds, "End a bake after so much solver time")
        ->capture_default_str()
        ->check(numberAbove(0.0, 1e6));
    command->add_option("--rays", b.rays, "End a bake after so many rays (default: any number)")
        ->check(numberAbove(0.0, 1e18));
    command->add_option("--reference-samples", b.referenceSamples, "Directions per patch of the reference")
        ->capture_default_str()
        ->check(wholeFrom(1, LinkSolver::kMaxSamples));
    command
        ->add_option("--reference", b.reference,
                     "Lightmap that errors refer to; where it is missing, it is baked and written")
        ->type_name("FILE.exr");
    command->add_option("--pictures", b.pictures, "Write the pictures that FLIP compares to this folder");
    command->add_flag("--no-pictures", options->noPictures, "Draw no pictures: there is no FLIP");
    command->add_option("--batch-ms", b.batchMs, "Aim of one submit in milliseconds")
        ->capture_default_str()
        ->check(numberFrom(0.1, 45.0));
    command->add_option("--tracer", options->tracer, "What traces rays")
        ->capture_default_str()
        ->check(oneOf(tracerNames()));
    command->add_option("--device", options->device, "Vulkan device: index or part of its name");
    command->add_option("--json", options->json, "Write the results to this file, - for standard output");
    command->add_option("--plot", options->plot, "Write errors over time to this SVG file");
    command->add_option("--plot-rays", options->plotRays, "Write errors over rays to this SVG file");
    command->callback([options] { runBench(*options); });
}

} // namespace relume
