#include "app/command.h"
#include "bake/metrics.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <memory>

namespace relume {
namespace {

struct CompareOptions {
    std::string a, b;
    bool json = false;
};

void printJson(const CompareOptions& options, const Metrics& m) {
    nlohmann::ordered_json json = {{"a", options.a}, {"b", options.b}};
    json["relRMSE"] =
        std::isfinite(m.relRmse) ? nlohmann::ordered_json(m.relRmse) : nullptr; // JSON has no infinity
    json["RMSE"] = m.rmse;
    json["DFPR"] = m.dfpr;
    json["maximum"] = m.maximum;
    json["bias"] = m.bias;
    json["meanA"] = m.meanA;
    json["meanB"] = m.meanB;
    json["texels"] = m.texels;
    json["onlyA"] = m.onlyA;
    json["onlyB"] = m.onlyB;
    // A file name need not be UTF-8.
    std::printf("%s\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace).c_str());
}

void printTable(const Metrics& m) {
    const auto line = [](const char* name, double value, const char* meaning) {
        std::printf("%-8s %12.6g  %s\n", name, value, meaning);
    };
    line("relRMSE", m.relRmse, "RMSE / mean of B");
    line("RMSE", m.rmse, "root of the mean squared difference");
    line("DFPR", m.dfpr, "mean RGB distance as displayed (sRGB), full scale 1");
    line("maximum", m.maximum, "largest difference of a channel");
    line("bias", m.bias, "mean of A - B");
    line("mean A", m.meanA, "");
    line("mean B", m.meanB, "");
    std::printf("%-8s %12llu  compared; covered only in A %llu, only in B %llu\n", "texels",
                static_cast<unsigned long long>(m.texels), static_cast<unsigned long long>(m.onlyA),
                static_cast<unsigned long long>(m.onlyB));
}

void runCompare(const CompareOptions& options) {
    const FloatImage a = readImage(options.a), b = readImage(options.b);
    const Metrics metrics = compareImages(a, options.a, b, options.b);
    if (options.json)
        printJson(options, metrics);
    else
        printTable(metrics);
}

} // namespace

void addCompareCommand(CLI::App& app) {
    const auto options = std::make_shared<CompareOptions>();
    CLI::App* command = app.add_subcommand("compare", "Measure how far lightmap A is from lightmap B");
    command->add_option("a", options->a, "OpenEXR or PNG image")->required()->type_name("A");
    command->add_option("b", options->b, "The reference, of the same size")->required()->type_name("B");
    command->add_flag("--json", options->json, "Print JSON instead of a table");
    command->callback([options] { runCompare(*options); });
}

} // namespace relume
