#include "app/bench/methods_bench.h"
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

#include <algorithm>
#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

namespace relume {
namespace {

struct BenchMethodsOptions {
    MethodsBenchDesc bench;
    std::vector<std::string> methods = {"pure",     "static",      "montecarlo", "mipmapped",
                                        "adaptive", "directional", "hybrid"};
    std::string device, tracer = "auto", cache = "auto", html, json;
    bool noSmooth = false;
};

CacheSettings::Kind parseCache(const std::string& name) {
    if (name == "none") return CacheSettings::Kind::None;
    if (name == "bits") return CacheSettings::Kind::Bits;
    return name == "links" ? CacheSettings::Kind::Links : CacheSettings::Kind::Auto;
}

template<typename T>
void sortUnique(std::vector<T>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

MethodsBenchDesc resolve(const BenchMethodsOptions& o) {
    MethodsBenchDesc desc = o.bench;
    sortUnique(desc.sizes);
    sortUnique(desc.windows);
    sortUnique(desc.nodes);
    sortUnique(desc.samples);
    sortUnique(desc.thresholds);
    for (const std::string& name : o.methods)
        desc.methods.push_back(parseMethod(name));
    // Pure goes first, because the others are compared with it.
    sortUnique(desc.methods);
    desc.tracer = parseTracerKind(o.tracer);
    desc.cache.kind = parseCache(o.cache);
    desc.smooth = !o.noSmooth;
    if (desc.pictureSize > 0 &&
        std::find(desc.sizes.begin(), desc.sizes.end(), desc.pictureSize) == desc.sizes.end())
        throw UsageError("--picture-size: " + std::to_string(desc.pictureSize) + " is none of --sizes");
    return desc;
}

template<typename T>
std::string joined(const std::vector<T>& values) {
    return fmt::format("{}", fmt::join(values, ","));
}

// Returns what somebody types to get this report again.
std::string commandOf(const BenchMethodsOptions& o, const MethodsBenchDesc& desc) {
    std::string text =
        fmt::format("relume bench methods {} --sizes {} --methods {} --windows {} --nodes {} --thresholds {} "
                    "--samples {} "
                    "--passes {} --reference-samples {} --max-seconds {:g} --tracer {} --cache {}",
                    o.bench.scene, joined(desc.sizes), joined(o.methods), joined(desc.windows),
                    joined(desc.nodes), joined(desc.thresholds), joined(desc.samples), desc.passes,
                    desc.referenceSamples, desc.maxSeconds, o.tracer, o.cache);
    if (o.noSmooth) text += " --no-smooth";
    if (!o.device.empty()) text += " --device '" + o.device + "'";
    return text + typedChoice(o.bench.choice) + " --html " + o.html;
}

void runBench(const BenchMethodsOptions& o) {
    const InterruptGuard guard;
    const MethodsBenchDesc desc = resolve(o);
    CommandFiles()
        .readsScene("SCENE", o.bench.scene)
        .writes("--html", o.html)
        .writes("--json", o.json)
        .check();
    checkFileWritable(o.html, 0);
    if (!o.json.empty() && o.json != "-") checkFileWritable(o.json, 0);
    const bool table = o.json != "-";
    loadScene(desc.scene, desc.choice); // a bad file leaves one line, its error
    const vk::Device device({.select = o.device});
    spdlog::info("device: {} ({})", device.info().name, device.info().driver);
    // The log is quieter, because what a bake tells of itself is the same for each of them.
    const auto level = spdlog::get_level();
    spdlog::set_level(std::max(level, spdlog::level::warn));
    bool headed = false;
    MethodsReport report = benchMethods(device, desc, [&](const MethodRun& run) {
        if (!table) return;
        if (!headed) std::cout << methodsTableHead();
        headed = true;
        std::cout << methodsTableRow(run) << std::flush;
    });
    spdlog::set_level(level);
    report.command = commandOf(o, desc);
    writeFileAtomically(o.html, methodsHtml(report));
    spdlog::info("wrote {}", o.html);
    if (o.json.empty()) return;
    const std::string json =
        methodsJson(report).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    if (table)
        writeFileAtomically(o.json, json);
    else
        std::cout << json << std::flush;
}

void addSweep(CLI::App& command, BenchMethodsOptions& o) {
    MethodsBenchDesc& bench = o.bench;
    bench.sizes = {64, 128, 256};
    bench.windows = {1, 2, 4, 8, 16};
    bench.samples = {16, 64, 256, 1024};
    command.add_option("--sizes", bench.sizes, "Lightmap edges")
        ->delimiter(',')
        ->capture_default_str()
        ->check(wholeFrom(8, Baker::kMaxSize));
    command.add_option("--methods", o.methods, "What to compare; DFPR needs pure among them")
        ->delimiter(',')
        ->capture_default_str()
        ->check(oneOf(methodNames()));
    command.add_option("--windows", bench.windows, "Windows of static, montecarlo and mipmapped")
        ->delimiter(',')
        ->capture_default_str()
        ->check(powerOfTwo(1, 32));
    command.add_option("--nodes", bench.nodes, "Nodes of adaptive")
        ->delimiter(',')
        ->capture_default_str()
        ->check(powerOfTwo(2, 64));
    command.add_option("--thresholds", bench.thresholds, "Thresholds of adaptive")
        ->delimiter(',')
        ->capture_default_str()
        ->check(numberFrom(0.0, 100.0));
    command.add_option("--samples", bench.samples, "Samples per patch of directional and hybrid")
        ->delimiter(',')
        ->capture_default_str()
        ->check(wholeFrom(1, LinkSolver::kMaxSamples));
}

} // namespace

void addBenchMethodsCommand(CLI::App& bench) {
    CLI::App* command = bench.add_subcommand(
        "methods", "Time and error of every method over sizes and settings, as a report");
    auto options = std::make_shared<BenchMethodsOptions>();
    BenchMethodsOptions& o = *options;
    command->add_option("SCENE", o.bench.scene, "glTF scene")->required()->type_name("");
    addChoiceOptions(*command, o.bench.choice);
    command->add_option("--html", o.html, "Report to write: one page with plots and pictures")->required();
    command->add_option("--json", o.json, "Write the figures to this file, - for standard output");
    addSweep(*command, o);
    command->add_option("--passes", o.bench.passes, "Passes (bounces) of every bake")
        ->capture_default_str()
        ->check(wholeFrom(1, Solver::kMaxPasses));
    command
        ->add_option("--reference-samples", o.bench.referenceSamples,
                     "Samples per patch of the reference, which is baked by hybrid")
        ->capture_default_str()
        ->check(wholeFrom(1, LinkSolver::kMaxSamples));
    command->add_option("--max-seconds", o.bench.maxSeconds, "Give a bake up after so much solver time")
        ->capture_default_str()
        ->check(numberAbove(0, 1e6));
    command
        ->add_option("--picture-size", o.bench.pictureSize,
                     "Show the lightmaps of this size, one of --sizes (default: the largest)")
        ->check(wholeFrom(8, Baker::kMaxSize));
    command->add_flag("--no-smooth", o.noSmooth, "Leave hybrid's indirect light as it is sampled");
    command->add_option("--cache", o.cache, "What later passes may keep: auto, none, bits or links")
        ->capture_default_str()
        ->check(oneOf({"auto", "none", "bits", "links"}));
    command->add_option("--tracer", o.tracer, "What traces rays")
        ->capture_default_str()
        ->check(oneOf(tracerNames()));
    command->add_option("--device", o.device, "Vulkan device: index or part of its name");
    command->callback([options] { runBench(*options); });
}

} // namespace relume
