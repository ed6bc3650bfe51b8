#include "app/bench/trace_bench.h"
#include "app/commands/command.h"
#include "app/commands/run_bake.h"
#include "app/edit/choice_options.h"
#include "app/edit/prepare.h"
#include "app/offline/bake_options.h"
#include "app/offline/command_files.h"
#include "app/text/option_checks.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"
#include "assets/base/passing_folder.h"
#include "assets/base/phase_clock.h"
#include "bake/links/link_solver.h"
#include "bake/trace/make_tracer.h"

#include <filesystem>
#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

namespace relume {
namespace {

struct BenchOptions {
    std::string scene, device, json;
    GltfChoice choice;
    std::vector<std::string> tracers;
    std::vector<uint32_t> sizes = {128, 256};
    TraceBenchDesc bench;
    bool whole = false;
    double error = 0;     // of a whole bake; 0: not given
    uint32_t samples = 0; // of a whole bake; 0: what the error needs
};

std::vector<TracerKind> tracersOf(const BenchOptions& o, const vk::DeviceInfo& info) {
    std::vector<TracerKind> kinds;
    for (const std::string& name : o.tracers) {
        std::string why;
        const TracerKind kind = parseTracerKind(name);
        kinds.push_back(kind == TracerKind::Auto ? chooseTracer(info, why) : kind);
    }
    if (!kinds.empty()) return kinds;
    for (TracerKind kind :
         {TracerKind::Rtp, TracerKind::Query, TracerKind::Bvh, TracerKind::Embree, TracerKind::Voxel}) {
        if (tracerProblem(kind, info).empty()) kinds.push_back(kind);
    }
    return kinds;
}

void writeReport(const std::string& path, const nlohmann::ordered_json& report) {
    // A file name need not be UTF-8.
    const std::string text =
        report.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    if (path == "-")
        std::cout << text << std::flush;
    else
        writeFileAtomically(path, text);
}

// Bakes the scene as `relume bake` does, into a folder for the time being, and tells how long each part took.
void benchWhole(const BenchOptions& o) {
    const PassingFolder folder(std::filesystem::temp_directory_path(), "relume_whole_");
    nlohmann::ordered_json results = nlohmann::ordered_json::array();
    double start = processSeconds();
    for (uint32_t size : o.sizes)
        for (const std::string& tracer : o.tracers.empty() ? std::vector<std::string>{"auto"} : o.tracers) {
            BakeOptions bake;
            bake.files.scene = o.scene;
            bake.files.choice = o.choice;
            bake.files.output = folder.file("lightmap.exr");
            bake.patches.size = size;
            bake.machine.device = o.device;
            bake.machine.tracer = tracer;
            bake.solve.error = o.error;
            bake.links.samples = o.samples;
            const WholeBake whole = runBake(bake, start);
            start = 0; // the first bake had it
            if (o.json != "-") std::cout << wholeTable(whole) << std::endl;
            results.push_back(wholeJson(whole));
        }
    if (!o.json.empty())
        writeReport(o.json, {{"version", RELUME_VERSION}, {"scene", o.scene}, {"whole", results}});
}

void benchTrace(const BenchOptions& o) {
    CommandFiles().readsScene("SCENE", o.scene).writes("--json", o.json).check();
    if (!o.json.empty() && o.json != "-") checkFileWritable(o.json, 0);
    if (o.whole) return benchWhole(o);
    std::vector<PreparedScene>
        scenes; // loaded before anything is printed: a bad file leaves one line, its error
    for (uint32_t size : o.sizes)
        scenes.push_back(prepareScene({.path = o.scene, .choice = o.choice, .size = size}));
    const vk::Device device({.select = o.device});
    fmt::print(stderr, "device: {} ({})\n", device.info().name, device.info().driver);
    const std::string row = "{:<8} {:>5} {:>8} {:>9} {:>12} {:>12} {:>10} {:>12} {:>12}\n";
    if (o.json != "-") {
        fmt::print(fmt::runtime(row), "tracer", "size", "patches", "triangles", "occlusion", "with gather",
                   "gather", "closest", "by tile");
        fmt::print(fmt::runtime(row), "", "", "", "", "Mrays/s", "Mrays/s", "Gpairs/s", "Mrays/s", "Mrays/s");
    }
    nlohmann::ordered_json results = nlohmann::ordered_json::array();
    for (size_t i = 0; i < scenes.size(); ++i) {
        PreparedScene& prepared = scenes[i];
        BakeSettings settings;
        settings.size = o.sizes[i];
        settings.solver.method = Method::Hybrid; // whose rays start all over their texels
        Baker baker(device, prepared.scene, std::move(prepared.mesh), settings);
        for (TracerKind kind : tracersOf(o, device.info())) {
            const TraceRates r = measureTracer(device, baker, kind, o.bench);
            const auto mega = [](double x) { return fmt::format("{:.2f}", x * 1e-6); };
            if (o.json != "-") {
                fmt::print(fmt::runtime(row), r.tracer, r.size, r.patches, r.triangles, mega(r.occlusion),
                           mega(r.occlusionGather), fmt::format("{:.2f}", r.gather * 1e-9),
                           mega(r.closestPatch), mega(r.closestTile));
                std::cout << std::flush;
            }
            results.push_back({{"tracer", r.tracer},
                               {"size", r.size},
                               {"patches", r.patches},
                               {"triangles", r.triangles},
                               {"occlusionRaysPerSecond", r.occlusion},
                               {"occlusionWithGatherRaysPerSecond", r.occlusionGather},
                               {"gatherPairsPerSecond", r.gather},
                               {"closestRaysPerSecond", r.closestPatch},
                               {"closestByTileRaysPerSecond", r.closestTile}});
        }
    }
    if (o.json.empty()) return;
    writeReport(o.json, {{"version", RELUME_VERSION},
                         {"scene", o.scene},
                         {"device", device.info().name},
                         {"driver", device.info().driver},
                         {"results", results}});
}

} // namespace

void addBenchCommand(CLI::App& app) {
    CLI::App* bench = app.add_subcommand("bench", "Measure speed");
    bench->require_subcommand(1);
    addBenchMethodsCommand(*bench);
    addBenchFramesCommand(*bench);
    addBenchEditsCommand(*bench);
    addBenchQualityCommand(*bench);
    addBenchReloadCommand(*bench);
    CLI::App* trace = bench->add_subcommand("trace", "Rays per second of every tracer's real kernels");
    auto options = std::make_shared<BenchOptions>();
    trace->add_option("SCENE", options->scene, "glTF scene")->required()->type_name("");
    addChoiceOptions(*trace, options->choice);
    trace->add_option("--sizes", options->sizes, "Lightmap edges")
        ->delimiter(',')
        ->capture_default_str()
        ->check(wholeFrom(8, Baker::kMaxSize));
    trace->add_option("--tracer", options->tracers, "Tracers to measure (default: all this device can run)")
        ->delimiter(',')
        ->check(oneOf(tracerNames()));
    trace->add_option("--device", options->device, "Vulkan device: index or part of its name");
    trace->add_option("--seconds", options->bench.seconds, "About how long each kernel runs")
        ->capture_default_str()
        ->check(numberFrom(0.1, 60.0));
    trace->add_option("--batch-ms", options->bench.batchMs, "Aim of one submit")
        ->capture_default_str()
        ->check(numberFrom(0.1, 45.0));
    CLI::Option* whole = trace->add_flag("--whole", options->whole,
                                         "Bake the scene instead, and tell how long each part of the whole "
                                         "process takes, from its start to the "
                                         "written lightmap");
    trace->add_option("--error", options->error, "With --whole: bake until the error is below this (0.01)")
        ->check(numberFrom(1e-6, 1.0))
        ->needs(whole);
    trace->add_option("--samples", options->samples, "With --whole: directions per patch, whatever the error")
        ->check(wholeFrom(1, LinkSolver::kMaxSamples))
        ->needs(whole);
    trace->add_option("--json", options->json, "Write the results to this file, - for standard output");
    trace->callback([options] { benchTrace(*options); });
}

} // namespace relume
