#pragma once

#include <optional>
#include <vector>

#include "app/viewer/state/camera_control.h"
#include "app/viewer/state/shortcuts.h"
#include "app/viewer/window/window.h"

namespace relume {

/// Holds what is pressed of keyboard and mouse, and tells what comes of it: flight, clicks and drags. It
/// moves nothing.
class HeldInput {
public:
    /// Says what a release of a mouse button ends.
    enum class Release { Nothing, Click, Drag };

    /// Follows Shift and Ctrl, which every key event bears.
    void followModifiers(const WindowEvent& key);
    /// Follows the keys of flight. Returns whether the key flies and so does nothing else.
    bool takeFlightKey(const WindowEvent& key, bool typing);
    /// Forgets the keys of flight: their releases go to somebody else.
    void releaseKeys() { keys_.clear(); }
    CameraControl::Flight flight() const;
    bool control() const { return control_; }

    const glm::dvec2& cursor() const { return cursor_; }
    void setCursor(const glm::dvec2& at) { cursor_ = at; }
    /// Begins what may become a click or a drag.
    void press(int button, const glm::dvec2& at);
    bool pressed() const { return press_.has_value(); }
    /// Follows the cursor. Returns how far it dragged since it was asked last [screen coordinates]; nothing
    /// where no button is pressed, or as long as it may be a click that trembles.
    std::optional<glm::dvec2> drag(const glm::dvec2& at);
    Release release(int button, const glm::dvec2& at);

private:
    struct Press {
        int button = 0;
        glm::dvec2 at{0.0};
        bool dragged = false; // the cursor went further than in a click
    };
    glm::dvec2 cursor_{0.0};
    std::optional<Press> press_;
    std::vector<int> keys_; // the places of the keys of flight that are held
    bool fast_ = false;     // Shift is held
    bool control_ = false;
};

/// Returns what a press of a mouse button does to the camera, None for a button that does nothing.
CameraControl::Drag cameraDragOf(int button, int mods);
/// Returns the name of a drag of the camera for --log-actions: "orbit".
const char* cameraDragName(int button, int mods);

/// Says who else takes key events beside the shortcuts.
struct KeyFocus {
    bool typing = false;     // a text is being typed
    bool fileDialog = false; // one is open
    bool page = false;       // controls in the middle of the window are gone through by keys
};
/// Tells whether a key goes through controls, or presses one: arrows, Tab, Enter and Space, without Ctrl and
/// Alt.
bool goesThroughControls(const WindowEvent& key);
/// Returns the shortcut that a key event means, or nullptr where it means none: a key that is held repeats
/// only some, and while one types only a few are left.
const Shortcut* meantShortcut(const WindowEvent& key, const KeyFocus& focus);

} // namespace relume
