#include "app/viewer/state/held_input.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace relume {
namespace {

constexpr double kClickSlack = 4; // a hand moves so far while it clicks [screen coordinates]

bool isFunctionKey(int key) {
    return key >= GLFW_KEY_F1 && key <= GLFW_KEY_F25;
}

// Returns the direction of flight of a place on the keyboard. Places, not letters, lie together on every
// layout.
glm::ivec3 flightOf(int place) {
    switch (place) {
    case GLFW_KEY_D:
        return {1, 0, 0};
    case GLFW_KEY_A:
        return {-1, 0, 0};
    case GLFW_KEY_E:
        return {0, 1, 0};
    case GLFW_KEY_Q:
        return {0, -1, 0};
    case GLFW_KEY_W:
        return {0, 0, 1};
    case GLFW_KEY_S:
        return {0, 0, -1};
    default:
        return {0, 0, 0};
    }
}

bool repeats(Action action) {
    return action == Action::Darker || action == Action::Brighter || action == Action::Undo ||
           action == Action::Redo || action == Action::LightStrength || action == Action::Nudge;
}

} // namespace

void HeldInput::followModifiers(const WindowEvent& key) {
    fast_ = (key.mods & GLFW_MOD_SHIFT) != 0;
    // A press of Ctrl itself does not count among its modifiers.
    const bool itself = key.code == GLFW_KEY_LEFT_CONTROL || key.code == GLFW_KEY_RIGHT_CONTROL;
    control_ = itself ? key.pressed : (key.mods & GLFW_MOD_CONTROL) != 0;
}

bool HeldInput::takeFlightKey(const WindowEvent& key, bool typing) {
    if (flightOf(key.place) == glm::ivec3(0)) return false;
    std::erase(keys_, key.place);
    const bool alone = (key.mods & (GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SUPER)) == 0;
    if (!key.pressed || !alone || typing) return false;
    keys_.push_back(key.place);
    return true;
}

CameraControl::Flight HeldInput::flight() const {
    glm::ivec3 held(0);
    for (const int key : keys_)
        held += flightOf(key);
    return {held, fast_};
}

void HeldInput::press(int button, const glm::dvec2& at) {
    cursor_ = at;
    press_ = Press{button, at};
}

std::optional<glm::dvec2> HeldInput::drag(const glm::dvec2& at) {
    const glm::dvec2 before = cursor_;
    cursor_ = at;
    if (!press_) return std::nullopt;
    // A click that trembles is no drag: it would leave the camera a little beside.
    if (!press_->dragged && glm::distance(at, press_->at) <= kClickSlack) return std::nullopt;
    const glm::dvec2 way = at - (press_->dragged ? before : press_->at);
    press_->dragged = true;
    return way;
}

HeldInput::Release HeldInput::release(int button, const glm::dvec2& at) {
    cursor_ = at;
    if (!press_ || press_->button != button) return Release::Nothing;
    const bool moved = glm::distance(at, press_->at) > kClickSlack;
    press_.reset();
    return moved ? Release::Drag : Release::Click;
}

CameraControl::Drag cameraDragOf(int button, int mods) {
    switch (button) {
    case GLFW_MOUSE_BUTTON_LEFT:
        return (mods & GLFW_MOD_SHIFT) != 0 ? CameraControl::Drag::Pan : CameraControl::Drag::Orbit;
    case GLFW_MOUSE_BUTTON_MIDDLE:
        return CameraControl::Drag::Pan;
    case GLFW_MOUSE_BUTTON_RIGHT:
        return CameraControl::Drag::Look;
    default:
        return CameraControl::Drag::None;
    }
}

const char* cameraDragName(int button, int mods) {
    if (button == GLFW_MOUSE_BUTTON_RIGHT) return "look";
    return button == GLFW_MOUSE_BUTTON_MIDDLE || (mods & GLFW_MOD_SHIFT) != 0 ? "pan" : "orbit";
}

bool goesThroughControls(const WindowEvent& key) {
    if ((key.mods & (GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SUPER)) != 0) return false;
    switch (key.code) {
    case GLFW_KEY_LEFT:
    case GLFW_KEY_RIGHT:
    case GLFW_KEY_UP:
    case GLFW_KEY_DOWN:
    case GLFW_KEY_TAB:
    case GLFW_KEY_ENTER:
    case GLFW_KEY_KP_ENTER:
    case GLFW_KEY_SPACE:
        return true;
    default:
        return false;
    }
}

const Shortcut* meantShortcut(const WindowEvent& key, const KeyFocus& focus) {
    if (!key.pressed || (focus.page && goesThroughControls(key))) return nullptr;
    const Shortcut* shortcut = findShortcut(key.code, key.mods);
    if (shortcut == nullptr || (key.repeated && !repeats(shortcut->action))) return nullptr;
    // Letters, and Ctrl with one, go to the text while one types; Esc leaves a field, or closes a dialog.
    const bool closes = shortcut->action == Action::Close && focus.fileDialog;
    const bool goes = !focus.typing || closes || isFunctionKey(key.code) || shortcut->action == Action::Quit;
    return goes ? shortcut : nullptr;
}

} // namespace relume
