#include "app/viewer/shell/middle_cards.h"

#include "app/viewer/panels/widgets.h"
#include "app/viewer/state/failure_text.h"
#include "app/viewer/window/gui.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <imgui.h>

namespace relume {
namespace {

// Sizes are in heights of the font.
constexpr float kCardWidth = 42, kCardPadding = 1.4f, kCardRounding = 0.4f, kWindowMargin = 1;
const ImVec4 kBad(1.0f, 0.55f, 0.45f, 1.0f), kHelp(0.98f, 0.76f, 0.44f, 1.0f);
const ImVec4 kCardGround(0.13f, 0.135f, 0.15f, 0.98f), kCardBorder(0.40f, 0.41f, 0.44f, 1.0f);
const ImVec4 kCardQuiet(0.66f, 0.67f, 0.70f, 1.0f);

/// A window without a title in the middle, as high as its content. Its content is drawn while it lives.
class Card {
public:
    Card(const char* id, const PictureArea& area, ImGuiWindowFlags flags) {
        const float em = ImGui::GetFontSize();
        const ImVec2 window = ImGui::GetIO().DisplaySize;
        const float width = std::min(kCardWidth * em, std::max(window.x - 2 * kWindowMargin * em, 1.0f));
        const float height = std::max(window.y - 2 * kWindowMargin * em, 1.0f);
        const bool fits = width <= area.size.x;
        const float x = fits ? area.corner.x + 0.5f * area.size.x : 0.5f * window.x;
        const float y = fits ? area.corner.y + 0.5f * area.size.y : 0.5f * window.y;
        ImGui::SetNextWindowPos({x, y}, ImGuiCond_Always, {0.5f, 0.5f});
        ImGui::SetNextWindowSizeConstraints({width, 0}, {width, height});
        ImGui::SetNextWindowSize({width, 0}); // 0: as high as its content
        ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {kCardPadding * em, kCardPadding * em});
        ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, kCardRounding * em);
        ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1.0f);
        ImGui::PushStyleColor(ImGuiCol_WindowBg, kCardGround);
        ImGui::PushStyleColor(ImGuiCol_Border, kCardBorder);
        ImGui::PushStyleColor(ImGuiCol_TextDisabled, kCardQuiet);
        ImGui::Begin(id, nullptr,
                     ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                         ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings | flags);
        ImGui::PopStyleVar(3); // tooltips have their own
    }
    ~Card() {
        ImGui::End();
        ImGui::PopStyleColor(3);
    }
    Card(const Card&) = delete;
    Card& operator=(const Card&) = delete;
};

void drawTitle(const char* text, const ImVec4& colour) {
    ImGui::PushFont(Gui::titleFont());
    ImGui::PushStyleColor(ImGuiCol_Text, colour);
    ImGui::TextWrapped("%s", text);
    ImGui::PopStyleColor();
    ImGui::PopFont();
}

// Draws a path of which the end is shown where there is no room for all of it.
void drawPath(const std::string& path) {
    const float room = ImGui::GetContentRegionAvail().x;
    const std::string shown =
        endOf(path, [&](const std::string& text) { return ImGui::CalcTextSize(text.c_str()).x <= room; });
    ImGui::TextDisabled("%s", shown.c_str());
    if (shown != path) ui::tip(path.c_str());
}

// Draws a button, beside the one before where there is room. Returns whether it was pressed.
bool cardButton(const std::string& label, bool first) {
    const ImGuiStyle& style = ImGui::GetStyle();
    const float width = ImGui::CalcTextSize(label.c_str()).x + 2 * style.FramePadding.x;
    const float end = ImGui::GetWindowPos().x + ImGui::GetContentRegionMax().x;
    if (!first && ImGui::GetItemRectMax().x + style.ItemSpacing.x + width <= end) ImGui::SameLine();
    return ui::button(label.c_str());
}

std::string withKey(const char* label, Action action) {
    const std::string key = keyText(shortcutOf(action));
    return key.empty() ? label : fmt::format("{} ({})", label, key);
}

void drawOpening(const MiddleView& view, const PictureArea& area) {
    const Card card("opening", area, ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoInputs);
    const std::filesystem::path path(view.opening);
    drawTitle(("Opening " + path.filename().string()).c_str(), ImGui::GetStyleColorVec4(ImGuiCol_Text));
    drawPath(path.parent_path().string());
    ImGui::Spacing();
    const double done = view.progress.done;
    const std::string percent = done >= 0.0 ? fmt::format("{:.0f} %", 100.0 * done) : "";
    ImGui::TextUnformatted(loadingWords(view.progress.phase).c_str());
    ImGui::ProgressBar(static_cast<float>(std::clamp(done, 0.0, 1.0)), {-1, 0}, percent.c_str());
}

void drawFailure(const PanelContext& context, const MiddleView& view, const PictureArea& area) {
    const FailureText text = failureText(*view.failure);
    const Card card("failure", area, ImGuiWindowFlags_None);
    drawTitle(text.title.c_str(), kBad);
    ImGui::TextWrapped("%s", text.name.c_str());
    drawPath(text.folder);
    ImGui::Spacing();
    ImGui::TextWrapped("%s", text.thing.c_str());
    ImGui::PushStyleColor(ImGuiCol_Text, kHelp);
    ImGui::TextWrapped("What helps: %s", text.mend.c_str());
    ImGui::PopStyleColor();
    ImGui::Spacing();
    ImGui::Spacing();
    if (cardButton(withKey("Choose another file", Action::Open), true)) context.perform(Action::Open, 0);
    if (ImGui::IsWindowAppearing()) ImGui::SetItemDefaultFocus();
    if (cardButton(withKey("Recent files", Action::StartPage), false)) context.perform(Action::StartPage, 0);
    if (cardButton("Copy the message", false)) view.copy(view.failure->message);
    if (cardButton(withKey("Close", Action::Close), false)) context.perform(Action::Close, 0);
}

void drawNotice(const PanelContext& context, const MiddleView& view, const PictureArea& area) {
    const PictureNotice& notice = *view.notice;
    const Card card("notice", area, ImGuiWindowFlags_NoFocusOnAppearing);
    drawTitle(notice.title.c_str(), ImGui::GetStyleColorVec4(ImGuiCol_Text));
    ImGui::TextWrapped("%s", notice.text.c_str());
    ImGui::Spacing();
    ImGui::Spacing();
    if (notice.mend) {
        const std::string label = withKey(shortcutOf(*notice.mend).name.c_str(), *notice.mend);
        if (cardButton(label, true)) context.perform(*notice.mend, 0);
    }
    if (cardButton("Copy the message", !notice.mend)) view.copy(notice.title + ": " + notice.text);
    if (cardButton(withKey("Close", Action::Close), false)) context.perform(Action::Close, 0);
}

} // namespace

void drawMiddleCard(const PanelContext& context, const MiddleView& view, const PictureArea& area) {
    const ui::ItemLog::Scope scope(context.items, "Middle");
    switch (view.middle.card) {
    case Middle::Card::Opening:
        return drawOpening(view, area);
    case Middle::Card::Failure:
        return drawFailure(context, view, area);
    case Middle::Card::Notice:
        return drawNotice(context, view, area);
    default:
        return;
    }
}

} // namespace relume
