#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include <imgui.h>

#include "app/viewer/panels/item_log.h"

namespace relume::ui {

constexpr double kMebi = 1024.0 * 1024.0; // bytes
// A drag changes a place and an angle by so much per pixel: a share of the scene's diagonal, and degrees.
constexpr float kPlaceStep = 0.001f, kAngleStep = 0.5f;

/// Shows a text when the last control is pointed at.
void tip(const char* text);
/// Tells ItemLog, and the order in which Tab goes, about the last control. `framed` says that its label
/// stands beside it.
void mark(const char* label, bool framed);

// These are ImGui's controls, which are also told to ItemLog; arguments and results are ImGui's.
template<typename... Rest>
bool button(const char* label, Rest... rest) {
    const bool result = ImGui::Button(label, rest...);
    mark(label, false);
    return result;
}
template<typename... Rest>
bool checkbox(const char* label, Rest... rest) {
    const bool result = ImGui::Checkbox(label, rest...);
    mark(label, false);
    return result;
}
template<typename... Rest>
bool selectable(const char* label, Rest... rest) {
    const bool result = ImGui::Selectable(label, rest...);
    mark(label, false);
    return result;
}
template<typename... Rest>
bool header(const char* label, Rest... rest) {
    const bool result = ImGui::CollapsingHeader(label, rest...);
    mark(label, false);
    return result;
}
template<typename... Rest>
bool sliderFloat(const char* label, Rest... rest) {
    const bool result = ImGui::SliderFloat(label, rest...);
    mark(label, true);
    return result;
}
template<typename... Rest>
bool sliderInt(const char* label, Rest... rest) {
    const bool result = ImGui::SliderInt(label, rest...);
    mark(label, true);
    return result;
}
template<typename... Rest>
bool dragFloat(const char* label, Rest... rest) {
    const bool result = ImGui::DragFloat(label, rest...);
    mark(label, true);
    return result;
}
template<typename... Rest>
bool colour(const char* label, Rest... rest) {
    const bool result = ImGui::ColorEdit3(label, rest...);
    mark(label, true);
    return result;
}

/// Draws a list to choose from. Returns whether the choice changed.
bool combo(const char* label, size_t& index, std::span<const char* const> names);
bool combo(const char* label, size_t& index, const std::vector<std::string>& names);
/// Does the same for whole numbers; a value that is none of them is shown all the same.
bool combo(const char* label, uint32_t& value, std::span<const uint32_t> values);
/// Draws a field for a number that is typed. Returns whether it was finished.
bool number(const char* label, double& value, const char* format);
bool number(const char* label, uint32_t& value);

/// While it lives, it greys out and disables what is drawn.
class Disabled {
public:
    explicit Disabled(bool on) { ImGui::BeginDisabled(on); }
    ~Disabled() { ImGui::EndDisabled(); }
    Disabled(const Disabled&) = delete;
    Disabled& operator=(const Disabled&) = delete;
};

/// Begins a table of names and values: where beginRows() returns true, row() follows and then
/// ImGui::EndTable().
bool beginRows(const char* id);
void row(const char* name, const std::string& value);

} // namespace relume::ui
