#include "app/commands/command.h"
#include "app/text/option_checks.h"
#include "assets/base/error.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"
#include "bake/base/shader_types.h"
#include "bake/links/directions.h"

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <limits>
#include <memory>

namespace relume {
namespace {

struct SamplesOptions {
    uint32_t count = 0;
    std::string set = "lec", output;
    uint32_t seed = 0;
};

std::vector<glm::dvec3> directionsOf(const SamplesOptions& options) {
    std::vector<glm::dvec3> directions;
    if (options.set == "lec") {
        for (const glm::dvec2 p : evenRings(largestEmptyCircleDisc(options.count)))
            directions.push_back(projectedUp(p));
    } else {
        for (uint32_t i = 0; i < options.count; ++i)
            directions.emplace_back(shader::cosineDirection(shader::sobolPoint(i, options.seed)));
    }
    return directions;
}

std::string csvOf(const std::vector<glm::dvec3>& directions) {
    std::string text = "x,y,z\n";
    for (const glm::dvec3& d : directions)
        text += fmt::format("{:.9f},{:.9f},{:.9f}\n", d.x, d.y, d.z);
    return text;
}

std::string jsonOf(const SamplesOptions& options, const std::vector<glm::dvec3>& directions) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const glm::dvec3& d : directions)
        list.push_back({d.x, d.y, d.z});
    return nlohmann::ordered_json{{"set", options.set}, {"count", options.count}, {"directions", list}}.dump(
               1) +
           "\n";
}

void runSamples(const SamplesOptions& options) {
    const bool json = options.output.ends_with(".json");
    if (!options.output.empty() && !json && !options.output.ends_with(".csv"))
        throw UsageError("--output: '" + options.output + "' ends neither in .csv nor in .json");
    if (!options.output.empty()) checkFileWritable(options.output, 0);
    const std::vector<glm::dvec3> directions = directionsOf(options);
    const std::string text = json ? jsonOf(options, directions) : csvOf(directions);
    if (options.output.empty()) {
        std::fputs(text.c_str(), stdout);
        return;
    }
    writeFileAtomically(options.output, text);
    spdlog::info("{}: {} directions", options.output, options.count);
}

} // namespace

void addSamplesCommand(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("samples", "Print a set of cosine-distributed directions around +z");
    const auto options = std::make_shared<SamplesOptions>();
    command->add_option("count", options->count, "How many")
        ->required()
        ->check(wholeFrom(1, kMostDirections));
    command
        ->add_option("--set", options->set,
                     "lec: insertion into the largest empty circle of the disc; sobol: Owen-scrambled Sobol")
        ->capture_default_str()
        ->check(oneOf({"lec", "sobol"}));
    command->add_option("--seed", options->seed, "Of sobol's scrambling")
        ->capture_default_str()
        ->check(wholeFrom(0, std::numeric_limits<uint32_t>::max()));
    command->add_option("-o,--output", options->output,
                        "File to write, .csv or .json (default: CSV to standard output)");
    command->callback([options] { runSamples(*options); });
}

} // namespace relume
