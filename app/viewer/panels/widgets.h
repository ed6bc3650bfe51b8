#pragma once

#include <span>
#include <string>
#include <vector>

#include <imgui.h>

namespace relume::ui {

/// A question mark's text when the last item is pointed at.
void tip(const char* text);
/// A list to choose from; true when the choice changed.
bool combo(const char* label, size_t& index, std::span<const char* const> names);
bool combo(const char* label, size_t& index, const std::vector<std::string>& names);
/// The same of whole numbers; a value that is none of them is shown all the same.
bool combo(const char* label, uint32_t& value, std::span<const uint32_t> values);
/// A number that is typed; true when it was finished.
bool number(const char* label, double& value, const char* format);
bool number(const char* label, uint32_t& value);
/// Greys out and disables what comes until it goes.
class Disabled {
public:
    explicit Disabled(bool on) { ImGui::BeginDisabled(on); }
    ~Disabled() { ImGui::EndDisabled(); }
    Disabled(const Disabled&) = delete;
    Disabled& operator=(const Disabled&) = delete;
};
/// A row of a two-column table.
void row(const char* name, const std::string& value);
bool beginRows(const char* id);

} // namespace relume::ui
