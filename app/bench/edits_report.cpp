#include "app/bench/edits_report.h"

#include "assets/base/error.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

namespace relume {
namespace {

using Json = nlohmann::ordered_json;
using Optional = std::optional<double>;

Json number(const Optional& value) {
    return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

// Returns how many times faster it is, or nothing where either is missing.
Optional ratio(const Optional& slow, const Optional& fast) {
    if (!slow || !fast || *fast <= 0) return {};
    return *slow / *fast;
}

Json describe(const std::vector<EditErrorPoint>& curve) {
    Json points = Json::array();
    for (const EditErrorPoint& p : curve)
        points.push_back({{"seconds", p.seconds},
                          {"layerError", number(p.layer)},
                          {"compositeError", number(p.composite)},
                          {"toldError", number(p.told)}});
    return points;
}

Json describe(const FreshBake& bake, const MeasuredMove& move) {
    return {{"secondsTo5Percent", number(bake.seconds5)},
            {"secondsTo2Percent", number(bake.seconds2)},
            {"seconds", bake.seconds},
            {"compositeError", number(bake.compositeError)},
            {"rays", bake.rays},
            {"overMove", number(ratio(bake.seconds, move.seconds))},
            {"overMoveTo5Percent", number(ratio(bake.seconds5, move.seconds5))},
            {"overMoveTo2Percent", number(ratio(bake.seconds2, move.seconds2))},
            {"curve", describe(bake.curve)}};
}

Json describe(const EditsRun& run) {
    const MeasuredWeights& w = run.weights;
    const MeasuredMove& m = run.move;
    Json json = {{"lamps", run.lamps}, {"firstBakeSeconds", run.firstBakeSeconds}};
    json["weights"] = {{"seconds", w.seconds},
                       {"rays", w.rays},
                       {"links", w.links},
                       {"maximumOverMean", number(w.maximumOfLayers)},
                       {"maximumOverMeanOfHybrid", number(w.maximumOfHybrid)}};
    json["move"] = {{"firstSeconds", m.firstSeconds},
                    {"firstLayerError", number(m.firstLayerError)},
                    {"firstCompositeError", number(m.firstCompositeError)},
                    {"secondsTo5Percent", number(m.seconds5)},
                    {"secondsTo2Percent", number(m.seconds2)},
                    {"seconds", m.seconds},
                    {"layerError", number(m.layerError)},
                    {"compositeError", number(m.compositeError)},
                    {"rays", m.rays},
                    {"curve", describe(m.curve)}};
    json["undo"] = {{"seconds", m.undoSeconds}, {"sameBytes", m.undoSameBytes}};
    json["freshLayers"] = describe(run.layers, m);
    json["freshHybrid"] = describe(run.hybrid, m);
    json["albedo"] = nullptr;
    if (run.albedo)
        json["albedo"] = {{"material", run.albedo->material},
                          {"firstSeconds", run.albedo->firstSeconds},
                          {"firstError", number(run.albedo->firstError)},
                          {"seconds", run.albedo->seconds},
                          {"rays", run.albedo->rays}};
    json["object"] = nullptr;
    if (run.object)
        json["object"] = {{"object", run.object->object},
                          {"shareOfTriangles", run.object->share},
                          {"followSeconds", run.object->followSeconds},
                          {"firstSeconds", run.object->firstSeconds},
                          {"firstError", number(run.object->firstError)},
                          {"seconds", run.object->seconds},
                          {"rays", run.object->rays},
                          {"freshSeconds", run.object->freshSeconds},
                          {"freshPreparationSeconds", run.object->freshPreparation},
                          {"freshRays", run.object->freshRays},
                          {"difference", number(run.object->difference)},
                          {"overObject", number(ratio(run.object->freshSeconds, run.object->seconds))},
                          {"overFirst", number(ratio(run.object->freshSeconds, run.object->firstSeconds))}};
    json["links"] = {{"bytes", run.links.bytes},
                     {"bytesPerLink", number(run.links.bytesPerLink)},
                     {"perSecondMove", number(run.links.perSecondMove)},
                     {"perSecondAlbedo", number(run.links.perSecondAlbedo)}};
    return json;
}

std::string time(const Optional& seconds) {
    if (!seconds || !std::isfinite(*seconds)) return "–";
    return *seconds < 1.0 ? fmt::format("{:.3g} ms", 1000.0 * *seconds) : fmt::format("{:.3g} s", *seconds);
}

std::string percent(const Optional& value) {
    return value && std::isfinite(*value) ? fmt::format("{:.3g} %", 100.0 * *value) : "–";
}

std::string times(const Optional& value) {
    return value ? fmt::format("{:.3g} x", *value) : "–";
}

struct ReportRow {
    const char* name;
    std::function<std::string(const EditsRun&)> text;
};

std::vector<ReportRow> freshRows() {
    using Run = const EditsRun&;
    return {
        {"fresh, layers: to the error", [](Run r) { return time(r.layers.seconds); }},
        {"  composite's error", [](Run r) { return percent(r.layers.compositeError); }},
        {"  to 5 % of the composite", [](Run r) { return time(r.layers.seconds5); }},
        {"  to 2 % of the composite", [](Run r) { return time(r.layers.seconds2); }},
        {"  over the move", [](Run r) { return times(ratio(r.layers.seconds, r.move.seconds)); }},
        {"  over the move, both to 2 %",
         [](Run r) { return times(ratio(r.layers.seconds2, r.move.seconds2)); }},
        {"fresh, hybrid: to the error", [](Run r) { return time(r.hybrid.seconds); }},
        {"  composite's error", [](Run r) { return percent(r.hybrid.compositeError); }},
        {"  to 5 % of the composite", [](Run r) { return time(r.hybrid.seconds5); }},
        {"  to 2 % of the composite", [](Run r) { return time(r.hybrid.seconds2); }},
        {"  over the move", [](Run r) { return times(ratio(r.hybrid.seconds, r.move.seconds)); }},
        {"  over the move, both to 2 %",
         [](Run r) { return times(ratio(r.hybrid.seconds2, r.move.seconds2)); }},
    };
}

std::vector<ReportRow> objectRows() {
    using Run = const EditsRun&;
    const auto row = [](const char* name, const std::function<std::string(const MeasuredObject&)>& text) {
        return ReportRow{name, [text](Run r) { return r.object ? text(*r.object) : std::string("–"); }};
    };
    using Edit = const MeasuredObject&;
    return {
        row("object: share of triangles", [](Edit e) { return percent(e.share); }),
        row("  moved: patches and tracer after", [](Edit e) { return time(e.followSeconds); }),
        row("  first picture after", [](Edit e) { return time(e.firstSeconds); }),
        row("  off all layers'", [](Edit e) { return percent(e.firstError); }),
        row("  all layers after", [](Edit e) { return time(e.seconds); }),
        row("  rays", [](Edit e) { return std::to_string(e.rays); }),
        row("  fresh, layers: to the error", [](Edit e) { return time(e.freshSeconds); }),
        row("  over the first picture", [](Edit e) { return times(ratio(e.freshSeconds, e.firstSeconds)); }),
        row("  over the object", [](Edit e) { return times(ratio(e.freshSeconds, e.seconds)); }),
        row("  off the fresh layers", [](Edit e) { return percent(e.difference); }),
    };
}

std::vector<ReportRow> rows() {
    using Run = const EditsRun&;
    std::vector<ReportRow> all = {
        {"lamps", [](Run r) { return std::to_string(r.lamps); }},
        {"first bake", [](Run r) { return time(r.firstBakeSeconds); }},
        {"weights: picture after", [](Run r) { return time(r.weights.seconds); }},
        {"  rays / links", [](Run r) { return fmt::format("{} / {}", r.weights.rays, r.weights.links); }},
        {"  off fresh layers, at most", [](Run r) { return percent(r.weights.maximumOfLayers); }},
        {"  off fresh hybrid, at most", [](Run r) { return percent(r.weights.maximumOfHybrid); }},
        {"move: first picture after", [](Run r) { return time(r.move.firstSeconds); }},
        {"  its layer's error", [](Run r) { return percent(r.move.firstLayerError); }},
        {"  the composite's", [](Run r) { return percent(r.move.firstCompositeError); }},
        {"  to 5 % of the layer", [](Run r) { return time(r.move.seconds5); }},
        {"  to 2 % of the layer", [](Run r) { return time(r.move.seconds2); }},
        {"  to the error, as told", [](Run r) { return time(r.move.seconds); }},
        {"  its layer's error then", [](Run r) { return percent(r.move.layerError); }},
        {"  the composite's then", [](Run r) { return percent(r.move.compositeError); }},
        {"undo: picture after", [](Run r) { return time(r.move.undoSeconds); }},
        {"  same bytes", [](Run r) { return std::string(r.move.undoSameBytes ? "yes" : "no"); }},
    };
    for (ReportRow& row : freshRows())
        all.push_back(std::move(row));
    const std::vector<ReportRow> rest = {
        {"albedo: first picture after", [](Run r) { return r.albedo ? time(r.albedo->firstSeconds) : "–"; }},
        {"  off all layers'", [](Run r) { return r.albedo ? percent(r.albedo->firstError) : "–"; }},
        {"  all layers after", [](Run r) { return r.albedo ? time(r.albedo->seconds) : "–"; }},
        {"  rays", [](Run r) { return r.albedo ? std::to_string(r.albedo->rays) : "–"; }},
    };
    all.insert(all.end(), rest.begin(), rest.end());
    for (ReportRow& row : objectRows())
        all.push_back(std::move(row));
    const std::vector<ReportRow> links = {
        {"links: memory",
         [](Run r) { return fmt::format("{:.1f} MiB", static_cast<double>(r.links.bytes) / 1048576.0); }},
        {"  bytes each", [](Run r) { return fmt::format("{:.3g}", r.links.bytesPerLink); }},
        {"  G/s over moves", [](Run r) { return fmt::format("{:.3g}", 1e-9 * r.links.perSecondMove); }},
        {"  G/s over albedo edits",
         [](Run r) { return fmt::format("{:.3g}", 1e-9 * r.links.perSecondAlbedo); }},
    };
    all.insert(all.end(), links.begin(), links.end());
    return all;
}

// Returns the error over time, from the points that have one.
PlotSeries seriesOf(const char* name, int colour, const std::vector<EditErrorPoint>& curve, bool ofLayer) {
    PlotSeries series{.name = name, .colour = colour, .dash = ofLayer ? 1 : 0};
    for (const EditErrorPoint& p : curve) {
        const Optional error = ofLayer ? p.layer : Optional(p.composite);
        if (!error) continue;
        series.points.push_back(
            {.x = p.seconds,
             .y = *error,
             .hint = fmt::format("{}: {} after {}", name, percent(error), time(p.seconds))});
    }
    return series;
}

} // namespace

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

Optional median(const std::vector<Optional>& values) {
    std::vector<double> present;
    for (const Optional& value : values) {
        if (!value) return {};
        present.push_back(*value);
    }
    return present.empty() ? Optional() : median(std::move(present));
}

Optional secondsTo(const std::vector<EditErrorPoint>& curve, double aim, bool ofLayer) {
    for (const EditErrorPoint& p : curve) {
        const Optional error = ofLayer ? p.layer : Optional(p.composite);
        if (error && *error <= aim) return p.seconds;
    }
    return {};
}

double flatness(const EditsReport& report) {
    ASSERT(!report.counts.empty());
    const auto [least, most] = std::minmax_element(
        report.counts.begin(), report.counts.end(),
        [](const EditsRun& a, const EditsRun& b) { return a.move.firstSeconds < b.move.firstSeconds; });
    return ratio(most->move.firstSeconds, least->move.firstSeconds).value_or(1.0);
}

Json editsJson(const EditsReport& report) {
    Json counts = Json::array();
    for (const EditsRun& run : report.counts)
        counts.push_back(describe(run));
    return {{"version", report.version},
            {"scene", report.scene},
            {"command", report.command},
            {"device", report.device},
            {"driver", report.driver},
            {"tracer", report.tracer},
            {"size", report.size},
            {"patches", report.patches},
            {"error", report.error},
            {"samples", report.samples},
            {"referenceSamples", report.referenceSamples},
            {"runs", report.runs},
            {"diagonal", report.diagonal},
            {"lamps", report.placement},
            {"onlyLamps", report.onlyLamps},
            {"counts", counts},
            {"firstPictureMostOverLeast", flatness(report)}};
}

std::string editsTable(const EditsReport& report) {
    std::string text;
    for (const ReportRow& row : rows()) {
        text += fmt::format("{:<30}", row.name);
        for (const EditsRun& run : report.counts)
            text += fmt::format(" {:>12}", row.text(run));
        text += "\n";
    }
    return text + fmt::format("first picture of a move, most over least: {:.3g}\n", flatness(report));
}

PlotDesc editsPlot(const EditsReport& report) {
    ASSERT(!report.counts.empty());
    const EditsRun& run =
        *std::max_element(report.counts.begin(), report.counts.end(),
                          [](const EditsRun& a, const EditsRun& b) { return a.lamps < b.lamps; });
    return {.title = fmt::format("One of {} lamps moved: error over time, {}², {}", run.lamps, report.size,
                                 report.device),
            .xLabel = "time after the edit [s]",
            .yLabel = "relRMSE against the reference",
            .series = {seriesOf("moved: all light", 1, run.move.curve, false),
                       seriesOf("moved: the lamp's own light", 1, run.move.curve, true),
                       seriesOf("restarted, layers", 2, run.layers.curve, false),
                       seriesOf("restarted, hybrid", 0, run.hybrid.curve, false)},
            .xTicks = {}};
}

} // namespace relume
