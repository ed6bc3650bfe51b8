#include "app/commands/command.h"
#include "app/offline/command_files.h"
#include "app/text/heat_map.h"
#include "app/text/option_checks.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/images/flip.h"
#include "assets/images/paged_image.h"
#include "assets/images/metrics.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

namespace relume {
namespace {

using Json = nlohmann::ordered_json;

struct CompareOptions {
    std::string a, b, mask, darkBy, diff;
    std::vector<std::string> metrics; // lower case; none: all
    double pixelsPerDegree = kFlipPixelsPerDegree;
    bool json = false;
};

/// A value of a comparison, as it is printed.
struct Value {
    const char* option; // as --metric takes it
    const char* name;
    const char* meaning;
    double value;
};

bool wants(const CompareOptions& options, const char* metric) {
    const std::vector<std::string>& chosen = options.metrics;
    return chosen.empty() || std::find(chosen.begin(), chosen.end(), metric) != chosen.end();
}

/// What of the metrics is asked for.
struct Measured {
    Metrics all;
    double flipMean = 0;
    LocalPercentiles local;
    double darkBias = 0;
};

std::array<Value, 8> valuesOf(const Measured& measured) {
    const Metrics& m = measured.all;
    return {{{"relrmse", "relRMSE", "RMSE / mean of B", m.relRmse},
             {"rmse", "RMSE", "root of the mean squared difference", m.rmse},
             {"dfpr", "DFPR", "mean RGB distance as displayed (sRGB), full scale 1", m.dfpr},
             {"flip", "FLIP", "mean difference seen when flipping between the two, full scale 1",
              measured.flipMean},
             {"local", "local", "95th percentile of |A - B| / max(B, 5 % of its median)", measured.local.p95},
             {"maximum", "maximum", "largest difference of a channel", m.maximum},
             {"bias", "bias", "mean of A - B", m.bias},
             {"dark", "dark", "mean of A / mean of B - 1 in the darkest quarter", measured.darkBias}}};
}

/// A picture of the differences: what it shows and the value at the bright end of its ramp.
struct Difference {
    std::string quantity;
    double scale = 1;
};

// Returns the round end of a scale for the values that are finite.
double finiteScale(const std::vector<float>& map, std::vector<bool> covered) {
    for (size_t i = 0; i < map.size(); ++i)
        if (!std::isfinite(map[i])) covered[i] = false;
    return heatScale(map, covered);
}

// Writes the picture, which shows what the first --metric measures.
Difference writeDifference(const CompareOptions& options, const ImagePair& pair, const Measured& m,
                           const std::vector<float>& flipMap, const std::vector<float>& localMap) {
    const std::string first = options.metrics.empty() ? "relrmse" : options.metrics.front();
    Difference difference;
    std::vector<float> map;
    if (first == "flip") {
        difference.quantity = "FLIP";
        map = flipMap;
    } else if (first == "local") {
        difference.quantity = "local error";
        map = localMap;
    } else if (first == "dfpr") {
        difference.quantity = "RGB distance as displayed";
        map = pair.displayedDifferences();
    } else {
        difference.quantity = "difference";
        map = pair.differences();
        if (first == "relrmse" && m.all.meanB > 0) { // relative to a black image there is nothing
            difference.quantity = "difference / mean of B";
            for (float& value : map)
                value = static_cast<float>(value / m.all.meanB);
        }
    }
    if (first != "flip") difference.scale = finiteScale(map, pair.covered());
    writeImage(options.diff, heatMap(pair.width(), map, pair.covered(), difference.scale));
    return difference;
}

// Returns null for what is infinite, which JSON does not have.
Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json jsonOf(const CompareOptions& options, const Measured& measured,
            const std::optional<Difference>& difference) {
    const Metrics& m = measured.all;
    const LocalPercentiles& local = measured.local;
    Json json = {{"a", options.a}, {"b", options.b}};
    if (!options.mask.empty()) json["mask"] = options.mask;
    if (!options.darkBy.empty()) json["darkBy"] = options.darkBy;
    for (const Value& v : valuesOf(measured))
        if (wants(options, v.option)) json[v.name] = number(v.value);
    if (wants(options, "local"))
        json["local"] = {{"p50", number(local.p50)},
                         {"p90", number(local.p90)},
                         {"p95", number(local.p95)},
                         {"p99", number(local.p99)}};
    if (wants(options, "flip")) json["pixelsPerDegree"] = options.pixelsPerDegree;
    json["meanA"] = m.meanA;
    json["meanB"] = m.meanB;
    json["texels"] = m.texels;
    json["onlyA"] = m.onlyA;
    json["onlyB"] = m.onlyB;
    json["masked"] = m.masked;
    if (difference)
        json["diff"] = {
            {"file", options.diff}, {"quantity", difference->quantity}, {"scale", difference->scale}};
    return json;
}

void printTable(const CompareOptions& options, const Measured& measured,
                const std::optional<Difference>& difference) {
    const Metrics& m = measured.all;
    const LocalPercentiles& local = measured.local;
    const auto line = [](const char* name, double value, const char* meaning) {
        std::printf("%-8s %12.6g  %s\n", name, value, meaning);
    };
    for (const Value& v : valuesOf(measured))
        line(v.name, v.value, v.meaning);
    std::printf("%-8s %12s  p50 %.6g, p90 %.6g, p95 %.6g, p99 %.6g\n", "", "", local.p50, local.p90,
                local.p95, local.p99);
    line("mean A", m.meanA, "");
    line("mean B", m.meanB, "");
    std::printf("%-8s %12llu  compared; covered only in A %llu, only in B %llu", "texels",
                static_cast<unsigned long long>(m.texels), static_cast<unsigned long long>(m.onlyA),
                static_cast<unsigned long long>(m.onlyB));
    if (m.masked > 0) std::printf("; masked %llu", static_cast<unsigned long long>(m.masked));
    std::printf("\n");
    if (difference)
        std::printf("%-8s %12.6g  bright end of %s: %s\n", "diff", difference->scale, options.diff.c_str(),
                    difference->quantity.c_str());
}

// A file that another program wrote may have several pages side by side and not say so: hence no error.
void warnOfPages(const CompareOptions& options, const FloatImage& a, const FloatImage& b) {
    const uint32_t ofA = lightmapPagesOf(a).count, ofB = lightmapPagesOf(b).count;
    if (ofA == ofB) return;
    spdlog::warn("{} has {} page{}, {} has {}: texels in the same place belong to different surfaces, unless "
                 "one file has all pages side by side; bake both on as many pages",
                 options.a, ofA, ofA == 1 ? "" : "s", options.b, ofB);
}

void runCompare(const CompareOptions& options) {
    if (!options.darkBy.empty() && !wants(options, "dark"))
        throw UsageError("--dark-by: only with --metric dark, others look at all texels");
    if (!options.diff.empty()) {
        if (!options.diff.ends_with(".png"))
            throw UsageError("--diff: '" + options.diff + "' does not end in .png");
        CommandFiles()
            .readsLightmap("A", options.a)
            .readsLightmap("B", options.b)
            .readsLightmap("--mask", options.mask)
            .readsLightmap("--dark-by", options.darkBy)
            .writes("--diff", options.diff)
            .check();
        checkWritable(options.diff);
    }
    const FloatImage a = readImageOrPages(options.a), b = readImageOrPages(options.b);
    const FloatImage maskImage = options.mask.empty() ? FloatImage() : readImageOrPages(options.mask);
    const NamedImage mask{maskImage, options.mask};
    const ImagePair pair({a, options.a}, {b, options.b}, options.mask.empty() ? nullptr : &mask);
    warnOfPages(options, a, b);
    Measured measured{.all = pair.measure(), .flipMean = 0, .local = {}, .darkBias = 0};
    if (wants(options, "dark")) {
        const FloatImage byImage = options.darkBy.empty() ? FloatImage() : readImageOrPages(options.darkBy);
        const NamedImage by{byImage, options.darkBy};
        measured.darkBias = pair.darkBias(options.darkBy.empty() ? nullptr : &by);
    }
    std::vector<float> flipMap, localMap;
    if (wants(options, "flip")) flipMap = pair.flipDifferences(options.pixelsPerDegree);
    if (!flipMap.empty()) measured.flipMean = pair.mean(flipMap);
    if (wants(options, "local")) localMap = pair.localErrors();
    if (!localMap.empty()) measured.local = pair.percentiles(localMap);

    std::optional<Difference> difference;
    if (!options.diff.empty()) {
        difference = writeDifference(options, pair, measured, flipMap, localMap);
        spdlog::info("wrote {}: {} from 0 (black) to {:g} (white)", options.diff, difference->quantity,
                     difference->scale);
    }
    if (options.json) {
        // A file name need not be UTF-8.
        const Json json = jsonOf(options, measured, difference);
        std::printf("%s\n", json.dump(2, ' ', false, Json::error_handler_t::replace).c_str());
    } else if (options.metrics.empty()) {
        printTable(options, measured, difference);
    } else {
        for (const std::string& metric : options.metrics)
            for (const Value& v : valuesOf(measured))
                if (metric == v.option) std::printf("%.9g\n", v.value);
    }
}

} // namespace

void addCompareCommand(CLI::App& app) {
    const auto options = std::make_shared<CompareOptions>();
    CLI::App* command = app.add_subcommand("compare", "Measure how far lightmap A is from lightmap B");
    command->add_option("a", options->a, "OpenEXR or PNG image")->required()->type_name("A");
    command->add_option("b", options->b, "The reference, of the same size")->required()->type_name("B");
    std::vector<std::string> names;
    for (const Value& v : valuesOf({}))
        names.emplace_back(v.option);
    command
        ->add_option(
            "--metric", options->metrics,
            "Print only these values, a line each: relrmse, rmse, dfpr, flip, local, maximum, bias, dark")
        ->delimiter(',')
        ->allow_extra_args(false) // else it would take A and B
        ->transform(oneOfAnyCase(names))
        ->type_name("NAME,...");
    command->add_option("--mask", options->mask,
                        "Image of the same size: compare only where its R (or coverage) is above 0.5");
    command->add_option(
        "--dark-by", options->darkBy,
        "Image of the same size that says which quarter is the darkest (default: B, whose noise "
        "then counts as dark)");
    command->add_option(
        "--diff", options->diff,
        "Write a heat map of the differences (of what the first --metric measures) to this .png");
    command
        ->add_option("--ppd", options->pixelsPerDegree, "Pixels per degree of the viewer's sight, for FLIP")
        ->capture_default_str()
        ->check(numberFrom(1.0, 1000.0));
    command->add_flag("--json", options->json, "Print JSON instead of a table");
    command->callback([options] { runCompare(*options); });
}

} // namespace relume
