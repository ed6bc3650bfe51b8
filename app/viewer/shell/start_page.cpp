#include "app/viewer/shell/start_page.h"

#include "app/viewer/panels/widgets.h"
#include "app/viewer/state/failure_text.h"
#include "app/viewer/window/gui.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>
#include <imgui.h>

namespace relume {
namespace {

// Sizes are in heights of the font.
constexpr float kTwoColumns = 52; // as wide as the page must be for them
constexpr float kPagePadding = 2, kLeastPadding = 0.8f, kDropHeight = 4.6f, kSectionGap = 0.6f, kGap = 0.5f;
constexpr float kLeastTile = 11.5f, kMostTile = 18;
constexpr float kPictureAspect = 16.0f / 9.0f; // width over height of the small pictures
// Of the quiet text, too, each letter is to be read: it is lighter than that of the panels.
const ImVec4 kQuiet(0.66f, 0.67f, 0.70f, 1.0f);
const ImVec4 kGone(1.0f, 0.62f, 0.42f, 1.0f), kPage(0.085f, 0.09f, 0.10f, 1.0f);

std::string homeFolder() {
    const char* home = std::getenv("HOME");
    return home != nullptr ? home : "";
}

std::string shortened(const std::string& text, float room) {
    return endOf(text, [&](const std::string& part) { return ImGui::CalcTextSize(part.c_str()).x <= room; });
}

void drawSection(const char* name) {
    ImGui::Dummy({0, kSectionGap * ImGui::GetFontSize()});
    ImGui::TextUnformatted(name);
    ImGui::Separator();
    ImGui::Spacing();
}

// Draws a frame of dashes, which says that something can be dropped there.
void drawDashes(const ImVec2& low, const ImVec2& high, ImU32 colour) {
    const float dash = 0.5f * ImGui::GetFontSize();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    for (float x = low.x; x < high.x; x += 2 * dash) {
        const float to = std::min(x + dash, high.x);
        list.AddLine({x, low.y}, {to, low.y}, colour);
        list.AddLine({x, high.y}, {to, high.y}, colour);
    }
    for (float y = low.y; y < high.y; y += 2 * dash) {
        const float to = std::min(y + dash, high.y);
        list.AddLine({low.x, y}, {low.x, to}, colour);
        list.AddLine({high.x, y}, {high.x, to}, colour);
    }
}

// Draws text in the middle of a box, a line below or above its own middle.
void drawCentred(const ImVec2& low, const ImVec2& high, const char* text, float lines, ImGuiCol colour) {
    const ImVec2 size = ImGui::CalcTextSize(text);
    const ImVec2 at(0.5f * (low.x + high.x - size.x),
                    0.5f * (low.y + high.y - size.y) + lines * ImGui::GetTextLineHeight());
    ImGui::GetWindowDrawList()->AddText(at, ImGui::GetColorU32(colour), text);
}

} // namespace

StartPage::~StartPage() {
    if (asked_.valid()) asked_.wait();
}

void StartPage::show(bool on, const Preferences& preferences) {
    if (on == shown_) return;
    shown_ = on;
    if (!on) return;
    scenes_ = shippedScenes(shippedFolder(programPath(), RELUME_SOURCE_TREE));
    std::vector<std::string> files;
    for (const ShippedScene& scene : scenes_)
        files.push_back(scene.picture);
    pictures_.read(files);
    if (asked_.valid()) return; // it is still being looked for
    asked_ = std::async(std::launch::async, [recent = preferences.recent] { return goneFiles(recent); });
}

std::optional<size_t> StartPage::follow() {
    pictures_.follow();
    if (!asked_.valid() || asked_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
        return std::nullopt;
    gone_ = asked_.get();
    return gone_.size();
}

// Draws how other files are opened.
void StartPage::drawHow(const PanelContext& context, bool back) {
    drawSection("Open a scene");
    const float em = ImGui::GetFontSize();
    const ImVec2 size(ImGui::GetContentRegionAvail().x, kDropHeight * em);
    ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_FrameBg));
    const bool pressed = ImGui::Button("##drop", size);
    ImGui::PopStyleColor();
    ui::mark("Drop", false);
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    drawDashes(low, high, ImGui::GetColorU32(ImGuiCol_TextDisabled));
    drawCentred(low, high, "Drop a scene here", -0.6f, ImGuiCol_Text);
    const std::string key = fmt::format("or click to choose one ({})", keyText(shortcutOf(Action::Open)));
    drawCentred(low, high, shortened(key, size.x).c_str(), 0.6f, ImGuiCol_TextDisabled);
    if (pressed) context.perform(Action::Open, 0);
    ImGui::Spacing();
    if (ui::button(fmt::format("All keys ({})", keyText(shortcutOf(Action::Help))).c_str()))
        context.perform(Action::Help, 0);
    if (!back) return;
    ImGui::SameLine();
    if (ui::button(fmt::format("Back to the scene ({})", keyText(shortcutOf(Action::Close))).c_str()))
        context.perform(Action::Close, 0);
}

// Draws one of the recent files. Returns whether it is to be forgotten.
bool StartPage::drawRecentFile(const PanelContext& context, const RecentFile& file, bool newest) {
    const ImGuiStyle& style = ImGui::GetStyle();
    const float line = ImGui::GetTextLineHeight(), edge = ImGui::GetFrameHeight();
    const float height = 2 * line + 2 * style.FramePadding.y;
    const float width = ImGui::GetContentRegionAvail().x - edge - style.ItemSpacing.x;
    ImGui::PushID(file.path.c_str());
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const bool chosen = ImGui::Selectable("##open", false, ImGuiSelectableFlags_None, {width, height});
    // The keyboard begins at what one most likely wants, wherever the columns stand with this font.
    if (newest && ImGui::IsWindowAppearing()) ImGui::SetItemDefaultFocus();
    ui::mark((file.name + (file.gone ? " (gone)" : "")).c_str(), false);
    const float indent = style.FramePadding.x, room = width - 2 * indent;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const std::string name = shortened(file.name, room);
    const std::string folder = shortened((file.gone ? "gone from " : "") + file.folder, room);
    const ImU32 quiet = ImGui::GetColorU32(ImGuiCol_TextDisabled);
    list.AddText({at.x + indent, at.y + style.FramePadding.y},
                 file.gone ? quiet : ImGui::GetColorU32(ImGuiCol_Text), name.c_str());
    list.AddText({at.x + indent, at.y + style.FramePadding.y + line},
                 file.gone ? ImGui::ColorConvertFloat4ToU32(kGone) : quiet, folder.c_str());
    if (name != file.name || !folder.ends_with(file.folder)) ui::tip(file.path.c_str());
    ImGui::SameLine();
    ImGui::SetCursorPosY(ImGui::GetCursorPosY() + 0.5f * (height - edge));
    const bool forget = ImGui::Button("x", {edge, edge});
    ui::mark(("Forget " + file.name).c_str(), false);
    ui::tip("Forget this file: it stays where it is");
    ImGui::PopID();
    if (chosen) context.open(file.path);
    return forget;
}

void StartPage::drawRecent(const PanelContext& context) {
    const ui::ItemLog::Scope scope(context.items, "Recent");
    drawSection("Recent files");
    const std::vector<std::string> recent = context.preferences.recent; // opening and forgetting change it
    if (recent.empty()) ImGui::TextDisabled("Nothing was opened yet.");
    std::string forgotten;
    bool newest = true;
    for (const RecentFile& file : recentFiles(recent, gone_, homeFolder())) {
        if (drawRecentFile(context, file, newest)) forgotten = file.path;
        newest = false;
    }
    if (!forgotten.empty()) context.forget(forgotten);
}

// Draws a scene as a picture with its name. Returns whether it was chosen.
bool StartPage::drawScene(const ShippedScene& scene, float width) {
    const float border = 0.25f * ImGui::GetFontSize(), line = ImGui::GetTextLineHeight();
    const float pictureHeight = (width - 2 * border) / kPictureAspect;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float height = pictureHeight + 3 * border + line;
    ImGui::PushID(scene.path.c_str());
    const bool chosen = ImGui::Button("##scene", {width, height});
    ImGui::PopID();
    ui::mark(scene.name.c_str(), false);
    const ImVec2 low(at.x + border, at.y + border), high(at.x + width - border, low.y + pictureHeight);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    if (const uint32_t texture = pictures_.texture(scene.picture); texture != 0)
        list.AddImage(ImTextureID(static_cast<intptr_t>(texture)), low, high);
    else
        list.AddRectFilled(low, high, ImGui::GetColorU32(ImGuiCol_FrameBg));
    const std::string name = shortened(scene.name, width - 2 * border);
    drawCentred({low.x, high.y + border}, {high.x, high.y + border + line}, name.c_str(), 0, ImGuiCol_Text);
    return chosen;
}

void StartPage::drawScenes(const PanelContext& context) {
    const ui::ItemLog::Scope scope(context.items, "Scenes");
    drawSection("Scenes that ship with Relume");
    const float em = ImGui::GetFontSize(), gap = ImGui::GetStyle().ItemSpacing.x;
    const float room = ImGui::GetContentRegionAvail().x;
    const int columns = std::max(static_cast<int>((room + gap) / (kLeastTile * em + gap)), 1);
    const float share = (room - static_cast<float>(columns - 1) * gap) / static_cast<float>(columns);
    const float width = std::floor(std::min(share, kMostTile * em));
    std::string chosen;
    for (size_t i = 0; i < scenes_.size(); ++i) {
        if (i % static_cast<size_t>(columns) != 0) ImGui::SameLine();
        if (drawScene(scenes_[i], width)) chosen = scenes_[i].path;
    }
    if (!chosen.empty()) context.open(chosen);
}

void StartPage::draw(const PanelContext& context, const PictureArea& area, bool back) {
    const ui::ItemLog::Scope scope(context.items, "Start");
    const float em = ImGui::GetFontSize();
    const bool wide = area.size.x >= kTwoColumns * em && !scenes_.empty();
    const float padding = wide ? kPagePadding * em : kLeastPadding * em;
    ImGui::SetNextWindowPos({area.corner.x, area.corner.y});
    ImGui::SetNextWindowSize({area.size.x, area.size.y});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {padding, padding});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, kPage);
    ImGui::Begin("start", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBringToFrontOnFocus);
    ImGui::PopStyleVar(); // tooltips have their own
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {kGap * em, kGap * em});
    ImGui::PushStyleVar(ImGuiStyleVar_CellPadding, {kGap * em, 0});
    ImGui::PushStyleColor(ImGuiCol_TextDisabled, kQuiet);
    ImGui::PushFont(Gui::titleFont());
    ImGui::TextUnformatted("Relume");
    ImGui::PopFont();
    ImGui::TextDisabled("Any level, lit while you look at it.");
    ImGui::Spacing();
    if (wide && ImGui::BeginTable("columns", 2, ImGuiTableFlags_SizingStretchProp)) {
        constexpr float kLeft = 0.42f; // of the page's width
        ImGui::TableSetupColumn("left", ImGuiTableColumnFlags_WidthStretch, kLeft);
        ImGui::TableSetupColumn("right", ImGuiTableColumnFlags_WidthStretch, 1.0f - kLeft);
        ImGui::TableNextColumn();
        drawHow(context, back);
        drawRecent(context);
        ImGui::TableNextColumn();
        drawScenes(context);
        ImGui::EndTable();
    } else {
        drawHow(context, back);
        drawRecent(context);
        if (!scenes_.empty()) drawScenes(context);
    }
    ImGui::PopStyleColor();
    ImGui::PopStyleVar(2);
    ImGui::End();
    ImGui::PopStyleColor();
}

} // namespace relume
