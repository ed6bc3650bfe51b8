#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace relume {

/// Everything that a user can do by a key or a menu. Actions that belong together stand together.
enum class Action : uint8_t {
    Open,
    StartPage,
    Save,
    SaveAs,
    Export,
    ExportFor, // argument: an Engine
    ExportPage,
    Watch,
    Quit,
    Undo,
    Redo,
    MakePass,
    Pause,
    Step,
    Reset,
    Close,    // a dialog, else the pass under way
    AddLight, // argument: a LightType, or kAddSky
    DuplicateLight,
    DeleteLight,
    NextLight, // argument: 1, or -1 for the one before
    SoloLight,
    MuteLight,
    LightStrength, // argument: 1 up, -1 down
    SkyPicture,
    NoSkyPicture,
    Nudge, // argument: 1, 2, 3 along the picture's right, up and forward, less than 0 against it
    Gizmo, // argument: a GizmoMode
    HideObject,
    ShowObjects,
    LightIcons,
    ProbeBall,
    ProbeGrid,
    Wipe,
    StoreReference,
    View, // argument: of viewEntries()
    UvTexture,
    Masked,
    NextFilter,
    NextTone,
    Darker,
    Brighter,
    AutomaticExposure,
    FrameAll,
    FrameSelected,
    ResetCamera,
    StoreBookmark,
    Screenshot,
    ScreenshotWithUi,
    Record,
    RecordTurn,
    RecordPath,
    RecordAnimation,
    Caption,
    ReloadShaders,
    Help,
    HideUi,
    Panel, // argument: of panelNames()
};

/// The argument of AddLight for a sky, which comes behind all of LightType.
constexpr int kAddSky = 5;

/// A key and what it does. Keys are GLFW_KEY_, mods are GLFW_MOD_.
struct Shortcut {
    Action action;
    int argument = 0;
    int key = 0; // 0: in the menu only
    int mods = 0;
    std::string group; // the menu
    std::string name;  // "Make pass"; the same for all keys of an action
};

/// Returns the one list of shortcuts, of which dispatch, menus and help are made.
const std::vector<Shortcut>& shortcuts();
/// Returns the shortcut of a key, or nullptr where the key does nothing.
const Shortcut* findShortcut(int key, int mods);
const Shortcut& shortcutOf(Action action, int argument = 0);
/// Returns "Ctrl+Shift+Z", or "" without a key.
std::string keyText(const Shortcut& shortcut);

/// Returns the panels' names in the order of their tabs.
const std::vector<std::string>& panelNames();

/// A line of the help about what is held or dragged and so is no action: what it does and how.
struct MouseHint {
    const char* what;
    const char* how;
};
const std::vector<MouseHint>& mouseHints();

} // namespace relume
