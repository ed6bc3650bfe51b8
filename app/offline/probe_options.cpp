#include "app/offline/probe_options.h"

#include "app/text/option_checks.h"
#include "app/text/typed_numbers.h"
#include "assets/base/error.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"
#include "assets/model/scene_limits.h"
#include "bake/lights/lamps.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace relume {
namespace {

constexpr uint32_t kDefaultProbeSamples = 4096, kMostProbeSamples = 16384;
constexpr uint32_t kProbeLampSamples = 64; // to each analytic light that has an extent

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

uint32_t samplesOf(const ProbeOptions& o) {
    return o.samples > 0 ? o.samples : kDefaultProbeSamples;
}

// Throws where the links of so many probes take more memory than those of the largest grid with the default.
void checkMemory(const ProbeOptions& o, uint64_t probes) {
    constexpr uint64_t kMostSamples = uint64_t{kMostProbes} * kDefaultProbeSamples;
    if (probes * samplesOf(o) <= kMostSamples) return;
    throw UsageError(fmt::format("--probe-samples {}: too many for {} probes: {} fit", o.samples, probes,
                                 kMostSamples / probes / 8 * 8));
}

nlohmann::ordered_json vectorJson(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

} // namespace

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
    command.add_option("--probes-out", o.output, "Write the light probes to this .json");
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
    if (!o.output.ends_with(".json"))
        throw UsageError("--probes-out: '" + o.output + "' does not end in .json");
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
    if (bake.solver.layers.on)
        throw UsageError(
            "--probes: not with --layers: probes have the light of all lights together; bake twice");
    if (o.at.size() > kMostProbes)
        throw UsageError(fmt::format("--probe-at: {} probes are more than {}", o.at.size(), kMostProbes));
}

ProbePlan planProbes(const ProbeOptions& o, const WorldMesh& mesh) {
    ProbePlan plan;
    if (!o.at.empty()) {
        for (const std::string& place : o.at)
            plan.points.push_back(typedPlace(place));
        checkMemory(o, plan.points.size());
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
    checkMemory(o, plan.points.size());
    return plan;
}

std::vector<Probe> bakeProbes(const vk::Device& device, const Scene& scene, Baker& baker,
                              const ProbePlan& plan, uint32_t samples, float reflectivity) {
    const PatchSet& patches = baker.patches();
    const LampSet lamps = buildLamps(scene, patches.scene.mesh, {.samples = kProbeLampSamples, .sky = false});
    const ProbeLinks links = traceProbes(device, patches, lamps, plan.points,
                                         {.samples = samples > 0 ? samples : kDefaultProbeSamples,
                                          .tracer = parseTracerKind(baker.tracer().name())});
    const std::vector<glm::vec4> radiance = patchRadiance(patches, baker.solver().light(), reflectivity);
    std::vector<Probe> probes = gatherProbes(
        links,
        {.radiance = radiance, .sky = scene.sky.shines() ? &scene.sky : nullptr, .lamps = lamps.lamps});
    size_t inside = 0;
    for (const Probe& probe : probes)
        inside += probe.inside() ? 1 : 0;
    spdlog::info("{} probes, {} of them inside walls, {:.3g} Mrays", probes.size(), inside,
                 static_cast<double>(links.rays) * 1e-6);
    return probes;
}

void writeProbes(const std::string& path, const ProbePlan& plan, const std::vector<Probe>& probes) {
    nlohmann::ordered_json json = {{"version", RELUME_VERSION},
                                   {"quantity", "radiance"},
                                   {"unit", "cd/m^2"},
                                   {"basis",
                                    "real spherical harmonics, bands 0 to 2: 1, y, z, x, xy, yz, 3z^2-1, xz, "
                                    "x^2-y^2, orthonormal, Y up"}};
    if (plan.isGrid) {
        const glm::uvec3& n = plan.grid.counts;
        json["grid"] = {{"first", vectorJson(plan.grid.first)},
                        {"spacing", plan.grid.spacing},
                        {"counts", {n.x, n.y, n.z}},
                        {"order", "x fastest, then y, then z"}};
    }
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Probe& probe : probes) {
        nlohmann::ordered_json coefficients = nlohmann::ordered_json::array();
        for (const glm::dvec3& c : probe.radiance)
            coefficients.push_back(vectorJson(c));
        list.push_back({{"position", vectorJson(probe.position)},
                        {"inside", probe.inside()},
                        {"backs", probe.backs},
                        {"coefficients", std::move(coefficients)}});
    }
    json["probes"] = std::move(list);
    writeFileAtomically(path, json.dump(1) + "\n");
    spdlog::info("wrote {}", path);
}

} // namespace relume
