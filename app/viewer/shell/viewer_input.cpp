#include "app/viewer/shell/viewer.h"

#include "app/viewer/state/views.h"

#include <algorithm>
#include <cmath>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace relume {
namespace {

constexpr double kClickSlack = 4;   // a hand moves so far while it clicks [screen coordinates]
constexpr float kUvZoomStep = 1.2f; // of one step of a wheel

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

const char* dragName(int button, int mods) {
    if (button == GLFW_MOUSE_BUTTON_RIGHT) return "look";
    return button == GLFW_MOUSE_BUTTON_MIDDLE || (mods & GLFW_MOD_SHIFT) != 0 ? "pan" : "orbit";
}

} // namespace

void Viewer::handle(const std::vector<WindowEvent>& events) {
    if (!events.empty()) pacer_.input();
    told_.inputs += events.size();
    told_.settled = told_.settled && events.empty();
    for (const WindowEvent& event : events) {
        gui_.feed(event);
        switch (event.kind) {
        case WindowEvent::Kind::Key:
            onKey(event);
            break;
        case WindowEvent::Kind::Button:
            onButton(event);
            break;
        case WindowEvent::Kind::Cursor:
            onCursor(event);
            break;
        case WindowEvent::Kind::Scroll:
            onScroll(event);
            break;
        case WindowEvent::Kind::Drop:
            if (!event.paths.empty()) {
                tell("dropped", event.paths.front());
                open(event.paths.front());
            }
            break;
        case WindowEvent::Kind::Focus:
            if (!event.pressed) keys_.clear(); // their releases go to another window
            break;
        default:
            break;
        }
    }
}

void Viewer::onKey(const WindowEvent& event) {
    if (ui_.question().isOpen()) {
        if (event.pressed) ui_.question().answer(event.code);
        return;
    }
    const bool typing = gui_.wantsKeyboard();
    fast_ = (event.mods & GLFW_MOD_SHIFT) != 0;
    // A press of Ctrl itself does not count among its modifiers.
    const bool control = event.code == GLFW_KEY_LEFT_CONTROL || event.code == GLFW_KEY_RIGHT_CONTROL;
    control_ = control ? event.pressed : (event.mods & GLFW_MOD_CONTROL) != 0;
    if (drag_) return control ? dragGizmo(cursor_) : onDragKey(event);
    if (flightOf(event.place) != glm::ivec3(0)) {
        std::erase(keys_, event.place);
        const bool alone = (event.mods & (GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SUPER)) == 0;
        if (event.pressed && alone && !typing) {
            keys_.push_back(event.place);
            if (!event.repeated) tell("action", "fly");
            return;
        }
    }
    if (!event.pressed) return;
    const Shortcut* shortcut = findShortcut(event.code, event.mods);
    if (shortcut == nullptr) return;
    const bool repeats = shortcut->action == Action::Darker || shortcut->action == Action::Brighter ||
                         shortcut->action == Action::Undo || shortcut->action == Action::Redo ||
                         shortcut->action == Action::LightStrength || shortcut->action == Action::Nudge;
    if (event.repeated && !repeats) return;
    // Letters, and Ctrl with one, go to the text while one types; Esc leaves a field, or closes a dialog.
    const bool closes = shortcut->action == Action::Close && ui_.files().isOpen();
    if (typing && !closes && !isFunctionKey(event.code) && shortcut->action != Action::Quit) return;
    perform(shortcut->action, shortcut->argument);
}

bool Viewer::overScene(const glm::dvec2& at) const {
    const glm::vec2 p(at), low = area_.corner, high = area_.corner + area_.size;
    return p.x >= low.x && p.y >= low.y && p.x < high.x && p.y < high.y && !gui_.wantsMouse();
}

void Viewer::onButton(const WindowEvent& event) {
    cursor_ = event.at;
    if (wipeDrag_) {
        if (!event.pressed && event.code == GLFW_MOUSE_BUTTON_LEFT) wipeDrag_ = false;
        return;
    }
    if (drag_) {
        if (!event.pressed && event.code == GLFW_MOUSE_BUTTON_LEFT) endDrag();
        return;
    }
    if (!event.pressed) {
        if (!camera_.dragging() || event.code != button_) return;
        camera_.end();
        const bool moved = glm::distance(event.at, pressed_) > kClickSlack;
        if (moved)
            tell("action", dragName(event.code, event.mods));
        else if (event.code == GLFW_MOUSE_BUTTON_LEFT)
            onClick(event);
        return;
    }
    if (camera_.dragging() || !overScene(event.at)) return;
    if (event.code == GLFW_MOUSE_BUTTON_LEFT && overWipe(event.at)) {
        wipeDrag_ = true;
        return;
    }
    if (event.code == GLFW_MOUSE_BUTTON_LEFT && pressGizmo(event.at)) return;
    button_ = event.code;
    pressed_ = event.at;
    dragged_ = false;
    if (event.code == GLFW_MOUSE_BUTTON_LEFT)
        camera_.begin((event.mods & GLFW_MOD_SHIFT) != 0 ? CameraControl::Drag::Pan
                                                         : CameraControl::Drag::Orbit);
    else if (event.code == GLFW_MOUSE_BUTTON_MIDDLE)
        camera_.begin(CameraControl::Drag::Pan);
    else if (event.code == GLFW_MOUSE_BUTTON_RIGHT)
        camera_.begin(CameraControl::Drag::Look);
}

void Viewer::onCursor(const WindowEvent& event) {
    const glm::dvec2 before = cursor_;
    cursor_ = event.at;
    if (wipeDrag_) return dragWipe(event.at);
    if (drag_) return dragGizmo(event.at);
    // A click that trembles is no drag: it would leave the camera a little beside.
    if (!camera_.dragging() || area_.size.y <= 0) return;
    if (!dragged_ && glm::distance(event.at, pressed_) <= kClickSlack) return;
    const glm::dvec2 way = (event.at - (dragged_ ? before : pressed_)) / double(area_.size.y);
    dragged_ = true;
    if (view_.uv) {
        view_.uvWindow = pan(view_.uvWindow, glm::vec2(way) * area_.size.y, area_.size);
        changeScene();
    } else if (camera_.move(static_cast<float>(way.x), static_cast<float>(way.y))) {
        cameraMoved();
    }
}

void Viewer::onScroll(const WindowEvent& event) {
    if (!overScene(cursor_)) return;
    const auto steps = static_cast<float>(event.at.y);
    if (view_.uv) {
        view_.uvWindow =
            zoom(view_.uvWindow, std::pow(kUvZoomStep, steps), glm::vec2(cursor_) - area_.corner, area_.size);
        changeScene();
    } else {
        camera_.zoomBy(steps);
        cameraMoved();
    }
    tell("action", "zoom");
}

void Viewer::updateFlight() {
    glm::ivec3 held(0);
    for (const int key : keys_)
        held += flightOf(key);
    camera_.setFlight({held, fast_});
}

void Viewer::cameraMoved() {
    moved_ = now();
    changeScene();
}

// Selects an instance or, with Ctrl or in its own view, the patch to see from.
void Viewer::onClick(const WindowEvent& event) {
    if (showsLights())
        if (const std::optional<LightKey> icon = iconAt(stage(), pointAt(event.at))) return selectLight(icon);
    const glm::vec2 pixel = (glm::vec2(event.at) - area_.corner) * pixelsPerPoint();
    const std::optional<Pick> pick = pane_.pick(look(), pixel);
    const size_t seen = viewIndex("seen");
    const bool patch = (event.mods & GLFW_MOD_CONTROL) != 0 || view_.view == seen;
    if (patch && pick && pick->lightmapUv) {
        const uint32_t size = session_->document().bake.size;
        view_.seenTexel = pick->texel.y * size + pick->texel.x;
        view_.view = seen;
        tell("action", "see from " + std::to_string(*view_.seenTexel));
    } else if (!patch && !view_.uv) {
        const int instance = pick ? static_cast<int>(pick->instance) : -1;
        view_.selected = instance == view_.selected ? -1 : instance;
        tell("action", "select " + std::to_string(view_.selected));
        view_.light.reset();
        if (view_.selected >= 0) {
            const LightKey emitter{LightKey::Kind::Emitter, pick->instance, pick->material};
            if (lights_.find(emitter) != nullptr) selectLight(emitter);
        }
    }
    changeScene();
}

} // namespace relume
