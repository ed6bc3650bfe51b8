#include "app/offline/probe_options.h"

#include "app/offline/probe_files.h"
#include "app/offline/probe_forms.h"
#include "app/text/option_checks.h"
#include "app/text/typed_numbers.h"
#include "assets/base/error.h"
#include "assets/model/scene_limits.h"
#include "bake/lights/lamps.h"
#include "bake/lights/light_source.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace relume {
namespace {

constexpr uint32_t kDefaultProbeSamples = 4096, kMostProbeSamples = 16384;

glm::vec3 typedPlace(const std::string& text) {
    const std::vector<float> numbers = typedNumbers(text, 3);
    const auto isNear = [](float number) { return std::abs(number) <= kFarthest; };
    if (numbers.empty() || !std::all_of(numbers.begin(), numbers.end(), isNear))
        throw UsageError(
            fmt::format("--probe-at: '{}' is no place: give three numbers in metres, as 1,2.5,-3, "
                        "each from -{:g} to {:g}",
                        text, kFarthest, kFarthest));
    return {numbers[0], numbers[1], numbers[2]};
}

} // namespace

uint32_t ProbeOptions::samplesOrDefault() const {
    return samples > 0 ? samples : kDefaultProbeSamples;
}

void addProbeOptions(CLI::App& command, ProbeOptions& o) {
    CLI::Option* grid =
        command
            .add_option("--probes", o.spacing, "Bake light probes, too, on a grid of this spacing in metres")
            ->check(numberFrom(1e-6, 1e6));
    command.add_option("--probe-at", o.at, "Bake a light probe, too, at X,Y,Z in metres; may be repeated")
        ->excludes(grid);
    command
        .add_option("--probe-samples", o.samples,
                    "Rays on each of the six sides of a probe, a multiple of 8 (default: 4096)")
        ->check(wholeFrom(8, kMostProbeSamples));
    command.add_option(
        "--probes-out", o.output,
        "Write the light probes to this .json, or for an engine: .three.json, or .ktx2 for Bevy");
}

void checkProbeOptions(const ProbeOptions& o, const BakeSettings& bake, bool radianceWanted) {
    if (!o.wanted()) {
        if (!o.output.empty())
            throw UsageError(
                "--probes-out: there are no probes to write: add --probes SPACING or --probe-at X,Y,Z");
        if (o.samples > 0)
            throw UsageError(
                "--probe-samples: there are no probes: add --probes SPACING or --probe-at X,Y,Z");
        return;
    }
    for (const std::string& place : o.at)
        typedPlace(place);
    if (o.output.empty())
        throw UsageError("--probes: nothing says where they go: add --probes-out FILE.json");
    if (probeFormOf("--probes-out", o.output) == ProbeForm::Bevy && !o.at.empty())
        throw UsageError("--probes-out: '" + o.output +
                         "' is a volume, which needs a grid: take --probes SPACING, or .json");
    if (o.samples % 8 != 0)
        throw UsageError(
            fmt::format("--probe-samples {}: take a multiple of 8 up to {}", o.samples, kMostProbeSamples));
    if (bake.solver.transport.rtrad)
        throw UsageError(
            "--probes: not with --preset rtrad, which computes RTRad's radiosity: leave one out");
    if (usesVoxels(bake))
        throw UsageError(
            "--probes: not with voxels, which know no places between surfaces: take another --tracer");
    if (radianceWanted)
        throw UsageError(
            "--probes: not with --quantity radiance: probes need irradiance, leave --quantity out");
    if (o.at.size() > kMostProbes)
        throw UsageError(fmt::format("--probe-at: {} probes are more than {}", o.at.size(), kMostProbes));
}

ProbePlan planProbes(const ProbeOptions& o, const WorldMesh& mesh) {
    ProbePlan plan;
    if (!o.at.empty()) {
        for (const std::string& place : o.at)
            plan.points.push_back(typedPlace(place));
        return plan;
    }
    glm::vec3 low(std::numeric_limits<float>::max()), high(-low);
    for (const glm::vec3& p : mesh.positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    plan.isGrid = true;
    plan.grid = planProbeGrid(low, high, static_cast<float>(o.spacing));
    plan.points = probePoints(plan.grid);
    if (probeFormOf("--probes-out", o.output) == ProbeForm::Bevy)
        if (const std::string problem = volumeProblem(plan.grid); !problem.empty())
            throw UsageError(fmt::format("--probes {}: {}", o.spacing, problem));
    return plan;
}

ProbeExtent probeExtent(const ProbeOptions& options, const ProbePlan& plan, const Scene& scene, bool layers) {
    ProbeExtent extent{.count = static_cast<uint32_t>(plan.points.size()),
                       .samples = options.samplesOrDefault()};
    for (const shader::Lamp& lamp : lampsOf(scene, false, {.samples = kProbeLampSamples, .unit = true}))
        extent.targets += lamp.samples;
    if (layers) extent.lights = static_cast<uint32_t>(std::max<size_t>(lightSources(scene).size(), 1));
    return extent;
}

} // namespace relume
