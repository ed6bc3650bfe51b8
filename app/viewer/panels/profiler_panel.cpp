#include "app/viewer/panels/profiler_panel.h"

#include "app/viewer/panels/widgets.h"

#include <algorithm>

#include <fmt/format.h>
#include <imgui.h>

namespace relume {
namespace {

void drawFrames(const FrameFigures& figures) {
    const float most = std::max(*std::max_element(figures.frames.begin(), figures.frames.end()), 1.0f);
    const std::string title = fmt::format("{:.1f} ms, at most {:.1f} ms", figures.total, most);
    ImGui::PlotLines("##frames", figures.frames.data(), static_cast<int>(FrameFigures::kKept),
                     static_cast<int>(figures.next), title.c_str(), 0.0f, most,
                     {ImGui::GetContentRegionAvail().x, 5 * ImGui::GetTextLineHeight()});
    ImGui::TextWrapped("%s", fmt::format("{} pictures of the scene, {} shown again; {} draws, {} culled",
                                         figures.drawn, figures.repeated, figures.drawCalls, figures.culled)
                                 .c_str());
    if (!ImGui::BeginTable("spans", 3, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingStretchProp)) return;
    ImGui::TableSetupColumn("Pass");
    ImGui::TableSetupColumn("CPU [ms]");
    ImGui::TableSetupColumn("GPU [ms]");
    ImGui::TableHeadersRow();
    for (const FrameFigures::Span& span : figures.spans) {
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(span.name.c_str());
        ImGui::TableNextColumn();
        ImGui::Text("%.2f", span.cpu);
        ImGui::TableNextColumn();
        if (span.gpu >= 0)
            ImGui::Text("%.2f", span.gpu);
        else
            ImGui::TextUnformatted("-");
    }
    ImGui::EndTable();
}

void drawBake(const BakeStatus& status) {
    const SolverProgress& progress = status.progress;
    if (!ui::beginRows("bake")) return;
    ui::row("Solving", fmt::format("{:.2f} s", progress.seconds));
    ui::row("Tracing", fmt::format("{:.2f} s", progress.traceSeconds));
    ui::row("Gathering", fmt::format("{:.2f} s", progress.gatherSeconds));
    ui::row("Rays", fmt::format("{:.4g}", static_cast<double>(progress.rays)));
    ui::row("Saved by the cache", fmt::format("{:.4g}", static_cast<double>(progress.raysSaved)));
    ui::row("Pairs or links gathered", fmt::format("{:.4g}", static_cast<double>(progress.pairs)));
    ui::row("Cache",
            fmt::format("{:.1f} MiB, {:.0f} % of a pass",
                        static_cast<double>(progress.cacheBytes) / ui::kMebi, 100.0 * progress.cachedShare));
    if (status.deviceBytes > 0)
        ui::row("Device memory", fmt::format("{:.1f} MiB; all programs {:.0f} MiB",
                                             static_cast<double>(status.bakeBytes) / ui::kMebi,
                                             static_cast<double>(status.deviceBytes) / ui::kMebi));
    if (status.hostBytes > 0)
        ui::row("Host memory for the device",
                fmt::format("{:.1f} MiB", static_cast<double>(status.hostBytes) / ui::kMebi));
    if (status.ballBytes > 0)
        ui::row("Ball and probes",
                fmt::format("{:.1f} MiB", static_cast<double>(status.ballBytes) / ui::kMebi));
    if (status.validationMessages > 0)
        ui::row("Validation messages", std::to_string(status.validationMessages));
    const size_t count = progress.passSeconds.size();
    constexpr size_t kShown = 12; // passes, the newest
    for (size_t i = count > kShown ? count - kShown : 0; i < count; ++i)
        ui::row(fmt::format("Pass {}", i + 1).c_str(), fmt::format("{:.3f} s", progress.passSeconds[i]));
    ImGui::EndTable();
}

} // namespace

void drawProfilerPanel(const PanelContext& context) {
    if (ui::header("Frames", ImGuiTreeNodeFlags_DefaultOpen)) drawFrames(context.figures);
    if (ui::header("Bake", ImGuiTreeNodeFlags_DefaultOpen)) drawBake(context.status);
}

} // namespace relume
