#include "app/offline/pair_options.h"

#include "app/text/option_checks.h"
#include "app/text/typed_numbers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <limits>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace relume {
namespace {

constexpr uint32_t kMaxWindow = 32, kMinNode = 2, kMaxNode = 64; // [texels]
constexpr uint32_t kDefaultWindow = 2;
constexpr double kMaxThreshold = 1e6, kMaxRamp = 10;

CacheSettings::Kind parseCache(const std::string& name, Method method) {
    if (name == "none") return CacheSettings::Kind::None;
    if (name == "auto") return CacheSettings::Kind::Auto;
    if (name == "bits" && !isPairMethod(method))
        throw UsageError(
            fmt::format("--cache bits: --method {} keeps links: use links or auto", methodName(method)));
    if (name == "links" && isPairMethod(method))
        throw UsageError(
            fmt::format("--cache links: --method {} keeps bits: use bits or auto", methodName(method)));
    return name == "bits" ? CacheSettings::Kind::Bits : CacheSettings::Kind::Links;
}

} // namespace

bool hasWindow(Method method) {
    return method == Method::Static || method == Method::MonteCarlo || method == Method::Mipmapped;
}

void addPairOptions(CLI::App& command, PairOptions& o) {
    command
        .add_option("--window", o.window,
                    "Methods static, montecarlo, mipmapped: texels along a window (default 2)")
        ->check(powerOfTwo(1, kMaxWindow));
    command
        .add_option("--threshold", o.threshold,
                    "Method adaptive: difference up to which nodes are merged, relative to the mean light "
                    "(default 0.05; preset rtrad: absolute)")
        ->check(numberFrom(0, kMaxThreshold));
    command.add_option("--node", o.node, "Method adaptive: texels along the largest node (default 8)")
        ->check(powerOfTwo(kMinNode, kMaxNode));
    command
        .add_option("--threshold-ramp", o.thresholdRamp,
                    "Method adaptive: factor on the threshold from pass to pass (default 1)")
        ->check(numberAbove(0, kMaxRamp));
    command
        .add_option(
            "--cache", o.cache,
            "Keep for later passes what rays found: bits (pair methods), links (directional, hybrid), "
            "none or auto")
        ->capture_default_str()
        ->check(oneOf({"auto", "none", "bits", "links"}));
    command.add_option(
        "--cache-memory", o.cacheMemory,
        "At most so much, as 512M or 2G (default: a third of the free device memory, for links beside a "
        "GPU a quarter of the machine's, too)");
}

void resolvePairOptions(const PairOptions& o, SolverSettings& settings) {
    const char* method = methodName(settings.method);
    if (o.window && !hasWindow(settings.method))
        throw UsageError(
            fmt::format("--window: --method {} has none; static, montecarlo and mipmapped have", method));
    const bool adaptive = settings.method == Method::Adaptive;
    if (!adaptive && (o.node || o.threshold || o.thresholdRamp))
        throw UsageError(fmt::format("{}: only with --method adaptive, not {}",
                                     o.node        ? "--node"
                                     : o.threshold ? "--threshold"
                                                   : "--threshold-ramp",
                                     method));
    settings.pairs.window = o.window.value_or(hasWindow(settings.method) ? kDefaultWindow : 1);
    settings.pairs.node = o.node.value_or(settings.pairs.node);
    if (o.threshold) settings.pairs.threshold = *o.threshold;
    settings.pairs.thresholdRamp = o.thresholdRamp.value_or(settings.pairs.thresholdRamp);
    settings.cache.kind = parseCache(o.cache, settings.method);
    if (!o.cacheMemory.empty()) {
        if (settings.cache.kind == CacheSettings::Kind::None)
            throw UsageError("--cache-memory: --cache none keeps nothing");
        settings.cache.bytes = typedMemory("--cache-memory", o.cacheMemory);
    }
}

std::string describePairSettings(const SolverSettings& settings) {
    if (hasWindow(settings.method)) return fmt::format(" window={}", settings.pairs.window);
    if (settings.method != Method::Adaptive) return "";
    return fmt::format(" threshold={} node={} threshold-ramp={}", settings.pairs.threshold,
                       settings.pairs.node, settings.pairs.thresholdRamp);
}

} // namespace relume
