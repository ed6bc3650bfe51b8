#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "app/text/svg_plot.h"

namespace relume {

/// How far a bake was off after some time. Errors are relRMSE against references.
struct EditErrorPoint {
    double seconds = 0;
    std::optional<double> layer; // of the moved lamp's own light
    double composite = 0;        // of the light of all
    std::optional<double> told;  // what the solver says of the layer
};

/// The figures of an edit of all lamps' intensity and colour.
struct MeasuredWeights {
    double seconds = 0;           // until there is a picture
    uint64_t rays = 0, links = 0; // traced, gathered
    // These compare the sum of layers with fresh bakes with these weights and as many samples: the largest
    // difference, relative to the mean light.
    double maximumOfLayers = 0, maximumOfHybrid = 0;
};

/// The figures of a move of the first lamp.
struct MeasuredMove {
    double firstSeconds = 0; // until there is a picture with its new layer
    double firstLayerError = 0, firstCompositeError = 0;
    std::optional<double> seconds5, seconds2;  // until the layer's error is below 5, 2 %
    double seconds = 0;                        // until the solver says that the error is reached
    double layerError = 0, compositeError = 0; // then
    uint64_t rays = 0;
    double undoSeconds = 0; // until there is a picture with the former layer
    bool undoSameBytes = false;
    std::vector<EditErrorPoint> curve;
};

/// The figures of a bake of the edited scene that starts from nothing.
struct FreshBake {
    std::optional<double> seconds5, seconds2; // until the composite's error is below 5, 2 %
    double seconds = 0;                       // until the solver says that the error is reached
    double compositeError = 0;                // then
    uint64_t rays = 0;
    std::vector<EditErrorPoint> curve;
};

/// The figures of an edit of the base colour of the material with the largest area.
struct MeasuredAlbedo {
    std::string material;
    double firstSeconds = 0;          // until there is a picture of it, all lights in one
    std::optional<double> firstError; // its relRMSE against the picture of all layers
    double seconds = 0;               // until all layers have it
    uint64_t rays = 0;
};

/// The figures of a move of an object with about a hundredth of the triangles, by a twentieth of the
/// diagonal.
struct MeasuredObject {
    std::string object;
    double share = 0;                 // of the triangles
    double followSeconds = 0;         // for patches, triangles and tracer; the times below include it
    double firstSeconds = 0;          // until there is a picture of it, all lights in one
    std::optional<double> firstError; // its relRMSE against the picture of all layers
    double seconds = 0;               // until all layers have the error that they had
    uint64_t rays = 0;
    double freshSeconds = 0; // a fresh bake in layers until it has the error, without what goes before
    double freshPreparation = 0;
    uint64_t freshRays = 0;
    double difference = 0; // between both, relRMSE
};

struct LinkFigures {
    uint64_t bytes = 0;       // kept
    double bytesPerLink = 0;  // of the links of the deepest layer
    double perSecondMove = 0; // gathered, over the moves; time for direct light counts in
    double perSecondAlbedo = 0;
};

/// The medians over runs, with so many lamps.
struct EditsRun {
    uint32_t lamps = 0;
    double firstBakeSeconds = 0;
    MeasuredWeights weights;
    MeasuredMove move;
    FreshBake layers, hybrid;
    std::optional<MeasuredAlbedo> albedo; // none: the scene has no material
    std::optional<MeasuredObject> object; // none: no object can be followed
    LinkFigures links;
};

struct EditsReport {
    std::string scene, device, driver, tracer, version, command, placement;
    uint32_t size = 0, patches = 0, samples = 0, referenceSamples = 0, runs = 0;
    double error = 0;
    double diagonal = 0; // [m]
    bool onlyLamps = true;
    std::vector<EditsRun> counts;
};

double median(std::vector<double> values); // of the middle two the lower one; 0 for none
/// Returns the median of all, or nothing where one is missing.
std::optional<double> median(const std::vector<std::optional<double>>& values);
/// Returns when the error first was below `aim`: the layer's own error, or the composite's.
std::optional<double> secondsTo(const std::vector<EditErrorPoint>& curve, double aim, bool ofLayer);

/// Returns the largest of the counts' times to the first picture after a move over the smallest; 1 for one
/// count.
double flatness(const EditsReport& report);

/// Returns the report as JSON. What is missing is null.
nlohmann::ordered_json editsJson(const EditsReport& report);
/// Returns a table for a terminal, with a line per figure and a column per number of lamps.
std::string editsTable(const EditsReport& report);
/// Returns a plot of error over time after the move with the most lamps, for our bake and both fresh ones.
PlotDesc editsPlot(const EditsReport& report);

} // namespace relume
