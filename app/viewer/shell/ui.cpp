#include "app/viewer/shell/ui.h"

#include "app/export/engine_files.h"
#include "app/viewer/panels/log_panel.h"
#include "app/viewer/panels/profiler_panel.h"
#include "app/viewer/panels/view_panel.h"
#include "app/viewer/panels/widgets.h"
#include "app/viewer/picture/shown_lights.h"
#include "app/viewer/state/file_choices.h"
#include "app/viewer/state/fitting_text.h"
#include "app/viewer/state/views.h"

#include <algorithm>

#include <fmt/format.h>
#include <imgui.h>

namespace relume {
namespace {

using Phase = BakeStatus::Phase;

constexpr ImGuiWindowFlags kBar = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                  ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus |
                                  ImGuiWindowFlags_NoNav;

bool isChecked(const PanelContext& context, const Shortcut& shortcut) {
    switch (shortcut.action) {
    case Action::Watch:
        return context.session.watchesFile();
    case Action::View:
        return static_cast<size_t>(shortcut.argument) == context.view.view;
    case Action::UvTexture:
        return context.view.uv;
    case Action::Masked:
        return context.view.masked;
    case Action::AutomaticExposure:
        return !context.view.exposure;
    case Action::LightIcons:
        return context.view.lightIcons;
    case Action::ProbeBall:
        return context.view.ball.has_value();
    case Action::ProbeGrid:
        return context.view.probes;
    case Action::Wipe:
        return context.view.wipe;
    case Action::Gizmo:
        return static_cast<int>(context.view.gizmo) == shortcut.argument;
    case Action::Record:
        return context.recording;
    case Action::Caption:
        return context.preferences.caption;
    default:
        return false;
    }
}

// Returns the title of a menu item. Undo and redo say what they would do.
std::string titleOf(const PanelContext& context, const Shortcut& shortcut, bool& enabled) {
    const bool undo = shortcut.action == Action::Undo;
    if (!undo && shortcut.action != Action::Redo) return shortcut.name;
    const std::string what = undo ? context.session.undoName() : context.session.redoName();
    enabled = !what.empty();
    return enabled ? shortcut.name + " " + what : shortcut.name;
}

void drawRecent(const PanelContext& context, FileDialog& files) {
    if (!ImGui::BeginMenu("Recent", !context.preferences.recent.empty())) return;
    const std::vector<std::string> recent = context.preferences.recent; // opening changes it
    for (const std::string& path : recent)
        if (ImGui::MenuItem(path.c_str())) {
            files.close();
            context.open(path);
        }
    ImGui::EndMenu();
}

// Draws a menu of what the scene's file offers, where it offers a choice.
void drawChoices(const PanelContext& context, const char* name, const std::vector<FileChoice>& choices) {
    if (choices.empty()) return;
    const bool open = ImGui::BeginMenu(name);
    ui::mark(name, false);
    if (!open) return;
    const ui::ItemLog::Scope scope(context.items, name);
    for (size_t i = 0; i < choices.size(); ++i) {
        ImGui::PushID(static_cast<int>(i)); // two may have one name
        if (ImGui::MenuItem(choices[i].label.c_str(), nullptr, choices[i].chosen) && !choices[i].chosen)
            context.choose(choices[i].choice);
        ui::mark(choices[i].label.c_str(), false);
        ImGui::PopID();
    }
    ImGui::EndMenu();
}

void drawMenu(const PanelContext& context, const std::string& group) {
    const ui::ItemLog::Scope scope(context.items, group);
    const Shortcut* before = nullptr;
    for (const Shortcut& shortcut : shortcuts()) {
        if (shortcut.group != group) continue;
        const bool again =
            before != nullptr && before->action == shortcut.action && before->argument == shortcut.argument;
        before = &shortcut;
        if (again) continue; // another key of the same
        bool enabled = true;
        const std::string title = titleOf(context, shortcut, enabled);
        if (ImGui::MenuItem(title.c_str(), keyText(shortcut).c_str(), isChecked(context, shortcut), enabled))
            context.perform(shortcut.action, shortcut.argument);
        ui::mark(shortcut.name.c_str(), false);
    }
}

void drawEngines(const PanelContext& context) {
    const bool open = ImGui::BeginMenu("Export for");
    ui::mark("Export for", false);
    if (!open) return;
    const ui::ItemLog::Scope scope(context.items, "Export for");
    const std::vector<std::string>& engines = engineNames();
    for (size_t i = 0; i < engines.size(); ++i) {
        if (ImGui::MenuItem(engines[i].c_str())) context.perform(Action::ExportFor, static_cast<int>(i));
        ui::mark(engines[i].c_str(), false);
    }
    if (ImGui::MenuItem("web page")) context.perform(Action::ExportPage, 0);
    ui::mark("web page", false);
    ImGui::EndMenu();
}

void drawFileMenus(const PanelContext& context, FileDialog& files) {
    drawRecent(context, files);
    const LoadedScene* loaded = context.session.scene();
    if (loaded == nullptr) return;
    const Scene& scene = loaded->prepared.scene;
    const ui::ItemLog::Scope scope(context.items, "File");
    drawEngines(context);
    drawChoices(context, "Scene",
                sceneChoices(scene.sceneNames, scene.sceneNumber, context.session.choice()));
    drawChoices(context, "Variant", variantChoices(scene.variantNames, context.session.choice()));
}

void drawMessages(const Messages& messages, const PictureArea& area) {
    const std::vector<Messages::Message>& shown = messages.shown();
    if (shown.empty()) return;
    ImGui::SetNextWindowPos({area.corner.x + 0.5f * area.size.x, area.corner.y + ImGui::GetFontSize()},
                            ImGuiCond_Always, {0.5f, 0.0f});
    ImGui::SetNextWindowSizeConstraints({0, 0}, {std::max(0.9f * area.size.x, 1.0f), area.size.y});
    ImGui::Begin("messages", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing |
                     ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoNav);
    for (const Messages::Message& message : shown) {
        const ImVec4 colour = message.bad ? ImVec4(1.0f, 0.55f, 0.45f, 1.0f) : ImVec4(0.9f, 0.9f, 0.9f, 1.0f);
        ImGui::PushStyleColor(ImGuiCol_Text, colour);
        ImGui::PushTextWrapPos(std::max(0.85f * area.size.x, 1.0f));
        ImGui::TextUnformatted(message.text.c_str());
        ImGui::PopTextWrapPos();
        ImGui::PopStyleColor();
    }
    ImGui::End();
}

// Draws all keys, in as many columns as there is room for.
void drawKeys() {
    std::vector<std::pair<std::string, std::string>> keys;
    for (const MouseHint& hint : mouseHints())
        keys.emplace_back(hint.how, hint.what);
    for (const Shortcut& shortcut : shortcuts())
        if (shortcut.key != 0) keys.emplace_back(keyText(shortcut), shortcut.name);
    const auto width = [](const std::string& text) { return ImGui::CalcTextSize(text.c_str()).x; };
    std::vector<PairWidth> widths;
    for (const auto& [key, meaning] : keys)
        widths.push_back({width(key), width(meaning)});
    const ImGuiStyle& style = ImGui::GetStyle();
    const float room = ImGui::GetContentRegionAvail().x - style.ScrollbarSize;
    const size_t pairs = pairsInARow(widths, 2, 2 * style.CellPadding.x, room);
    if (!ImGui::BeginTable("keys", static_cast<int>(2 * pairs),
                           ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_RowBg))
        return;
    for (const auto& [key, meaning] : keys) {
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(key.c_str());
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(meaning.c_str());
    }
    ImGui::EndTable();
}

} // namespace

std::string statusLine(const BakeStatus& status) {
    const SolverProgress& progress = status.progress;
    const char* method = methodName(status.settings.solver.method);
    switch (status.phase) {
    case Phase::Idle:
        return "no bake";
    case Phase::Preparing:
        return "preparing " + status.doing;
    case Phase::Failed:
        return "failed: " + status.doing;
    default:
        break;
    }
    std::string text = status.phase == Phase::Paused ? "paused, "
                       : status.phase == Phase::Done ? "done, "
                                                     : "";
    text +=
        isPairMethod(status.settings.solver.method)
            ? fmt::format("{}, pass {} + {:.0f} %", method, progress.passes, 100.0 * progress.passFraction)
            : fmt::format("{}, {} directions", method, progress.samples);
    if (progress.error < 1.0) text += fmt::format(", error {:.2g}", progress.error);
    if (status.phase == Phase::Baking) text += fmt::format(", {:.1f} Mrays/s", status.raysPerSecond * 1e-6);
    return text;
}

float Ui::drawMenus(const PanelContext& context) {
    if (!ImGui::BeginMainMenuBar()) return 0;
    for (const char* group : {"File", "Edit", "Bake", "Light", "Move", "View", "Camera", "Capture", "Help"}) {
        const bool open = ImGui::BeginMenu(group);
        {
            const ui::ItemLog::Scope menus(context.items, "Menu");
            ui::mark(group, false);
        }
        if (!open) continue;
        drawMenu(context, group);
        if (std::string(group) == "File") drawFileMenus(context, files_);
        ImGui::EndMenu();
    }
    if (context.recording) ImGui::TextColored({1.0f, 0.35f, 0.3f, 1.0f}, "   recording");
    const float height = ImGui::GetWindowSize().y;
    ImGui::EndMainMenuBar();
    return height;
}

float Ui::drawStatus(const PanelContext& context) {
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    const float height = ImGui::GetFrameHeight() + 2.0f;
    ImGui::SetNextWindowPos({0, window.y - height});
    ImGui::SetNextWindowSize({window.x, height});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {ImGui::GetStyle().FramePadding.x * 2, 2.0f});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, ImGui::GetStyleColorVec4(ImGuiCol_MenuBarBg));
    ImGui::Begin("status", nullptr, kBar);
    const BakeStatus& status = context.status;
    const bool loading = context.session.loading();
    if (loading || status.phase == Phase::Preparing) {
        const std::string what = loading ? "loading " + context.session.loader().path() : status.doing;
        const float share = loading ? 0.0f : static_cast<float>(status.fraction);
        ImGui::ProgressBar(share, {ImGui::GetFontSize() * 20.0f, 0}, what.c_str());
        ImGui::SameLine();
    }
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(statusLine(status).c_str());
    const std::string view = viewTitle(context.view, context.lights, context.status.groups);
    const std::string exposure = fmt::format("{:+.1f} EV", context.exposure),
                      time = fmt::format("{:.1f} ms", context.figures.total);
    const float left = ImGui::GetItemRectMax().x, margin = ImGui::GetFontSize();
    const auto begin = [&](const std::string& text) {
        return window.x - ImGui::CalcTextSize(text.c_str()).x - margin;
    };
    const std::string right =
        firstThatFits({view + ", " + exposure + ", " + time, exposure + ", " + time, time},
                      [&](const std::string& text) { return begin(text) >= left + margin; });
    ImGui::SameLine(std::max(begin(right), 0.0f));
    ImGui::TextUnformatted(right.c_str());
    ImGui::End();
    ImGui::PopStyleColor();
    ImGui::PopStyleVar();
    return height;
}

void Ui::drawTab(const PanelContext& context, size_t index) {
    const ui::ItemLog::Scope scope(context.items, panelNames()[index]);
    switch (index) {
    case 0:
        bake_.draw(context);
        break;
    case 1:
        drawViewPanel(context);
        break;
    case 2:
        scene_.draw(context);
        break;
    case 3:
        lights_.draw(context);
        break;
    case 4:
        drawProfilerPanel(context);
        break;
    default:
        drawLogPanel(context);
        break;
    }
}

void Ui::drawSide(const PanelContext& context, float top, float bottom, float scale) {
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    const float height = std::max(window.y - top - bottom, 1.0f);
    ImGui::SetNextWindowPos({0, top});
    ImGui::SetNextWindowSize({context.preferences.panelWidth * scale, height}, ImGuiCond_Once);
    const float least = std::min(12.0f * ImGui::GetFontSize(), window.x);
    ImGui::SetNextWindowSizeConstraints({least, height}, {std::max(0.8f * window.x, least), height});
    ImGui::Begin("side", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus);
    context.preferences.panelWidth = ImGui::GetWindowSize().x / scale;
    if (ImGui::BeginTabBar("panels")) {
        const std::vector<std::string>& names = panelNames();
        for (size_t i = 0; i < names.size(); ++i) {
            const bool wanted = wantedPanel_ == static_cast<int>(i);
            const ImGuiTabItemFlags flags = wanted ? ImGuiTabItemFlags_SetSelected : ImGuiTabItemFlags_None;
            const bool open = ImGui::BeginTabItem(names[i].c_str(), nullptr, flags);
            {
                const ui::ItemLog::Scope tabs(context.items, "Tabs");
                ui::mark(names[i].c_str(), false);
            }
            if (!open) continue;
            ImGui::BeginChild("content");
            drawTab(context, i);
            ImGui::EndChild();
            ImGui::EndTabItem();
        }
        wantedPanel_ = -1;
        ImGui::EndTabBar();
    }
    ImGui::End();
}

void Ui::drawHelp() {
    if (!help_) return;
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({0.5f * window.x, 0.5f * window.y}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({std::min(60.0f * ImGui::GetFontSize(), window.x),
                              std::min(40.0f * ImGui::GetFontSize(), 0.9f * window.y)});
    ImGui::Begin("All keys", &help_, ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings);
    drawKeys();
    ImGui::End();
}

bool Ui::takesKeys(const Middle& middle) const {
    const bool controls = middle.startPage || middle.card == Middle::Card::Failure;
    return controls && !help_ && !files_.isOpen() && !question_.isOpen();
}

// Draws what stands in the middle, over the picture or, as the start page, over all that is below the menus.
void Ui::drawMiddle(const PanelContext& context, const MiddleView& middle, const PictureArea& picture,
                    const PictureArea& all) {
    tabs_.begin(middle.tabs);
    std::optional<ui::TabOrder::Scope> order;
    const bool failure = middle.middle.card == Middle::Card::Failure; // it is in front of the page
    if (middle.middle.startPage) {
        if (!failure) order.emplace(tabs_);
        start_.draw(context, all, middle.scene);
    }
    if (failure) order.emplace(tabs_);
    drawMiddleCard(context, middle, middle.middle.startPage ? all : picture);
}

PictureArea Ui::draw(const PanelContext& context, const MiddleView& middle, float scale) {
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    PictureArea area{{0, 0}, {window.x, window.y}}, all = area;
    if (!context.view.bare) {
        const float top = drawMenus(context), bottom = drawStatus(context);
        all = {{0, top}, {window.x, std::max(window.y - top - bottom, 1.0f)}};
        if (!middle.middle.startPage) drawSide(context, top, bottom, scale);
        const float left = context.preferences.panelWidth * scale;
        area = {{left, top}, {std::max(window.x - left, 1.0f), all.size.y}};
    }
    drawMiddle(context, middle, area, all);
    drawHelp();
    {
        const ui::ItemLog::Scope scope(context.items, "Dialog");
        files_.draw();
        question_.draw();
    }
    drawMessages(context.messages, area);
    return area;
}

bool Ui::closeDialog() {
    if (question_.isOpen()) {
        question_.close();
        return true;
    }
    if (files_.isOpen()) {
        files_.close();
        return true;
    }
    if (help_) {
        help_ = false;
        return true;
    }
    if (ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel)) {
        ImGui::SetWindowFocus(nullptr); // closes menus and lists
        return true;
    }
    return false;
}

} // namespace relume
