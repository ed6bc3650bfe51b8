#include "app/viewer/state/shortcuts.h"

#include "app/export/engine_files.h"
#include "app/viewer/state/views.h"
#include "assets/base/error.h"
#include "renderer/gizmo.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace relume {
namespace {

constexpr int kCtrl = GLFW_MOD_CONTROL, kShift = GLFW_MOD_SHIFT, kAlt = GLFW_MOD_ALT;

void addEditShortcuts(std::vector<Shortcut>& all) {
    const std::vector<Shortcut> edits = {
        {Action::DuplicateLight, 0, GLFW_KEY_D, kCtrl, "Light", "Duplicate light"},
        {Action::DeleteLight, 0, GLFW_KEY_DELETE, 0, "Light", "Delete light"},
        {Action::NextLight, 1, GLFW_KEY_L, 0, "Light", "Next light"},
        {Action::NextLight, -1, GLFW_KEY_L, kShift, "Light", "Previous light"},
        {Action::SoloLight, 0, GLFW_KEY_S, kAlt, "Light", "Solo"},
        {Action::MuteLight, 0, GLFW_KEY_M, kAlt, "Light", "Mute"},
        {Action::LightStrength, 1, GLFW_KEY_EQUAL, kAlt, "Light", "Stronger light"},
        {Action::LightStrength, -1, GLFW_KEY_MINUS, kAlt, "Light", "Weaker light"},
        {Action::SkyPicture, 0, 0, 0, "Light", "Choose the sky's picture"},
        {Action::NoSkyPicture, 0, 0, 0, "Light", "Sky without a picture"},
        {Action::Nudge, -1, GLFW_KEY_LEFT, kAlt, "Move", "Nudge left"},
        {Action::Nudge, 1, GLFW_KEY_RIGHT, kAlt, "Move", "Nudge right"},
        {Action::Nudge, 2, GLFW_KEY_UP, kAlt, "Move", "Nudge up"},
        {Action::Nudge, -2, GLFW_KEY_DOWN, kAlt, "Move", "Nudge down"},
        {Action::Nudge, 3, GLFW_KEY_PAGE_UP, kAlt, "Move", "Nudge away"},
        {Action::Nudge, -3, GLFW_KEY_PAGE_DOWN, kAlt, "Move", "Nudge closer"},
        {Action::Gizmo, static_cast<int>(GizmoMode::Translate), GLFW_KEY_T, 0, "Move", "Move by the gizmo"},
        {Action::Gizmo, static_cast<int>(GizmoMode::Rotate), GLFW_KEY_R, 0, "Move", "Turn by the gizmo"},
        {Action::HideObject, 0, GLFW_KEY_H, 0, "Move", "Hide or show object"},
        {Action::ShowObjects, 0, GLFW_KEY_H, kAlt, "Move", "Show all objects"},
    };
    all.insert(all.end(), edits.begin(), edits.end());
    constexpr std::array kLightTypes = {"point light", "spot", "sun", "rectangle", "disc", "sky"};
    static_assert(kLightTypes.size() == kAddSky + 1);
    for (int i = 0; i <= kAddSky; ++i)
        all.push_back({Action::AddLight, i, GLFW_KEY_1 + i, kCtrl, "Light",
                       std::string("Add ") + kLightTypes[static_cast<size_t>(i)]});
}

std::vector<Shortcut> makeShortcuts() {
    std::vector<Shortcut> all = {
        {Action::Open, 0, GLFW_KEY_O, kCtrl, "File", "Open scene"},
        {Action::StartPage, 0, GLFW_KEY_N, kCtrl, "File", "Start page"},
        {Action::Save, 0, GLFW_KEY_S, kCtrl, "File", "Save scene"},
        {Action::SaveAs, 0, GLFW_KEY_S, kCtrl | kShift, "File", "Save scene as"},
        {Action::Export, 0, GLFW_KEY_E, kCtrl, "File", "Export lightmap"},
        {Action::Watch, 0, 0, 0, "File", "Reload when the file changes"},
        {Action::Quit, 0, GLFW_KEY_Q, kCtrl, "File", "Quit"},
        {Action::Undo, 0, GLFW_KEY_Z, kCtrl, "Edit", "Undo"},
        {Action::Redo, 0, GLFW_KEY_Z, kCtrl | kShift, "Edit", "Redo"},
        {Action::Redo, 0, GLFW_KEY_Y, kCtrl, "Edit", "Redo"},
        {Action::Pause, 0, GLFW_KEY_SPACE, 0, "Bake", "Pause or resume"},
        {Action::MakePass, 0, GLFW_KEY_P, 0, "Bake", "Make pass"},
        {Action::Step, 0, GLFW_KEY_PERIOD, 0, "Bake", "Step"},
        {Action::Reset, 0, GLFW_KEY_R, kCtrl, "Bake", "Reset"},
        {Action::Close, 0, GLFW_KEY_ESCAPE, 0, "Bake", "Close dialog or abort pass"},
        {Action::LightIcons, 0, GLFW_KEY_I, 0, "View", "Light icons"},
        {Action::ProbeBall, 0, GLFW_KEY_O, 0, "View", "Ball lit by its place"},
        {Action::ProbeGrid, 0, GLFW_KEY_O, kShift, "View", "Probes"},
        {Action::Wipe, 0, GLFW_KEY_B, 0, "View", "A/B wipe"},
        {Action::StoreReference, 0, GLFW_KEY_B, kShift, "View", "Store the light as B"},
        {Action::UvTexture, 0, GLFW_KEY_U, 0, "View", "As UV texture"},
        {Action::Masked, 0, GLFW_KEY_M, 0, "View", "UV texture masked"},
        {Action::NextFilter, 0, GLFW_KEY_F, kShift, "View", "Next lightmap filter"},
        {Action::NextTone, 0, GLFW_KEY_T, kShift, "View", "Next tone mapping"},
        {Action::Darker, 0, GLFW_KEY_LEFT_BRACKET, 0, "View", "Darker"},
        {Action::Brighter, 0, GLFW_KEY_RIGHT_BRACKET, 0, "View", "Brighter"},
        {Action::AutomaticExposure, 0, GLFW_KEY_X, 0, "View", "Automatic exposure"},
        {Action::FrameAll, 0, GLFW_KEY_HOME, 0, "Camera", "Frame all"},
        {Action::FrameSelected, 0, GLFW_KEY_F, 0, "Camera", "Frame selected"},
        {Action::ResetCamera, 0, GLFW_KEY_HOME, kShift, "Camera", "Reset camera"},
        {Action::StoreBookmark, 0, GLFW_KEY_B, kCtrl, "Camera", "Store bookmark"},
        {Action::Screenshot, 0, GLFW_KEY_F12, 0, "Capture", "Screenshot"},
        {Action::ScreenshotWithUi, 0, GLFW_KEY_F12, kShift, "Capture", "Screenshot with panels"},
        {Action::Record, 0, GLFW_KEY_F12, kCtrl, "Capture", "Start or stop recording"},
        {Action::RecordTurn, 0, GLFW_KEY_F12, kCtrl | kShift, "Capture", "Record a turn"},
        {Action::RecordPath, 0, GLFW_KEY_F12, kAlt, "Capture", "Record the way through all bookmarks"},
        {Action::RecordAnimation, 0, GLFW_KEY_F12, kAlt | kShift, "Capture",
         "Record the file's camera animation"},
        {Action::Caption, 0, 0, 0, "Capture", "Caption"},
        {Action::Help, 0, GLFW_KEY_F1, 0, "Help", "All keys"},
        {Action::Help, 0, GLFW_KEY_SLASH, kShift, "Help", "All keys"},
        {Action::HideUi, 0, GLFW_KEY_F2, 0, "Help", "Hide panels"},
        {Action::ReloadShaders, 0, GLFW_KEY_F5, 0, "Help", "Reload shaders"},
    };
    const std::vector<std::string>& engines = engineNames();
    for (size_t i = 0; i < engines.size(); ++i)
        all.push_back({Action::ExportFor, static_cast<int>(i), 0, 0, "Export for",
                       std::string("Export for ") + engines[i]});
    all.push_back({Action::ExportPage, 0, 0, 0, "Export for", "Export for web page"});
    addEditShortcuts(all);
    const std::vector<ViewEntry>& views = viewEntries();
    for (size_t i = 0; i < views.size(); ++i)
        all.push_back({Action::View, static_cast<int>(i), views[i].key, views[i].mods, "View",
                       std::string("View ") + views[i].title});
    const std::vector<std::string>& panels = panelNames();
    for (size_t i = 0; i < panels.size(); ++i)
        all.push_back({Action::Panel, static_cast<int>(i), GLFW_KEY_1 + static_cast<int>(i), kAlt, "Help",
                       "Panel " + panels[i]});
    return all;
}

std::string keyName(int key) {
    switch (key) {
    case GLFW_KEY_SPACE:
        return "Space";
    case GLFW_KEY_ESCAPE:
        return "Esc";
    case GLFW_KEY_HOME:
        return "Home";
    case GLFW_KEY_DELETE:
        return "Del";
    case GLFW_KEY_LEFT:
        return "Left";
    case GLFW_KEY_RIGHT:
        return "Right";
    case GLFW_KEY_UP:
        return "Up";
    case GLFW_KEY_DOWN:
        return "Down";
    case GLFW_KEY_PAGE_UP:
        return "Page Up";
    case GLFW_KEY_PAGE_DOWN:
        return "Page Down";
    default:
        break;
    }
    if (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F25) return fmt::format("F{}", key - GLFW_KEY_F1 + 1);
    return std::string(1, static_cast<char>(key)); // GLFW's codes of printable keys are ASCII
}

} // namespace

const std::vector<Shortcut>& shortcuts() {
    static const std::vector<Shortcut> all = makeShortcuts();
    return all;
}

const Shortcut* findShortcut(int key, int mods) {
    const int relevant = mods & (kCtrl | kShift | kAlt);
    for (const Shortcut& shortcut : shortcuts())
        if (shortcut.key != 0 && shortcut.key == key && shortcut.mods == relevant) return &shortcut;
    return nullptr;
}

const Shortcut& shortcutOf(Action action, int argument) {
    const std::vector<Shortcut>& all = shortcuts();
    const auto found = std::find_if(all.begin(), all.end(), [&](const Shortcut& candidate) {
        return candidate.action == action && candidate.argument == argument;
    });
    ASSERT(found != all.end());
    return *found;
}

std::string keyText(const Shortcut& shortcut) {
    if (shortcut.key == 0) return "";
    if (shortcut.key == GLFW_KEY_SLASH && shortcut.mods == kShift) return "?";
    std::string text;
    if ((shortcut.mods & kCtrl) != 0) text += "Ctrl+";
    if ((shortcut.mods & kShift) != 0) text += "Shift+";
    if ((shortcut.mods & kAlt) != 0) text += "Alt+";
    return text + keyName(shortcut.key);
}

const std::vector<std::string>& panelNames() {
    static const std::vector<std::string> names = {"Bake", "View", "Scene", "Lights", "Profiler", "Log"};
    return names;
}

const std::vector<MouseHint>& mouseHints() {
    static const std::vector<MouseHint> hints = {
        {"Orbit", "left drag"},
        {"Pan", "middle or Shift + left drag"},
        {"Zoom", "wheel"},
        {"Look around", "right drag"},
        {"Fly (Shift: faster)", "W A S D, E up, Q down"},
        {"Select a light or an instance", "click"},
        {"Move or turn the selected light or object", "left drag of the gizmo"},
        {"Along one axis; not at all", "X, Y, Z; Esc while dragging"},
        {"On the surface below; in steps", "Ctrl while moving; turning"},
        {"Visible from here", "Ctrl + click"},
        {"Open a scene", "drop a file"},
    };
    return hints;
}

} // namespace relume
