#include "app/viewer/panels/widgets.h"

#include "app/viewer/panels/tab_order.h"

#include <algorithm>

namespace relume::ui {

void tip(const char* text) {
    if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(ImGui::GetFontSize() * 22.0f);
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

void mark(const char* label, bool framed) {
    if (TabOrder* order = TabOrder::current()) order->add();
    ItemLog* log = ItemLog::current();
    if (log == nullptr || !ImGui::IsItemVisible()) return;
    if (ImGui::IsItemFocused()) log->focused(label);
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    const float width = framed ? ImGui::CalcItemWidth() : high.x - low.x;
    log->add(label, {static_cast<int>(low.x + 0.5f * width), static_cast<int>(0.5f * (low.y + high.y))});
}

bool combo(const char* label, size_t& index, std::span<const char* const> names) {
    bool changed = false;
    const bool open = ImGui::BeginCombo(label, index < names.size() ? names[index] : "");
    if (!open) mark(label, true);
    if (!open) return false;
    for (size_t i = 0; i < names.size(); ++i) {
        if (selectable(names[i], i == index) && i != index) {
            index = i;
            changed = true;
        }
        if (i == index) ImGui::SetItemDefaultFocus();
    }
    ImGui::EndCombo();
    return changed;
}

bool combo(const char* label, size_t& index, const std::vector<std::string>& names) {
    std::vector<const char*> pointers;
    for (const std::string& name : names)
        pointers.push_back(name.c_str());
    return combo(label, index, std::span<const char* const>(pointers));
}

bool combo(const char* label, uint32_t& value, std::span<const uint32_t> values) {
    bool changed = false;
    const bool open = ImGui::BeginCombo(label, std::to_string(value).c_str());
    if (!open) mark(label, true);
    if (!open) return false;
    for (const uint32_t choice : values) {
        if (selectable(std::to_string(choice).c_str(), choice == value) && choice != value) {
            value = choice;
            changed = true;
        }
    }
    ImGui::EndCombo();
    return changed;
}

bool number(const char* label, double& value, const char* format) {
    ImGui::InputDouble(label, &value, 0.0, 0.0, format);
    mark(label, true);
    return ImGui::IsItemDeactivatedAfterEdit();
}

bool number(const char* label, uint32_t& value) {
    ImGui::InputScalar(label, ImGuiDataType_U32, &value);
    mark(label, true);
    return ImGui::IsItemDeactivatedAfterEdit();
}

bool beginRows(const char* id) {
    if (!ImGui::BeginTable(id, 2, ImGuiTableFlags_RowBg)) return false;
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthFixed);
    ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch); // wraps
    return true;
}

void row(const char* name, const std::string& value) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(name);
    ImGui::TableNextColumn();
    ImGui::PushTextWrapPos();
    ImGui::TextUnformatted(value.c_str());
    ImGui::PopTextWrapPos();
}

} // namespace relume::ui
