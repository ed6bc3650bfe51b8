#include "app/bench/methods_report.h"

#include "app/text/svg_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

namespace relume {
namespace {

// The colour of a method is the same in every report, whichever were run.
constexpr std::array<const char*, 7> kMethods = {"pure",     "static",      "montecarlo", "mipmapped",
                                                 "adaptive", "directional", "hybrid"};

constexpr const char* kTableRow =
    "{:<12} {:<16} {:>5} {:>10} {:>10} {:>10} {:>10} {:>9} {:>9} {:>11} {:>9}\n";

int colourOf(const std::string& method) {
    const auto found = std::find(kMethods.begin(), kMethods.end(), method);
    if (found != kMethods.end()) return static_cast<int>(found - kMethods.begin());
    int sum = 0;
    for (unsigned char c : method)
        sum += c;
    return sum;
}

std::string nameOf(const MethodRun& run) {
    return run.setting.empty() ? run.method : run.method + ", " + run.setting;
}

std::vector<uint32_t> sizesOf(const MethodsReport& report) {
    std::set<uint32_t> sizes;
    for (const MethodRun& run : report.runs)
        sizes.insert(run.size);
    return {sizes.begin(), sizes.end()};
}

std::string secondsText(const std::optional<double>& seconds) {
    if (!seconds || !std::isfinite(*seconds)) return "–";
    if (*seconds < 1.0) return fmt::format("{:.3g} ms", 1000.0 * *seconds);
    return fmt::format("{:.4g} s", *seconds);
}

std::string plainText(const std::optional<double>& value) {
    return value && std::isfinite(*value) ? fmt::format("{:.3g}", *value) : "–";
}

std::string percentText(const std::optional<double>& value) {
    return value && std::isfinite(*value) ? fmt::format("{:.3g} %", 100.0 * *value) : "–";
}

std::string raysText(const std::optional<uint64_t>& rays) {
    return rays ? fmt::format("{:.3g} M", static_cast<double>(*rays) * 1e-6) : "–";
}

std::string base64(const std::string& bytes) {
    constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (size_t i = 0; i < bytes.size(); i += 3) {
        const size_t count = std::min<size_t>(3, bytes.size() - i);
        uint32_t bits = 0;
        for (size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k)
            out += k <= count ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
    }
    return out;
}

// Returns a plot with a line per method and setting, which shows how its time grows with the lightmap.
PlotDesc timeOverSize(const MethodsReport& report) {
    PlotDesc desc{.title = "Time of a pass over the lightmap's edge",
                  .xLabel = "lightmap edge [texels]",
                  .yLabel = "time of a pass [s]"};
    for (const MethodRun& run : report.runs) {
        if (!run.passSeconds) continue;
        const std::string name = nameOf(run);
        auto series = std::find_if(desc.series.begin(), desc.series.end(),
                                   [&](const PlotSeries& s) { return s.name == name; });
        if (series == desc.series.end()) {
            const int colour = colourOf(run.method);
            const auto dash = std::count_if(desc.series.begin(), desc.series.end(),
                                            [&](const PlotSeries& s) { return s.colour == colour; });
            desc.series.push_back({.name = name, .colour = colour, .dash = static_cast<int>(dash)});
            series = desc.series.end() - 1;
        }
        series->points.push_back(
            {.x = static_cast<double>(run.size),
             .y = *run.passSeconds,
             .hint = fmt::format("{}: {} at {}²", name, secondsText(run.passSeconds), run.size)});
    }
    for (PlotSeries& series : desc.series)
        std::sort(series.points.begin(), series.points.end(),
                  [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
    for (uint32_t size : sizesOf(report))
        desc.xTicks.push_back(size);
    return desc;
}

// Returns a plot with a line per method and a point for each setting: what error it reaches in what time.
PlotDesc errorOverTime(const MethodsReport& report, uint32_t size) {
    PlotDesc desc{.title = fmt::format("Error over time at {}²", size),
                  .xLabel = "solver time [s]",
                  .yLabel = "relRMSE against the reference"};
    for (const MethodRun& run : report.runs) {
        if (run.size != size || !run.solveSeconds || !run.relRmse) continue;
        auto series = std::find_if(desc.series.begin(), desc.series.end(),
                                   [&](const PlotSeries& s) { return s.name == run.method; });
        if (series == desc.series.end()) {
            desc.series.push_back({.name = run.method, .colour = colourOf(run.method)});
            series = desc.series.end() - 1;
        }
        const size_t digit = run.setting.find_first_of("0123456789");
        std::string label = digit == std::string::npos ? "" : run.setting.substr(digit);
        label = label.substr(0, label.find(' '));
        series->points.push_back({.x = *run.solveSeconds,
                                  .y = *run.relRmse,
                                  .label = label,
                                  .hint = fmt::format("{}: {} in {}", nameOf(run), percentText(run.relRmse),
                                                      secondsText(run.solveSeconds))});
    }
    for (PlotSeries& series : desc.series)
        std::sort(series.points.begin(), series.points.end(),
                  [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
    return desc;
}

std::string figure(const PlotDesc& desc) {
    std::string html = "<figure>\n<figcaption>" + escapeMarkup(desc.title) + "</figcaption>\n" +
                       logLogPlot(desc) + "<ul class=\"legend\">\n";
    for (const PlotSeries& series : desc.series)
        html += "<li>" + plotSwatch(series) + " " + escapeMarkup(series.name) + "</li>\n";
    return html + "</ul>\n</figure>\n";
}

std::string tableOf(const MethodsReport& report, uint32_t size) {
    std::string html = fmt::format("<h3>{}² texels</h3>\n<div class=\"wide\"><table>\n<thead><tr>", size);
    for (const char* head : {"method", "setting", "patches", "pass", "solver", "total", "rays", "DFPR",
                             "relRMSE", "local error", "FLIP"})
        html += fmt::format("<th scope=\"col\">{}</th>", head);
    html += "</tr></thead>\n<tbody>\n";
    for (const MethodRun& run : report.runs) {
        if (run.size != size) continue;
        html += "<tr><th scope=\"row\">" + escapeMarkup(run.method) + "</th><td>" +
                escapeMarkup(run.setting) + "</td>";
        const std::array<std::string, 9> cells = {run.patches > 0 ? std::to_string(run.patches) : "–",
                                                  secondsText(run.passSeconds),
                                                  secondsText(run.solveSeconds),
                                                  secondsText(run.totalSeconds),
                                                  raysText(run.rays),
                                                  plainText(run.dfpr),
                                                  percentText(run.relRmse),
                                                  percentText(run.localError),
                                                  plainText(run.flip)};
        for (const std::string& cell : cells)
            html += "<td>" + cell + "</td>";
        html += "</tr>\n";
        if (!run.note.empty())
            html +=
                "<tr class=\"note\"><td></td><td colspan=\"10\">" + escapeMarkup(run.note) + "</td></tr>\n";
    }
    return html + "</tbody>\n</table></div>\n";
}

std::string imageTag(const std::string& png, const std::string& description) {
    return "<img alt=\"" + escapeMarkup(description) + "\" src=\"data:image/png;base64," + base64(png) +
           "\">\n";
}

std::string pictures(const MethodsReport& report) {
    std::string html;
    for (const MethodRun& run : report.runs) {
        if (run.picture.empty()) continue;
        const std::string name = nameOf(run);
        html += "<figure>\n" + imageTag(run.picture, "lightmap of " + name);
        if (!run.difference.empty()) html += imageTag(run.difference, "its difference from the reference");
        html += fmt::format("<figcaption>{}, {}²</figcaption>\n</figure>\n", escapeMarkup(name), run.size);
    }
    if (html.empty()) return "";
    std::string text = "As displayed (sRGB).";
    if (report.differenceScale > 0)
        text +=
            fmt::format(" Beside each one its difference from the reference: black none, white {:g} % of the "
                        "mean light and more, grey not covered.",
                        100.0 * report.differenceScale);
    return "<h2>Lightmaps</h2>\n<p>" + text + "</p>\n<div class=\"maps\">\n" + html + "</div>\n";
}

std::string style() {
    return "<style>\n"
           ":root { color-scheme: light dark; --line: #8884; --soft: #8881; }\n"
           "body { font: 16px/1.5 system-ui, sans-serif; max-width: 76rem; margin: 0 auto; padding: 1rem "
           "1.5rem "
           "4rem; background: #fff; color: #1c2024; }\n"
           "@media (prefers-color-scheme: dark) { body { background: #14171a; color: #dfe3e6; } }\n"
           "h1 { font-size: 1.6rem; margin-bottom: 0.2rem; } h2 { margin-top: 2.5rem; } h3 { margin-top: "
           "1.6rem; }\n"
           "dl { display: grid; grid-template-columns: max-content 1fr; gap: 0.15rem 1rem; } dt { opacity: "
           "0.7; "
           "} dd { margin: 0; overflow-wrap: anywhere; }\n"
           "code { font: 0.9em ui-monospace, monospace; }\n"
           ".plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 30rem), 1fr)); "
           "gap: "
           "1.5rem; }\n"
           "figure { margin: 0; } figcaption { font-weight: 600; }\n"
           "ul.legend { list-style: none; padding: 0; margin: 0.3rem 0; display: flex; flex-wrap: wrap; gap: "
           "0.1rem 1.1rem; font-size: 0.85rem; }\n"
           ".wide { overflow-x: auto; }\n"
           "table { border-collapse: collapse; font-variant-numeric: tabular-nums; width: 100%; }\n"
           "th, td { text-align: right; padding: 0.25rem 0.7rem; border-bottom: 1px solid var(--line); "
           "white-space: nowrap; }\n"
           "th:first-child, th:nth-child(2), td:nth-child(2) { text-align: left; } thead th { background: "
           "var(--soft); }\n"
           "tbody th { font-weight: 500; } tr.note td { text-align: left; white-space: normal; font-style: "
           "italic; opacity: 0.8; }\n"
           ".maps { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 22rem), 1fr)); "
           "gap: "
           "1.2rem; }\n"
           ".maps img { width: 49%; image-rendering: pixelated; background: #000; }\n"
           ".maps figcaption { font-weight: 400; font-size: 0.9rem; }\n" +
           plotStyle() + "</style>\n";
}

std::string head(const MethodsReport& report) {
    std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                       "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>"
                       "Radiosity methods: " +
                       escapeMarkup(report.scene) + "</title>\n" + style() +
                       "</head>\n<body>\n<h1>Radiosity " + "methods compared</h1>\n<dl>\n";
    const auto entry = [&](const char* name, const std::string& value, bool code = false) {
        if (value.empty()) return;
        const std::string text = escapeMarkup(value);
        html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", name, code ? "<code>" + text + "</code>" : text);
    };
    entry("scene", report.scene);
    entry("device", report.device);
    entry("driver", report.driver);
    entry("tracer", report.tracer);
    entry("passes", std::to_string(report.passes));
    entry("reference", report.reference);
    entry("version", report.version.empty() ? "" : "relume " + report.version);
    entry("command", report.command, true);
    return html + "</dl>\n";
}

} // namespace

std::string methodsHtml(const MethodsReport& report) {
    std::string html = head(report);
    html += "<h2>Plots</h2>\n<p>Every axis is logarithmic. Numbers beside points are windows, nodes or "
            "samples.</p>"
            "\n<div class=\"plots\">\n" +
            figure(timeOverSize(report));
    for (uint32_t size : sizesOf(report)) {
        const PlotDesc desc = errorOverTime(report, size);
        if (!desc.series.empty()) html += figure(desc);
    }
    html +=
        "</div>\n<h2>Figures</h2>\n<p>Pass: solver time per bounce. Total: from the rasterization of the "
        "lightmap to the finished map, without start-up and loading. DFPR: against pure with as many passes. "
        "relRMSE, local error and FLIP: against the reference. Local error: of each texel relative to its "
        "own light, the 95th percentile.</p>\n";
    for (uint32_t size : sizesOf(report))
        html += tableOf(report, size);
    if (report.runs.empty()) html += "<p>Nothing was measured.</p>\n";
    return html + pictures(report) + "</body>\n</html>\n";
}

nlohmann::ordered_json methodsJson(const MethodsReport& report) {
    using Json = nlohmann::ordered_json;
    const auto number = [](const std::optional<double>& value) -> Json {
        return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
    };
    Json runs = Json::array();
    for (const MethodRun& run : report.runs) {
        Json json = {{"method", run.method},
                     {"setting", run.setting},
                     {"size", run.size},
                     {"patches", run.patches},
                     {"passSeconds", number(run.passSeconds)},
                     {"solveSeconds", number(run.solveSeconds)},
                     {"totalSeconds", number(run.totalSeconds)},
                     {"rays", run.rays ? Json(*run.rays) : Json(nullptr)},
                     {"DFPR", number(run.dfpr)},
                     {"relRMSE", number(run.relRmse)},
                     {"localError", number(run.localError)},
                     {"FLIP", number(run.flip)}};
        if (!run.note.empty()) json["note"] = run.note;
        runs.push_back(std::move(json));
    }
    return {{"version", report.version}, {"scene", report.scene},         {"device", report.device},
            {"driver", report.driver},   {"tracer", report.tracer},       {"passes", report.passes},
            {"command", report.command}, {"reference", report.reference}, {"runs", runs}};
}

std::string methodsTableHead() {
    return fmt::format(fmt::runtime(kTableRow), "method", "setting", "size", "pass", "solver", "total",
                       "rays", "DFPR", "relRMSE", "local error", "FLIP");
}

std::string methodsTableRow(const MethodRun& run) {
    if (!run.solveSeconds)
        return fmt::format("{:<12} {:<16} {:>5} {}\n", run.method, run.setting, run.size, run.note);
    return fmt::format(fmt::runtime(kTableRow), run.method, run.setting, run.size,
                       secondsText(run.passSeconds), secondsText(run.solveSeconds),
                       secondsText(run.totalSeconds), raysText(run.rays), plainText(run.dfpr),
                       percentText(run.relRmse), percentText(run.localError), plainText(run.flip));
}

} // namespace relume
