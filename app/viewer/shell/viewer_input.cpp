// This is the part of the viewer that hands input and actions to whom they concern.
#include "app/viewer/edits/object_edits.h"
#include "app/viewer/shell/viewer.h"
#include "app/viewer/state/view_actions.h"
#include "app/viewer/state/views.h"
#include "assets/base/error.h"
#include "shaders/shader_library.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace relume {
namespace {

// Tells whether an action is from `first` to `last` in the order in which they are declared.
bool within(Action action, Action first, Action last) {
    return action >= first && action <= last;
}

} // namespace

void Viewer::handle(const std::vector<WindowEvent>& events) {
    if (!events.empty()) feedback_.pacer().input();
    screenLog_.countInputs(events.size());
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
                feedback_.tell("dropped", event.paths.front());
                files_.open(event.paths.front());
            }
            break;
        case WindowEvent::Kind::Focus:
            if (!event.pressed) input_.releaseKeys(); // their releases go to another window
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
    input_.followModifiers(event);
    if (mover_.held()) {
        if (!event.pressed) input_.takeFlightKey(event, false); // a flight may end meanwhile
        return mover_.takeKey(event, input_.cursor(), input_.control());
    }
    const bool typing = gui_.wantsKeyboard();
    if (input_.takeFlightKey(event, typing)) {
        if (!event.repeated) feedback_.tell("action", "fly");
        return;
    }
    const KeyFocus focus{.typing = typing,
                         .fileDialog = ui_.files().isOpen(),
                         .page = ui_.takesKeys(files_.opening().middle(openingFacts()))};
    if (const Shortcut* shortcut = meantShortcut(event, focus)) perform(shortcut->action, shortcut->argument);
}

bool Viewer::overScene(const glm::dvec2& at) const {
    return picture_.area().has(at) && !gui_.wantsMouse();
}

void Viewer::onButton(const WindowEvent& event) {
    input_.setCursor(event.at);
    const bool left = event.code == GLFW_MOUSE_BUTTON_LEFT, ends = left && !event.pressed;
    if (comparison_.held()) {
        if (ends) comparison_.release();
        return;
    }
    if (mover_.held()) {
        if (ends) mover_.release();
        return;
    }
    if (!event.pressed) {
        const HeldInput::Release ended = input_.release(event.code, event.at);
        if (ended == HeldInput::Release::Nothing) return;
        picture_.camera().end();
        if (ended == HeldInput::Release::Drag)
            feedback_.tell("action", cameraDragName(event.code, event.mods));
        else if (left)
            onClick(event);
        return;
    }
    if (input_.pressed() || !overScene(event.at)) return;
    if (left && (comparison_.press(event.at) || mover_.press(event.at))) return;
    const CameraControl::Drag drag = cameraDragOf(event.code, event.mods);
    if (drag == CameraControl::Drag::None) return;
    input_.press(event.code, event.at);
    picture_.camera().begin(drag);
}

void Viewer::onCursor(const WindowEvent& event) {
    const std::optional<glm::dvec2> way = input_.drag(event.at);
    if (comparison_.held()) return comparison_.drag(event.at);
    if (mover_.held()) return mover_.drag(event.at, input_.control());
    if (way) picture_.drag(*way);
}

void Viewer::onScroll(const WindowEvent& event) {
    if (!overScene(input_.cursor())) return;
    picture_.zoom(static_cast<float>(event.at.y), input_.cursor());
    feedback_.tell("action", "zoom");
}

// Selects an instance and the texel whose error is told or, with Ctrl or in its own view, the patch to see
// from.
void Viewer::onClick(const WindowEvent& event) {
    if (const std::optional<LightKey> icon = mover_.iconAt(event.at)) return lights_.select(*icon);
    ViewState& view = picture_.state();
    const std::optional<Pick> pick = picture_.pick(event.at);
    if (mover_.selectBallAt(event.at, pick)) return lights_.selectNone();
    const size_t seen = viewIndex("seen");
    const bool patch = (event.mods & GLFW_MOD_CONTROL) != 0 || view.view == seen;
    if (patch && pick && pick->lightmapUv) {
        view.seenTexel = pick->texel.y * mapSize(session_) + pick->texel.x;
        view.view = seen;
        feedback_.tell("action", "see from " + std::to_string(*view.seenTexel));
    } else if (!patch) {
        if (!view.uv) lights_.selectObject(pick);
        inspection_.readout().choose(pick);
    }
    feedback_.sceneChanged();
}

void Viewer::perform(Action action, int argument) {
    feedback_.tell("action", shortcutOf(action, argument).name);
    feedback_.pacer().input();
    act(action, argument);
    lights_.follow(); // a menu's action comes amid a frame, whose panels know no light that is gone
}

void Viewer::act(Action action, int argument) {
    if (within(action, Action::Open, Action::Quit)) return files_.perform(action, argument);
    if (within(action, Action::MakePass, Action::Reset)) return baking_.perform(action);
    if (within(action, Action::AddLight, Action::LightStrength)) return lightKeys_.perform(action, argument);
    if (within(action, Action::Wipe, Action::StoreReference)) return comparison_.perform(action);
    if (within(action, Action::View, Action::AutomaticExposure)) return performView(action, argument);
    if (within(action, Action::FrameAll, Action::StoreBookmark)) return performCamera(action);
    if (within(action, Action::Screenshot, Action::Caption)) return shots_.perform(action);
    ViewState& view = picture_.state();
    switch (action) {
    case Action::Undo:
        return editing_.undo();
    case Action::Redo:
        return editing_.redo();
    case Action::Close:
        if (!ui_.closeDialog() && !files_.opening().putAway(openingFacts())) baking_.abortPass();
        return;
    case Action::SkyPicture:
        return skyKeys_.choose(ui_.files(), files_.folder());
    case Action::NoSkyPicture:
        return skyKeys_.clear();
    case Action::Nudge:
    case Action::HideObject:
    case Action::ShowObjects:
        return mover_.perform(action, argument);
    case Action::Gizmo:
        view.gizmo = static_cast<GizmoMode>(argument);
        return;
    case Action::LightIcons:
        view.lightIcons = !view.lightIcons;
        return;
    case Action::ProbeBall:
        return mover_.toggleBall();
    case Action::ProbeGrid:
        view.probes = !view.probes;
        return feedback_.sceneChanged();
    case Action::ReloadShaders:
        return reloadShaders();
    case Action::Help:
        return ui_.toggleHelp();
    case Action::HideUi:
        view.bare = !view.bare;
        return;
    case Action::Panel:
        return ui_.showPanel(static_cast<size_t>(argument));
    default:
        return;
    }
}

void Viewer::performView(Action action, int argument) {
    const bool alone =
        action == Action::View && viewEntries()[static_cast<size_t>(argument)].content == MapContent::Layer;
    if (alone) return lights_.toggleAlone();
    const std::string told = changeView(picture_.state(), action, argument, picture_.pane().exposure());
    if (!told.empty()) feedback_.note(told);
    feedback_.sceneChanged();
}

void Viewer::performCamera(Action action) {
    const LoadedScene* scene = session_.scene();
    if (scene == nullptr) return;
    if (action == Action::StoreBookmark) return storeBookmark();
    if (action == Action::FrameAll) return picture_.frameAll();
    CameraControl& camera = picture_.camera();
    if (action == Action::FrameSelected) {
        const int selected = picture_.state().selected;
        if (selected < 0) return feedback_.note("nothing is selected: click something");
        const Box bounds = placedBounds(*scene, session_.document().edits, static_cast<uint32_t>(selected));
        camera.frame(bounds, picture_.area().aspect());
    } else {
        camera.reset();
    }
    picture_.cameraMoved();
}

void Viewer::storeBookmark() {
    const std::string name = preferences_.values().addBookmark(files_.path(), picture_.camera().camera());
    savePreferences();
    feedback_.note("stored " + name);
}

void Viewer::reloadShaders() {
    if (shaderFolder().empty())
        return feedback_.note("the shaders are built in: start with --shaders FOLDER, a copy of them");
    try {
        picture_.pane().reload();
        bake_->reloadShaders();
        feedback_.note("shaders reloaded");
    } catch (const Error& error) {
        spdlog::error("{}", error.what()); // shown as well: Feedback::followLog()
    }
    feedback_.sceneChanged();
}

} // namespace relume
