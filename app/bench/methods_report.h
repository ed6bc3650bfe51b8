#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace relume {

/// The figures of one bake of one method with one setting at one size.
struct MethodRun {
    std::string method;  // as --method takes it
    std::string setting; // "window 4", "1024 samples"; empty where there is none to choose
    uint32_t size = 0, patches = 0;
    std::optional<double> passSeconds;  // solver time per bounce
    std::optional<double> solveSeconds; // of all bounces
    std::optional<double>
        totalSeconds; // and everything from the lightmap's rasterization to the finished map
    std::optional<uint64_t> rays;
    std::optional<double> dfpr;       // against pure with as many bounces
    std::optional<double> relRmse;    // against the reference
    std::optional<double> localError; // likewise, the 95th percentile (assets/images/metrics.h)
    std::optional<double> flip;       // against the reference
    std::string note;                 // why there are no figures, or fewer
    std::string picture;              // bytes of a PNG; empty: none
    std::string difference;           // the same: heat map of the difference from the reference
};

struct MethodsReport {
    std::string scene, device, driver, tracer, version, command;
    uint32_t passes = 0;
    std::string reference;      // what relRMSE and FLIP refer to; empty: nothing
    double differenceScale = 0; // bright end of the heat maps, relative to the reference's mean
    std::vector<MethodRun> runs;
};

/// Returns one page that needs no other file, with plots, tables and pictures. It can be read on light and
/// dark screens.
std::string methodsHtml(const MethodsReport& report);

/// Returns the same figures, without pictures. Missing ones are null.
nlohmann::ordered_json methodsJson(const MethodsReport& report);

/// Return the lines of a table for a terminal.
std::string methodsTableHead();
std::string methodsTableRow(const MethodRun& run);

} // namespace relume
