#include "app/viewer/panels/lights_panel.h"

#include "app/live/layer_remark.h"
#include "app/viewer/edits/light_edits.h"
#include "app/viewer/panels/widgets.h"
#include "assets/model/black_body.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

namespace relume {
namespace {

using Kind = LightKey::Kind;

// A drag changes a strength and a temperature by so much per pixel: a share of the strength, and kelvin.
constexpr float kStrengthStep = 0.01f, kKelvinStep = 20.0f;
constexpr float kLeastStep = 0.001f; // of strengths near 0
constexpr float kMostStrength = 1e9f;
// Mesh lights and a sky of no strength are no lights and would leave the board, so this is the least: mute
// makes them dark.
constexpr float kLeastStrength = 1e-3f; // [cd/m^2]
// A colour may be off by these shares of its largest channel: kSame where one sees no difference from a black
// body's, kLike where it is only similar.
constexpr float kSame = 0.02f, kLike = 0.2f;
constexpr float kDaylight = 6500.0f; // [K], where a colour is nothing like a black body's
constexpr float kBoardShare = 0.55f; // of the panel's height, at most
constexpr ImGuiSliderFlags kClamp = ImGuiSliderFlags_AlwaysClamp;

/// Edits one light, and names the edit after it.
class LightEditor {
public:
    LightEditor(const PanelContext& context, const LightSource& source)
        : context_(context), source_(source), next(context.session.document()) {}

    /// Follows the control before it; `changed` is what that returned.
    void follow(const char* what, bool changed) const {
        if (changed) {
            context_.edit(std::string(what) + " of " + source_.name, next);
            context_.sceneChanged();
        }
        if (ImGui::IsItemDeactivatedAfterEdit()) context_.endEdit();
    }
    Light& lamp() { return next.edits.lights[source_.key.index]; }

private:
    const PanelContext& context_;
    const LightSource& source_;

public:
    Document next;
};

bool drawColour(const char* label, glm::vec3& colour, ImGuiColorEditFlags flags) {
    const bool changed = ImGui::ColorEdit3(label, &colour.x, flags | ImGuiColorEditFlags_Float);
    if (changed) colour = typedColour(colour);
    return changed;
}

bool drawTemperature(glm::vec3& colour) {
    const std::optional<NearestBody> nearest = nearestBlackBody(colour);
    const float off = nearest ? nearest->off : 1.0f;
    float kelvin = off < kLike ? nearest->kelvin : kDaylight;
    const char* format = off < kSame ? "%.0f K" : off < kLike ? "~ %.0f K" : "- K";
    if (!ImGui::DragFloat("##temperature", &kelvin, kKelvinStep, kLowestTemperature, kHighestTemperature,
                          format, kClamp))
        return false;
    colour = std::max({colour.r, colour.g, colour.b}) * blackBody(kelvin);
    return true;
}

bool drawStrength(const char* label, LightPower& power, const LightKey& key, const char* unit) {
    const float least = key.kind == Kind::Lamp ? 0.0f : kLeastStrength;
    const std::string format = std::string("%.4g ") + unit;
    return ImGui::DragFloat(label, &power.intensity, std::max(kStrengthStep * power.intensity, kLeastStep),
                            least, kMostStrength, format.c_str(), kClamp);
}

void tellShared(const PanelContext& context, const LightKey& key) {
    if (key.kind == Kind::Sky) return;
    if (key.kind == Kind::Lamp) return ui::tip("Drag, or double-click and type");
    const size_t count = context.lights.emittersOf(key.material);
    ui::tip(count < 2
                ? "What the material emits. Drag, or double-click and type"
                : fmt::format("What the material emits: {} instances share it and change with it", count)
                      .c_str());
}

// Returns what tells in a row, behind the type, that the light is in no file or in a group.
std::string rowMark(const SceneEdits& edits, const LightKey& key, const LightGroup* group) {
    return (isPreview(edits, key) ? ", preview" : "") +
           (group != nullptr ? ", in " + group->source.name : "");
}

// Offers to keep the light that a level got which has none.
void drawKeep(const PanelContext& context) {
    if (!hasPreview(context.session.document().edits)) return;
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("Preview, not in the file:");
    ImGui::SameLine();
    if (ui::button("Keep")) {
        Document next = context.session.document();
        keepPreview(next.edits);
        context.edit("Keep of the preview light", next);
        context.endEdit();
    }
    ui::tip(
        "Nothing in the file shines, so that it is lit by a preview. Keep makes this light the file's own: "
        "saving writes it");
}

void tellGroup(const LightGroup* group) {
    if (group == nullptr) return ui::tip("L, Shift+L: next, previous light");
    ui::tip(
        fmt::format("Memory is short: it shares the layer '{}' with {} lights, which is made anew when one "
                    "of them is edited. L, Shift+L: next, previous light",
                    group->source.name, group->members.size() - 1)
            .c_str());
}

bool drawSwitch(const char* label, bool on, const ImVec4& colour) {
    if (on) ImGui::PushStyleColor(ImGuiCol_Button, colour);
    const bool pressed = ui::button(label, ImVec2(ImGui::GetFrameHeight(), 0.0f));
    if (on) ImGui::PopStyleColor();
    return pressed;
}

bool holds(const std::vector<LightKey>& keys, const LightKey& key) {
    return std::find(keys.begin(), keys.end(), key) != keys.end();
}

void drawSwitches(const PanelContext& context, const LightSource& source) {
    const LightMix& mix = context.session.document().mix;
    const auto press = [&](const char* what, std::vector<LightKey> LightMix::*keys) {
        Document next = context.session.document();
        toggle(next.mix.*keys, source.key);
        context.edit(std::string(what) + " of " + source.name, next);
        context.endEdit();
        context.sceneChanged();
    };
    if (drawSwitch("S", holds(mix.solo, source.key), {0.75f, 0.6f, 0.1f, 1.0f}))
        press("Solo", &LightMix::solo);
    ui::tip("Solo: only such lights shine (Alt+S)");
    ImGui::SameLine();
    if (drawSwitch("M", holds(mix.muted, source.key), {0.7f, 0.2f, 0.2f, 1.0f}))
        press("Mute", &LightMix::muted);
    ui::tip("Mute (Alt+M)");
}

void drawNumber(const LightEditor& editor, const char* what, const char* label, bool changed) {
    ui::mark(label, true);
    editor.follow(what, changed);
}

} // namespace

void LightsPanel::drawPreview(const PanelContext& context, const LightSource& source) {
    const float height = 2.0f * ImGui::GetFrameHeight() + ImGui::GetStyle().ItemSpacing.y;
    const float width = height * SurfaceIds::kWidth / SurfaceIds::kHeight;
    const bool pressed = ImGui::InvisibleButton("preview", {width, height});
    ui::mark("Preview", false);
    const LightGroup* group = groupWith(context.status.groups, source.key);
    ui::tip(group == nullptr
                ? "What it lights, exposed by itself. Alt+L: the whole scene so"
                : fmt::format("What all of '{}' light, exposed by itself. Alt+L: the whole scene so",
                              group->source.name)
                      .c_str());
    if (pressed) context.selectLight(source.key);
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const uint32_t texture = context.previews.texture(group == nullptr ? source.key : group->source.key);
    const bool dark = !context.session.document().mix.shines(source.key);
    const ImU32 tint = dark ? IM_COL32(255, 255, 255, 70) : IM_COL32_WHITE;
    list.AddRectFilled(low, high, ImGui::GetColorU32(ImGuiCol_FrameBg));
    if (texture != 0)
        list.AddImage(ImTextureID(static_cast<intptr_t>(texture)), low, high, {0, 0}, {1, 1}, tint);
    if (context.view.light == source.key) list.AddRect(low, high, ImGui::GetColorU32(ImGuiCol_HeaderActive));
}

void LightsPanel::drawRow(const PanelContext& context, const LightSource& source) {
    const ui::ItemLog::Scope scope(context.items, source.name);
    drawPreview(context, source);
    ImGui::SameLine();
    ImGui::BeginGroup();
    LightEditor editor(context, source);
    SceneEdits& edits = editor.next.edits;
    LightPower power = powerOf(edits, source.key);
    const auto change = [&](bool changed) {
        if (changed) setPower(edits, source.key, power);
        return changed;
    };
    const float spacing = ImGui::GetStyle().ItemSpacing.x, frame = ImGui::GetFrameHeight();
    bool changed =
        drawColour("##colour", power.color, ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoLabel);
    ui::mark("Colour", false);
    editor.follow("Colour", change(changed));
    ImGui::SameLine();
    const float name = std::max(ImGui::GetContentRegionAvail().x - 2.0f * (frame + spacing), frame);
    const bool dark = !context.session.document().mix.shines(source.key);
    if (dark) ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    const LightGroup* group = groupWith(context.status.groups, source.key);
    const std::string title = fmt::format("{} ({}{})###light", source.name, lightTypeOf(edits, source.key),
                                          rowMark(edits, source.key, group));
    if (ImGui::Selectable(title.c_str(), context.view.light == source.key, 0, {name, frame}))
        context.selectLight(source.key);
    if (dark) ImGui::PopStyleColor();
    ui::mark("Select", false);
    tellGroup(group);
    ImGui::SameLine();
    drawSwitches(context, source);
    const float half = 0.4f * (ImGui::GetContentRegionAvail().x - spacing);
    ImGui::SetNextItemWidth(half);
    changed = drawTemperature(power.color);
    ui::mark("Temperature", false);
    ui::tip("The colour of a black body so hot; ~ : is like it, - : is not");
    editor.follow("Temperature", change(changed));
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1.0f);
    changed = drawStrength("##intensity", power, source.key, lightUnitOf(edits, source.key));
    ui::mark("Intensity", false);
    tellShared(context, source.key);
    editor.follow("Intensity", change(changed));
    ImGui::EndGroup();
}

void LightsPanel::drawBoard(const PanelContext& context) {
    const std::vector<LightSource>& sources = context.lights.sources();
    if (sources.empty()) ImGui::TextWrapped("No lights: add one, or give a material emission (Scene).");
    const ImGuiStyle& style = ImGui::GetStyle();
    const float row = 2.0f * ImGui::GetFrameHeightWithSpacing() + style.ItemSpacing.y;
    const float whole = row * static_cast<float>(sources.size());
    const float height = std::min(whole, kBoardShare * ImGui::GetContentRegionAvail().y);
    ImGui::BeginChild("board", {0, std::max(height, 1.0f)});
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(sources.size()), row);
    const std::vector<LightSource> shown = sources; // edits change them
    while (clipper.Step()) {
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
            const LightSource& source = shown[static_cast<size_t>(i)];
            ImGui::PushID(i);
            drawRow(context, source);
            ImGui::Dummy({0, 0});
            ImGui::PopID();
        }
    }
    ImGui::EndChild();
}

void LightsPanel::drawAdd(const PanelContext& context) {
    constexpr std::array<const char*, 6> kNames = {"Point", "Spot", "Sun", "Rectangle", "Disc", "Sky"};
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("Add");
    const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
    for (size_t i = 0; i < kNames.size(); ++i) {
        const float width = ImGui::CalcTextSize(kNames[i]).x + 2.0f * ImGui::GetStyle().FramePadding.x;
        ImGui::SameLine();
        if (i > 0 && ImGui::GetCursorScreenPos().x + width > right) ImGui::NewLine();
        const Shortcut& shortcut = shortcutOf(Action::AddLight, static_cast<int>(i));
        if (ui::button(kNames[i])) context.perform(Action::AddLight, static_cast<int>(i));
        ui::tip(fmt::format("{} ({})", shortcut.name, keyText(shortcut)).c_str());
    }
    const bool lamp = context.view.light && context.view.light->kind == Kind::Lamp;
    const ui::Disabled disabled(!lamp);
    if (ui::button("Duplicate")) context.perform(Action::DuplicateLight, 0);
    ImGui::SameLine();
    if (ui::button("Delete")) context.perform(Action::DeleteLight, 0);
}

void LightsPanel::drawAngles(const PanelContext& context, const LightSource& source) {
    LightEditor editor(context, source);
    glm::mat4& transform = editor.lamp().transform;
    const glm::mat4 typed = withAngles(transform, angles_);
    float off = anglesOf_ == source.key ? 0.0f : 1.0f;
    for (int column = 0; column < 3; ++column)
        off = std::max(off, glm::distance(typed[column], glm::normalize(transform[column])));
    constexpr float kTyped = 1e-4f; // of a unit vector
    if (off > kTyped) angles_ = lightAngles(transform);
    anglesOf_ = source.key;
    const bool changed =
        ImGui::DragFloat3("Angles [deg]", &angles_.x, ui::kAngleStep, -360.0f, 360.0f, "%.1f");
    if (changed) {
        angles_ = typedAngles(angles_);
        transform = withAngles(transform, angles_);
    }
    drawNumber(editor, "Rotation", "Angles [deg]", changed);
    ui::tip("Turn about the upright, tilt (-90: down), roll");
}

// A field that another control takes the keyboard from is told of only in the next frame, when ImGui no
// longer has what was typed.
void LightsPanel::drawName(const PanelContext& context, const LightSource& source) {
    LightEditor editor(context, source);
    Light& light = editor.lamp();
    if (!naming_) name_ = light.name;
    ImGui::PushID(static_cast<int>(source.key.index)); // another light has a field of its own
    ImGui::InputText("Name", &name_);
    ui::mark("Name", true);
    naming_ = ImGui::IsItemActive();
    if (ImGui::IsItemDeactivatedAfterEdit() && !name_.empty() && light.name != name_) {
        light.name = name_;
        editor.follow("Name", true);
        context.endEdit();
    }
    ImGui::PopID();
}

void LightsPanel::drawLamp(const PanelContext& context, const LightSource& source) {
    drawName(context, source);
    LightEditor editor(context, source);
    Light& light = editor.lamp();
    const float diagonal = std::max(context.session.scene()->geometry.bounds.diagonal(), 1e-6f);
    const float step = ui::kPlaceStep * diagonal;
    const bool round = light.type == LightType::Point || light.type == LightType::Spot;
    const auto metres = [&](const char* label, const char* what, float& value) {
        const bool changed = ImGui::DragFloat(label, &value, step, 0.0f, 1e6f, "%.4g", kClamp);
        drawNumber(editor, what, label, changed);
    };
    const auto degrees = [&](const char* label, const char* what, float& radians, float most) {
        float value = glm::degrees(radians);
        const bool changed = ImGui::DragFloat(label, &value, ui::kAngleStep, 0.0f, most, "%.2f", kClamp);
        if (changed) radians = glm::radians(value);
        light.innerConeAngle = std::min(light.innerConeAngle, light.outerConeAngle);
        drawNumber(editor, what, label, changed);
    };
    glm::vec3 place(light.transform[3]);
    const bool moved = ImGui::DragFloat3("Position [m]", &place.x, step, 0.0f, 0.0f, "%.3f");
    if (moved) light.transform[3] = glm::vec4(place, 1.0f);
    drawNumber(editor, "Position", "Position [m]", moved);
    if (light.type != LightType::Point) drawAngles(context, source);
    if (round || light.type == LightType::Disc) metres("Radius [m]", "Radius", light.radius);
    if (light.type == LightType::Directional) degrees("Angle [deg]", "Angle", light.angle, 90.0f);
    if (light.type == LightType::Spot) {
        degrees("Outer cone [deg]", "Outer cone", light.outerConeAngle, 90.0f);
        degrees("Inner cone [deg]", "Inner cone", light.innerConeAngle, glm::degrees(light.outerConeAngle));
    }
    if (light.type == LightType::Rectangle) {
        const bool changed = ImGui::DragFloat2("Size [m]", &light.size.x, step, 1e-6f, 1e6f, "%.4g", kClamp);
        drawNumber(editor, "Size", "Size [m]", changed);
    }
    if (round) {
        metres("Range [m]", "Range", light.range);
        ui::tip("Beyond it there is no light; 0: no end");
    }
}

void LightsPanel::drawInspector(const PanelContext& context) {
    const LightSource* found = context.view.light ? context.lights.find(*context.view.light) : nullptr;
    if (found == nullptr) {
        ImGui::TextWrapped("Select a light: here, by its icon in the scene, or by L.");
        return;
    }
    const LightSource source = *found;
    ImGui::TextUnformatted(
        fmt::format("{}: {}", source.name, lightTypeOf(context.session.document().edits, source.key))
            .c_str());
    LightEditor editor(context, source);
    SceneEdits& edits = editor.next.edits;
    LightPower power = powerOf(edits, source.key);
    bool changed = drawColour("Colour", power.color, 0);
    if (changed) setPower(edits, source.key, power);
    drawNumber(editor, "Colour", "Colour", changed);
    changed = drawStrength("Intensity", power, source.key, lightUnitOf(edits, source.key));
    if (changed) setPower(edits, source.key, power);
    drawNumber(editor, "Intensity", "Intensity", changed);
    tellShared(context, source.key);
    if (source.key.kind == Kind::Lamp) return drawLamp(context, source);
    if (source.key.kind == Kind::Emitter) {
        const std::string& material = edits.materials[source.key.material].name;
        ImGui::TextWrapped("%s", fmt::format("Material {}, in {} lights", material,
                                             context.lights.emittersOf(source.key.material))
                                     .c_str());
        return;
    }
    float rotation = glm::degrees(edits.sky.rotation);
    const bool turned =
        ImGui::DragFloat("Rotation [deg]", &rotation, ui::kAngleStep, -360.0f, 360.0f, "%.1f");
    if (turned) edits.sky.rotation = glm::radians(typedAngle(rotation));
    drawNumber(editor, "Rotation", "Rotation [deg]", turned);
    ImGui::TextWrapped("%s", edits.sky.file.empty() ? "No picture: one radiance all around"
                                                    : ("Picture " + edits.sky.file).c_str());
    if (ui::button("Choose picture")) context.perform(Action::SkyPicture, 0);
    ui::tip("An equirectangular .exr or .hdr");
    if (edits.sky.file.empty()) return;
    ImGui::SameLine();
    if (ui::button("No picture")) context.perform(Action::NoSkyPicture, 0);
}

void LightsPanel::draw(const PanelContext& context) {
    if (context.session.scene() == nullptr) {
        ImGui::TextWrapped("No scene: drop a file on the window, or press Ctrl+O.");
        return;
    }
    context.previews.wanted = context.status.layered;
    if (!context.status.remark.empty())
        ImGui::TextWrapped("%s", (context.status.remark + ". Till then each edit bakes anew.").c_str());
    if (const std::string remark = groupRemark(context.status.groups); !remark.empty()) {
        ImGui::TextWrapped("%s.", remark.c_str());
        ui::mark("Shared layers", false);
    }
    drawKeep(context);
    drawBoard(context);
    ImGui::Separator();
    drawAdd(context);
    ImGui::Separator();
    const ui::ItemLog::Scope scope(context.items, "Selected");
    ImGui::PushItemWidth(ImGui::GetFontSize() * -8.0f);
    drawInspector(context);
    ImGui::PopItemWidth();
}

} // namespace relume
