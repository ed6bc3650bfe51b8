#include "app/viewer/panels/convergence_plot.h"

#include "app/viewer/state/fitting_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

namespace relume {
namespace {

constexpr float kHeightLines = 8; // of text
constexpr double kLeastError = 1e-7;

struct Axes {
    ImVec2 low, high;                         // corners on screen: y grows downwards
    double seconds = 1, top = 0, bottom = -2; // exponents of ten

    ImVec2 at(double time, double error) const {
        const double x = time / seconds;
        const double y = (top - std::log10(std::max(error, kLeastError))) / (top - bottom);
        return {low.x + static_cast<float>(x) * (high.x - low.x),
                low.y + static_cast<float>(std::clamp(y, 0.0, 1.0)) * (high.y - low.y)};
    }
};

bool isLocalTold(const ConvergencePoint& point) {
    return point.localError < 1;
}

Axes axesOf(const std::vector<ConvergencePoint>& history, double aim) {
    Axes axes;
    double least = aim > 0 ? aim : 0.1, most = 0.1;
    for (const ConvergencePoint& point : history) {
        least = std::min(least, std::max(point.error, kLeastError));
        most = std::max(most, point.error);
        if (isLocalTold(point)) most = std::max(most, point.localError);
    }
    axes.seconds = std::max(history.empty() ? 1.0 : history.back().seconds, 1e-3);
    axes.top = std::ceil(std::log10(most));
    axes.bottom = std::min(std::floor(std::log10(least)), axes.top - 1);
    return axes;
}

void drawCurve(ImDrawList& list, const std::vector<ImVec2>& points, ImU32 color) {
    if (points.size() > 1)
        list.AddPolyline(points.data(), static_cast<int>(points.size()), color, ImDrawFlags_None, 1.5f);
    else if (points.size() == 1)
        list.AddCircleFilled(points.front(), 2.0f, color);
}

} // namespace

void drawConvergencePlot(const std::vector<ConvergencePoint>& history, double aim, double localAim) {
    const float line = ImGui::GetTextLineHeight();
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const ImVec2 size(std::max(ImGui::GetContentRegionAvail().x, 4 * line), kHeightLines * line);
    ImGui::Dummy(size);
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImU32 frame = ImGui::GetColorU32(ImGuiCol_FrameBg),
                text = ImGui::GetColorU32(ImGuiCol_TextDisabled);
    const ImU32 curve = ImGui::GetColorU32(ImGuiCol_PlotLines), grid = ImGui::GetColorU32(ImGuiCol_Border);
    const ImU32 goal = IM_COL32(110, 190, 110, 200);
    list->AddRectFilled(corner, {corner.x + size.x, corner.y + size.y}, frame);
    Axes axes = axesOf(history, aim);
    axes.low = {corner.x + 3.2f * line, corner.y + 0.5f * line};
    axes.high = {corner.x + size.x - 0.5f * line, corner.y + size.y - 1.4f * line};
    for (double decade = axes.bottom; decade <= axes.top; decade += 1) {
        const ImVec2 at = axes.at(0, std::pow(10.0, decade));
        list->AddLine(at, {axes.high.x, at.y}, grid);
        list->AddText({corner.x + 0.2f * line, at.y - 0.5f * line}, text,
                      fmt::format("{:g}", std::pow(10.0, decade)).c_str());
    }
    const ImU32 paleCurve = ImGui::GetColorU32(ImGuiCol_PlotLines, 0.5f),
                paleGoal = IM_COL32(110, 190, 110, 90);
    if (aim > 0) list->AddLine(axes.at(0, aim), axes.at(axes.seconds, aim), goal);
    std::vector<ImVec2> points, local;
    for (const ConvergencePoint& point : history) {
        points.push_back(axes.at(point.seconds, point.error));
        if (isLocalTold(point)) local.push_back(axes.at(point.seconds, point.localError));
    }
    if (localAim > 0 && !local.empty())
        list->AddLine(axes.at(0, localAim), axes.at(axes.seconds, localAim), paleGoal);
    drawCurve(*list, local, paleCurve);
    drawCurve(*list, points, curve);
    const std::string end = history.empty() ? "" : fmt::format("{:.3g} s", axes.seconds);
    const float endWidth = ImGui::CalcTextSize(end.c_str()).x, gap = end.empty() ? 0.0f : line;
    const std::vector<std::string> captions =
        local.empty() ? std::vector<std::string>{"error left over seconds of solving", "error left", "error"}
                      : std::vector<std::string>{"error and, paler, local error left over seconds",
                                                 "error; paler: local error", "error; local error", "error"};
    const std::string caption = firstThatFits(captions, [&](const std::string& candidate) {
        return axes.low.x + ImGui::CalcTextSize(candidate.c_str()).x + gap + endWidth <= axes.high.x;
    });
    list->AddText({axes.low.x, axes.high.y + 0.1f * line}, text, caption.c_str());
    list->AddText({axes.high.x - endWidth, axes.high.y + 0.1f * line}, text, end.c_str());
}

} // namespace relume
