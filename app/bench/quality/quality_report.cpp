#include "app/bench/quality/quality_report.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

namespace relume {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

/// An error that somebody asks for.
struct Aim {
    const char* name; // in JSON
    std::string text; // in the table
    double QualityPoint::*error;
    double value;
};

std::vector<Aim> aimsOf(const QualityReport& report) {
    std::vector<Aim> aims = {{"localError20", "local error 20 %", &QualityPoint::local95, 0.2},
                             {"localError5", "local error 5 %", &QualityPoint::local95, 0.05}};
    if (report.error > 0)
        aims.push_back({"error", fmt::format("relRMSE {:g} %", 100.0 * report.error), &QualityPoint::relRmse,
                        report.error});
    return aims;
}

double meanFlip(const QualityPoint& point) {
    if (point.flip.empty()) return 0;
    return std::accumulate(point.flip.begin(), point.flip.end(), 0.0) /
           static_cast<double>(point.flip.size());
}

Json describe(const QualityPoint& p) {
    Json flips = Json::array();
    for (const double flip : p.flip)
        flips.push_back(number(flip));
    return {{"samples", p.samples},
            {"rays", p.rays},
            {"seconds", p.seconds},
            {"processSeconds", p.processSeconds},
            {"relRMSE", number(p.relRmse)},
            {"toldError", number(p.toldError)},
            {"local50", number(p.local50)},
            {"local95", number(p.local95)},
            {"local99", number(p.local99)},
            {"toldLocal95", number(p.toldLocal95)},
            {"toldLocal99", number(p.toldLocal99)},
            {"FLIP", flips}};
}

std::string percent(double value) {
    return std::isfinite(value) ? fmt::format("{:.3g}", 100.0 * value) : "–";
}

std::string flipText(const QualityPoint& p) {
    std::vector<std::string> texts;
    for (const double flip : p.flip)
        texts.push_back(fmt::format("{:.3f}", flip));
    return texts.empty() ? "–" : fmt::format("{}", fmt::join(texts, " "));
}

} // namespace

std::optional<QualityReached> reachedAt(const std::vector<QualityPoint>& points, double QualityPoint::*error,
                                        double aim) {
    for (size_t i = 0; i < points.size(); ++i) {
        const QualityPoint& after = points[i];
        const double below = after.*error;
        if (below > aim) continue;
        const auto rays = static_cast<double>(after.rays);
        if (i == 0) return QualityReached{rays, after.seconds, true};
        const QualityPoint& before = points[i - 1];
        // An error of 0 has no logarithm, and a rate of infinity leads nowhere.
        if (below <= 0 || !std::isfinite(before.*error)) return QualityReached{rays, after.seconds, true};
        const double share = std::log(before.*error / aim) / std::log(before.*error / below);
        const auto between = [&](double from, double to) {
            return from > 0 ? from * std::pow(to / from, share) : to;
        };
        return QualityReached{between(static_cast<double>(before.rays), rays),
                              between(before.seconds, after.seconds), false};
    }
    return {};
}

Json qualityJson(const QualityReport& report) {
    Json runs = Json::array();
    for (const QualityRun& run : report.runs) {
        Json points = Json::array(), reached = Json::object();
        for (const QualityPoint& point : run.points)
            points.push_back(describe(point));
        for (const Aim& aim : aimsOf(report)) {
            const auto found = reachedAt(run.points, aim.error, aim.value);
            reached[aim.name] = nullptr;
            if (found)
                reached[aim.name] = {
                    {"rays", found->rays}, {"seconds", found->seconds}, {"atMost", found->atMost}};
        }
        Json json = {{"mode", run.mode},
                     {"patches", run.patches},
                     {"converged", run.converged},
                     {"reached", reached},
                     {"points", points}};
        if (!run.note.empty()) json["note"] = run.note;
        runs.push_back(std::move(json));
    }
    return {{"version", report.version},
            {"scene", report.scene},
            {"command", report.command},
            {"device", report.device},
            {"driver", report.driver},
            {"tracer", report.tracer},
            {"size", report.size},
            {"error", report.error},
            {"localError", report.localError},
            {"reference", report.reference},
            {"pictures", report.pictures},
            {"interrupted", report.interrupted},
            {"runs", runs}};
}

std::string qualityTable(const QualityReport& report) {
    constexpr const char* kRow =
        "{:<8} {:>7} {:>9} {:>9} {:>9} {:>8} {:>8} {:>7} {:>7} {:>7} {:>8} {:>8}  {}\n";
    std::string text =
        fmt::format(fmt::runtime(kRow), "mode", "samples", "Mrays", "solver s", "process s", "relRMSE%",
                    "told", "p50 %", "p95 %", "p99 %", "told p95", "told p99", "FLIP of each picture");
    for (const QualityRun& run : report.runs) {
        for (const QualityPoint& p : run.points)
            text +=
                fmt::format(fmt::runtime(kRow), run.mode, p.samples,
                            fmt::format("{:.4g}", 1e-6 * static_cast<double>(p.rays)),
                            fmt::format("{:.3g}", p.seconds), fmt::format("{:.3g}", p.processSeconds),
                            percent(p.relRmse), percent(p.toldError), percent(p.local50), percent(p.local95),
                            percent(p.local99), percent(p.toldLocal95), percent(p.toldLocal99), flipText(p));
        if (!run.note.empty()) text += fmt::format("{:<8} {}\n", run.mode, run.note);
    }
    for (const QualityRun& run : report.runs) {
        for (const Aim& aim : aimsOf(report)) {
            const auto found = reachedAt(run.points, aim.error, aim.value);
            text += fmt::format("{:<8} {:<18} ", run.mode, aim.text);
            text += found ? fmt::format("{}{:.4g} Mrays, {:.3g} s\n", found->atMost ? "at most " : "",
                                        1e-6 * found->rays, found->seconds)
                          : std::string("not reached\n");
        }
    }
    return text;
}

PlotDesc qualityPlot(const QualityReport& report, bool overRays) {
    PlotDesc desc{.title = fmt::format("Error over {}: {}, {}²", overRays ? "rays" : "time",
                                       report.scene.substr(report.scene.find_last_of('/') + 1), report.size),
                  .xLabel = overRays ? "rays" : "solver time [s]",
                  .yLabel = "error against the reference",
                  .series = {},
                  .xTicks = {}};
    for (size_t r = 0; r < report.runs.size(); ++r) {
        const QualityRun& run = report.runs[r];
        const auto add = [&](const char* name, int dash, auto valueOf) {
            PlotSeries series{
                .name = run.mode + ", " + name, .colour = static_cast<int>(r) + 1, .dash = dash};
            for (const QualityPoint& p : run.points)
                series.points.push_back({.x = overRays ? static_cast<double>(p.rays) : p.seconds,
                                         .y = valueOf(p),
                                         .hint = fmt::format("{}: {} % after {:.3g} s", series.name,
                                                             percent(valueOf(p)), p.seconds)});
            desc.series.push_back(std::move(series));
        };
        add("local error", 0, [](const QualityPoint& p) { return p.local95; });
        add("relRMSE", 1, [](const QualityPoint& p) { return p.relRmse; });
        if (!report.pictures.empty()) add("mean FLIP", 2, meanFlip);
    }
    return desc;
}

} // namespace relume
