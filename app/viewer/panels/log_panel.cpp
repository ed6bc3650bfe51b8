#include "app/viewer/panels/log_panel.h"

#include "app/viewer/panels/widgets.h"

#include <imgui.h>

namespace relume {

void drawLogPanel(const PanelContext& context) {
    const std::vector<LogLine> lines = context.log.lines();
    if (ui::button("Copy")) {
        std::string all;
        for (const LogLine& line : lines)
            all += line.text + "\n";
        ImGui::SetClipboardText(all.c_str());
    }
    ImGui::BeginChild("lines");
    const bool atEnd = ImGui::GetScrollY() >= ImGui::GetScrollMaxY();
    for (const LogLine& line : lines) {
        const bool bad = line.level >= spdlog::level::err, odd = line.level == spdlog::level::warn;
        const ImVec4 colour = bad   ? ImVec4(1.0f, 0.45f, 0.4f, 1.0f)
                              : odd ? ImVec4(1.0f, 0.8f, 0.4f, 1.0f)
                                    : ImGui::GetStyleColorVec4(ImGuiCol_Text);
        ImGui::PushStyleColor(ImGuiCol_Text, colour);
        ImGui::PushTextWrapPos(0.0f);
        ImGui::TextUnformatted(line.text.c_str());
        ImGui::PopTextWrapPos();
        ImGui::PopStyleColor();
    }
    if (atEnd) ImGui::SetScrollHereY(1.0f); // follows the newest unless one reads further up
    ImGui::EndChild();
}

} // namespace relume
