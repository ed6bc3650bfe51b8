#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "app/text/svg_plot.h"

namespace relume {

/// How good a bake was at one moment. Errors are shares: 0.05 is 5 %.
struct QualityPoint {
    uint32_t samples = 0; // directions per patch, where they are one number
    uint64_t rays = 0;
    double seconds = 0;        // of the solver
    double processSeconds = 0; // from reading the scene on, without the reference and without measuring
    double relRmse = 0, local50 = 0, local95 = 0, local99 = 0; // true ones, against the reference
    double toldError = 1, toldLocal95 = 1, toldLocal99 = 1;    // by the solver
    std::vector<double> flip; // of each picture against that of the reference; empty: no pictures
};

struct QualityRun {
    std::string mode; // "plain", "layers" or "per-chunk"
    uint32_t patches = 0;
    bool converged = false; // by what the solver tells; else a limit ended it
    std::vector<QualityPoint> points;
    std::string note; // why there is nothing, or less
};

struct QualityReport {
    std::string scene, device, driver, tracer, version, command;
    std::string reference;             // what it was made by, or its file
    std::vector<std::string> pictures; // what each shows
    uint32_t size = 0;
    double error = 0, localError = 0; // that were asked for
    bool interrupted = false;
    std::vector<QualityRun> runs;
};

/// Where a curve comes to an error.
struct QualityReached {
    double rays = 0, seconds = 0;
    bool atMost = false; // the first point was there already
};
/// Returns where a curve first comes down to an aim: between two points it runs straight, where error, rays
/// and time are logarithms. Nothing where it ends before. `error` is the member that is looked at.
std::optional<QualityReached> reachedAt(const std::vector<QualityPoint>& points, double QualityPoint::*error,
                                        double aim);

/// Returns all figures; what is missing or infinite is null.
nlohmann::ordered_json qualityJson(const QualityReport& report);
/// Returns the figures as lines for a terminal.
std::string qualityTable(const QualityReport& report);
/// Returns errors over the solver's time, or over rays: of each mode local error, relRMSE and the mean FLIP.
PlotDesc qualityPlot(const QualityReport& report, bool overRays);

} // namespace relume
