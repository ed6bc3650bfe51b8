#include "app/text/svg_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <spdlog/fmt/fmt.h>

namespace relume {
namespace {

// Lengths are in units of the view box, about a pixel each at full width.
constexpr double kWidth = 640, kHeight = 400, kLeft = 72, kRight = 28, kTop = 14, kBottom = 52;
constexpr double kMarker = 3.5;
constexpr double kLine = 18; // of text in a file of its own
constexpr size_t kMostTicks = 12;

// People with any colour vision tell these apart [Okabe and Ito 2008]; yellow and black would vanish on light
// and dark pages.
constexpr std::array<const char*, 7> kColours = {"#808890", "#0072b2", "#e69f00", "#009e73",
                                                 "#cc79a7", "#56b4e9", "#d55e00"};
constexpr std::array<const char*, 6> kDashes = {"none", "7 3", "2 2", "9 3 2 3", "1 3", "14 4"};

template<size_t N>
const char* pick(const std::array<const char*, N>& all, int index) {
    return all[static_cast<size_t>(std::max(0, index)) % N];
}

bool isDrawable(const PlotPoint& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && p.x > 0 && p.y > 0;
}

/// One logarithmic axis.
struct Axis {
    double low, high;     // log10 of the ends
    double start, length; // on the page

    double place(double value) const { return start + (std::log10(value) - low) / (high - low) * length; }
};

// Returns an axis that has room around a single value too.
Axis axisOver(double low, double high, double start, double length) {
    constexpr double kMargin = 0.05, kLeast = 0.15; // [decades]
    const double margin = std::max(kMargin * (high - low), kLeast);
    return {low - margin, high + margin, start, length};
}

struct Tick {
    double value;
    bool labelled;
};

// Returns the decades, and where there are few, 2 and 5 between them as well. There are not more labels than
// there is room for.
std::vector<Tick> ticksOf(const Axis& axis) {
    const double span = axis.high - axis.low;
    const int first = static_cast<int>(std::floor(axis.low)), last = static_cast<int>(std::ceil(axis.high));
    const int every = std::max(1, static_cast<int>(std::ceil(span / kMostTicks)));
    std::vector<Tick> ticks;
    for (int decade = first; decade <= last; ++decade) {
        for (double step : {1.0, 2.0, 5.0}) {
            const double value = step * std::pow(10.0, decade);
            if (std::log10(value) < axis.low || std::log10(value) > axis.high) continue;
            if (step == 1.0)
                ticks.push_back({value, (decade - first) % every == 0});
            else if (span < 3.0)
                ticks.push_back({value, span < 2.5});
        }
    }
    return ticks;
}

class Plot {
public:
    explicit Plot(const PlotDesc& desc) : desc_(desc) {
        double lowX = 0, highX = 0, lowY = 0, highY = 0;
        for (const PlotSeries& series : desc.series) {
            for (const PlotPoint& p : series.points) {
                if (!isDrawable(p)) continue;
                const double x = std::log10(p.x), y = std::log10(p.y);
                lowX = any_ ? std::min(lowX, x) : x;
                highX = any_ ? std::max(highX, x) : x;
                lowY = any_ ? std::min(lowY, y) : y;
                highY = any_ ? std::max(highY, y) : y;
                any_ = true;
            }
        }
        x_ = axisOver(lowX, highX, kLeft, kWidth - kLeft - kRight);
        y_ = axisOver(lowY, highY, kHeight - kBottom, -(kHeight - kTop - kBottom));
    }

    std::string draw() {
        out_ = fmt::format("<svg class=\"plot\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n",
                           kWidth, kHeight, escapeMarkup(desc_.title));
        out_ += fmt::format("<title>{}</title>\n", escapeMarkup(desc_.title));
        body();
        return out_ + "</svg>\n";
    }

    std::string drawFile() {
        const double height = kHeight + kLine * (2.0 + static_cast<double>(desc_.series.size()));
        out_ = fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
                           "viewBox=\"0 0 {0} {1}\" color=\"#1c2024\">\n<style>\n{2}</style>\n"
                           "<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
                           kWidth, height, plotStyle());
        text(kWidth / 2, kLine, "middle", desc_.title);
        out_ += fmt::format("<g transform=\"translate(0 {})\">\n", kLine * 1.5);
        body();
        for (size_t i = 0; i < desc_.series.size(); ++i) {
            const double y = kHeight + kLine * static_cast<double>(i);
            out_ += fmt::format("<path class=\"line\" stroke=\"{}\" stroke-dasharray=\"{}\" "
                                "d=\"M{:.1f} {:.1f}h28\"/>\n",
                                pick(kColours, desc_.series[i].colour), pick(kDashes, desc_.series[i].dash),
                                kLeft, y);
            text(kLeft + 36, y + 4, "start", desc_.series[i].name);
        }
        return out_ + "</g>\n</svg>\n";
    }

private:
    void body() {
        if (any_) {
            grid();
            for (const PlotSeries& series : desc_.series)
                line(series);
        } else {
            text(kWidth / 2, kHeight / 2, "middle", "nothing was measured");
        }
        text(kLeft + x_.length / 2, kHeight - 10, "middle", desc_.xLabel);
        out_ += fmt::format("<text transform=\"translate(16 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}"
                            "</text>\n",
                            kTop + (kHeight - kTop - kBottom) / 2, escapeMarkup(desc_.yLabel));
    }

    void text(double x, double y, const char* anchor, const std::string& content) {
        out_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor,
                            escapeMarkup(content));
    }

    void rule(double x1, double y1, double x2, double y2) {
        out_ += fmt::format("<path class=\"grid\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n", x1, y1, x2, y2);
    }

    void grid() {
        const double bottom = kHeight - kBottom, right = kWidth - kRight;
        std::vector<Tick> ticks;
        if (desc_.xTicks.size() <= kMostTicks)
            for (double value : desc_.xTicks)
                ticks.push_back({value, true});
        if (ticks.empty()) ticks = ticksOf(x_);
        for (const Tick& tick : ticks) {
            rule(x_.place(tick.value), kTop, x_.place(tick.value), bottom);
            if (tick.labelled)
                text(x_.place(tick.value), bottom + 17, "middle", fmt::format("{:g}", tick.value));
        }
        for (const Tick& tick : ticksOf(y_)) {
            rule(kLeft, y_.place(tick.value), right, y_.place(tick.value));
            if (tick.labelled)
                text(kLeft - 7, y_.place(tick.value) + 4, "end", fmt::format("{:g}", tick.value));
        }
        out_ += fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}V{:.1f}H{:.1f}\"/>\n", kLeft, kTop,
                            bottom, right);
    }

    void line(const PlotSeries& series) {
        const char* colour = pick(kColours, series.colour);
        std::string path;
        for (const PlotPoint& p : series.points)
            if (isDrawable(p))
                path +=
                    fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x_.place(p.x), y_.place(p.y));
        if (path.empty()) return;
        out_ += fmt::format("<path class=\"line\" stroke=\"{}\" stroke-dasharray=\"{}\" d=\"{}\"/>\n", colour,
                            pick(kDashes, series.dash), path);
        for (const PlotPoint& p : series.points) {
            if (!isDrawable(p)) continue;
            out_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\"><title>{}</title>"
                                "</circle>\n",
                                x_.place(p.x), y_.place(p.y), kMarker, colour,
                                escapeMarkup(p.hint.empty() ? series.name : p.hint));
            if (!p.label.empty()) text(x_.place(p.x) + 6, y_.place(p.y) - 5, "start", p.label);
        }
    }

    const PlotDesc& desc_;
    bool any_ = false;
    Axis x_{}, y_{};
    std::string out_;
};

// Returns the length of the UTF-8 sequence at `at` that XML allows, 0 where there is none.
size_t characterLength(const std::string& text, size_t at) {
    const auto byte = [&](size_t i) {
        return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0u;
    };
    const unsigned lead = byte(0);
    if (lead < 0x80) return lead >= 0x20 || lead == '\t' || lead == '\n' || lead == '\r' ? 1 : 0;
    const size_t length = lead >= 0xc2 && lead < 0xe0   ? 2
                          : lead >= 0xe0 && lead < 0xf0 ? 3
                          : lead < 0xf5                 ? 4
                                                        : 0;
    if (lead < 0xc2 || length == 0) return 0;
    for (size_t i = 1; i < length; ++i)
        if ((byte(i) & 0xc0) != 0x80) return 0;
    // XML excludes overlong forms, surrogates, what is beyond U+10FFFF and non-characters at the end of the
    // first plane.
    if ((lead == 0xe0 && byte(1) < 0xa0) || (lead == 0xed && byte(1) > 0x9f)) return 0;
    if ((lead == 0xf0 && byte(1) < 0x90) || (lead == 0xf4 && byte(1) > 0x8f)) return 0;
    if (lead == 0xef && byte(1) == 0xbf && byte(2) >= 0xbe) return 0;
    return length;
}

} // namespace

std::string escapeMarkup(const std::string& text) {
    std::string out;
    for (size_t i = 0; i < text.size();) {
        const size_t length = characterLength(text, i);
        switch (length == 1 ? text[i] : 'x') {
        case '&':
            out += "&amp;";
            break;
        case '<':
            out += "&lt;";
            break;
        case '>':
            out += "&gt;";
            break;
        case '"':
            out += "&quot;";
            break;
        case '\'':
            out += "&#39;";
            break;
        default:
            if (length == 0)
                out += "\xef\xbf\xbd"; // U+FFFD
            else
                out.append(text, i, length);
        }
        i += std::max<size_t>(1, length);
    }
    return out;
}

std::string logLogPlot(const PlotDesc& desc) {
    return Plot(desc).draw();
}

std::string logLogPlotFile(const PlotDesc& desc) {
    return Plot(desc).drawFile();
}

std::string plotSwatch(const PlotSeries& series) {
    return fmt::format(
        "<svg class=\"swatch\" viewBox=\"0 0 28 10\" aria-hidden=\"true\"><path class=\"line\" "
        "stroke=\"{}\" stroke-dasharray=\"{}\" d=\"M1 5H27\"/></svg>",
        pick(kColours, series.colour), pick(kDashes, series.dash));
}

std::string plotStyle() {
    return "svg.plot { width: 100%; max-width: 46rem; height: auto; }\n"
           "svg.swatch { width: 1.75rem; height: 0.65rem; vertical-align: middle; }\n"
           "svg text { font: 12px system-ui, sans-serif; fill: currentColor; }\n"
           "svg .grid { stroke: currentColor; stroke-opacity: 0.14; fill: none; }\n"
           "svg .axis { stroke: currentColor; stroke-opacity: 0.6; fill: none; }\n"
           "svg .line { fill: none; stroke-width: 1.8; stroke-linejoin: round; }\n";
}

} // namespace relume
