#include "app/offline/progress.h"
#include "app/viewer/panels/bake_panel.h"
#include "app/viewer/panels/convergence_plot.h"
#include "app/viewer/panels/widgets.h"

#include <fmt/format.h>
#include <imgui.h>

namespace relume {
namespace {

using Phase = BakeStatus::Phase;

void button(const PanelContext& context, const char* label, Action action, bool enabled) {
    {
        const ui::Disabled disabled(!enabled);
        if (ui::button(label)) context.perform(action, 0);
    }
    const Shortcut& shortcut = shortcutOf(action);
    ui::tip((shortcut.name + " (" + keyText(shortcut) + ")").c_str());
}

void drawButtons(const PanelContext& context) {
    const Phase phase = context.status.phase;
    const bool bakes = phase == Phase::Baking || phase == Phase::Paused || phase == Phase::Done;
    button(context, "Make pass", Action::MakePass, bakes);
    ImGui::SameLine();
    button(context, phase == Phase::Paused ? "Resume" : "Pause", Action::Pause, bakes);
    ImGui::SameLine();
    button(context, "Step", Action::Step, bakes);
    ImGui::SameLine();
    button(context, "Reset", Action::Reset, bakes);
    ImGui::SameLine();
    button(context, "Abort", Action::Close, phase == Phase::Baking);
}

} // namespace

void drawBakeProgress(const PanelContext& context) {
    const BakeStatus& status = context.status;
    const SolverProgress& progress = status.progress;
    drawButtons(context);
    if (ui::beginRows("progress")) {
        const std::string doing = status.doing.empty() ? "" : ": " + status.doing;
        ui::row("State", phaseName(status.phase) + doing);
        const bool pairs = isPairMethod(status.settings.solver.method);
        if (pairs)
            ui::row("Pass",
                    fmt::format("{}, {:.0f} % of the next", progress.passes, 100.0 * progress.passFraction));
        else
            ui::row("Directions", fmt::format("{} per patch", progress.samples));
        ui::row("Error left", progress.error < 1.0 ? fmt::format("{:.3g}", progress.error) : "not known yet");
        if (!pairs)
            ui::row("Local error left", progress.localError95 < 1.0
                                            ? fmt::format("{:.3g}; of 1 % of texels more than {:.3g}",
                                                          progress.localError95, progress.localError99)
                                            : "not known yet");
        ui::row("Rays", fmt::format("{:.1f} M/s", status.raysPerSecond * 1e-6));
        ui::row("Time", formatDuration(progress.seconds));
        if (status.phase == Phase::Baking)
            ui::row("Left", status.secondsLeft < 0 ? "?" : formatDuration(status.secondsLeft));
        ui::row("Patches", std::to_string(status.patches));
        ui::row("Device", status.device);
        ui::row("Tracer", status.tracer);
        ui::row("Display", status.display);
        ImGui::EndTable();
    }
    drawConvergencePlot(status.history, status.settings.solver.error, status.settings.solver.localError);
}

} // namespace relume
