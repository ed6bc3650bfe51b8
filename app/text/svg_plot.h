#pragma once

#include <string>
#include <vector>

namespace relume {

struct PlotPoint {
    double x = 0, y = 0;    // > 0 and finite, else the point is left out
    std::string label = {}; // beside the point; may be empty
    std::string hint = {};  // shown when the mouse rests on it
};

struct PlotSeries {
    std::string name;
    int colour = 0; // index of a colour; equal for what belongs together
    int dash = 0;   // index of a pattern of strokes
    std::vector<PlotPoint> points = {};
};

struct PlotDesc {
    std::string title, xLabel, yLabel;
    std::vector<PlotSeries> series = {};
    std::vector<double> xTicks = {}; // none: decades
};

/// Returns text as HTML and SVG take it, in elements and quoted attributes. Bytes that are not UTF-8 or not
/// allowed in XML become U+FFFD.
std::string escapeMarkup(const std::string& text);

/// Returns an <svg> element with both axes logarithmic: a line and markers for each series, no legend.
/// Colours come from plotStyle().
std::string logLogPlot(const PlotDesc& desc);

/// Returns the same as an SVG file of its own: on white, with title and legend.
std::string logLogPlotFile(const PlotDesc& desc);

/// Returns a small <svg> that shows a series' colour and dash, for legends.
std::string plotSwatch(const PlotSeries& series);

/// Returns the CSS of the plots, for light and dark pages.
std::string plotStyle();

} // namespace relume
