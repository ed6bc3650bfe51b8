#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include <imgui.h>

#include "app/viewer/panels/item_log.h"

namespace relume::ui {

constexpr double kMebi = 1024.0 * 1024.0; // bytes
// A pixel of a drag: share of the scene's diagonal, degrees.
constexpr float kPlaceStep = 0.001f, kAngleStep = 0.5f;

/// Text that is shown when the last control is pointed at.
void tip(const char* text);
/// Tells ItemLog about the last control; framed: its label stands beside it.
void mark(const char* label, bool framed);

// ImGui's controls, told to ItemLog; arguments and results are theirs.
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

/// A table of names and values: row() between beginRows(), where it returns true, and ImGui::EndTable().
bool beginRows(const char* id);
void row(const char* name, const std::string& value);

} // namespace relume::ui
