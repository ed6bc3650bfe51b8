#include "app/viewer/shell/viewer.h"

#include "app/viewer/edits/object_edits.h"
#include "app/viewer/state/views.h"
#include "assets/base/error.h"
#include "shaders/shader_library.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>

namespace relume {
namespace {

constexpr float kExposureStep = 0.25f; // [EV] of a key press

// Tells whether an action is from `first` to `last` in the order in which they are declared.
bool within(Action action, Action first, Action last) {
    return action >= first && action <= last;
}

template<typename T>
void next(T& choice, size_t count) {
    choice = static_cast<T>((static_cast<size_t>(choice) + 1) % count);
}

} // namespace

void Viewer::tell(const char* kind, const std::string& what) const {
    if (desc_.logActions) std::fprintf(stderr, "%s: %s\n", kind, what.c_str());
}

void Viewer::edit(const std::string& name, const Document& next) {
    if (name != edited_) tell("edit", name);
    beforeEdit(name, edited_);
    edited_ = name;
    session_->edit(name, next);
    pacer_.input();
}

void Viewer::note(const std::string& text, bool bad) {
    if (bad) tell("error", text);
    ui_.messages().add(text, bad, now());
    pacer_.input();
}

void Viewer::perform(Action action, int argument) {
    tell("action", shortcutOf(action, argument).name);
    pacer_.input();
    if (within(action, Action::Open, Action::Watch)) return performFile(action);
    if (within(action, Action::Undo, Action::Redo)) return performUndo(action);
    if (within(action, Action::MakePass, Action::Reset)) return performBake(action);
    if (within(action, Action::AddLight, Action::NoSkyPicture)) return performLight(action, argument);
    if (within(action, Action::Wipe, Action::StoreReference)) return performWipe(action);
    if (within(action, Action::View, Action::AutomaticExposure)) return performView(action, argument);
    if (within(action, Action::FrameAll, Action::StoreBookmark)) return performCamera(action);
    if (within(action, Action::Screenshot, Action::Caption)) return performCapture(action);
    switch (action) {
    case Action::Quit:
        return quit();
    case Action::Close:
        if (!ui_.closeDialog() && status_.phase == BakeStatus::Phase::Baking) bake_->abortPass();
        return;
    case Action::Nudge:
        return nudge(argument);
    case Action::HideObject:
    case Action::ShowObjects:
        return performObject(action);
    case Action::Gizmo:
        view_.gizmo = static_cast<GizmoMode>(argument);
        return;
    case Action::LightIcons:
        view_.lightIcons = !view_.lightIcons;
        return;
    case Action::ReloadShaders:
        return reloadShaders();
    case Action::Help:
        return ui_.toggleHelp();
    case Action::HideUi:
        hidden_ = !hidden_;
        return;
    case Action::Panel:
        return ui_.showPanel(static_cast<size_t>(argument));
    default:
        return;
    }
}

void Viewer::performUndo(Action action) {
    const bool undo = action == Action::Undo;
    const std::string name = undo ? session_->undoName() : session_->redoName();
    edited_.clear();
    if (!name.empty()) beforeEdit((undo ? "undo of " : "redo of ") + name, "");
    if (!(undo ? session_->undo() : session_->redo()))
        return note(undo ? "nothing to undo" : "nothing to make again");
    tell(undo ? "undo" : "redo", name);
}

void Viewer::performBake(Action action) {
    if (session_->scene() == nullptr) return note("there is no scene to bake", true);
    switch (action) {
    case Action::MakePass:
        return bake_->makePass();
    case Action::Step:
        return bake_->step();
    case Action::Reset:
        return bake_->reset();
    default:
        break;
    }
    if (status_.phase == BakeStatus::Phase::Paused)
        bake_->resume();
    else
        bake_->pause();
}

void Viewer::performView(Action action, int argument) {
    switch (action) {
    case Action::View:
        if (viewEntries()[static_cast<size_t>(argument)].content == MapContent::Layer) return toggleAlone();
        view_.view = static_cast<size_t>(argument);
        break;
    case Action::UvTexture:
        view_.uv = !view_.uv;
        break;
    case Action::Masked:
        view_.masked = !view_.masked;
        break;
    case Action::NextFilter:
        next(view_.filter, filterNames().size());
        note("lightmap filter: " + filterNames()[static_cast<size_t>(view_.filter)]);
        break;
    case Action::NextTone:
        next(view_.tone, toneNames().size());
        note("tone mapping: " + toneNames()[static_cast<size_t>(view_.tone)]);
        break;
    case Action::AutomaticExposure:
        view_.exposure = view_.exposure ? std::nullopt : std::optional(pane_.exposure());
        break;
    default: {
        const float step = action == Action::Brighter ? kExposureStep : -kExposureStep;
        view_.exposure = view_.exposure.value_or(pane_.exposure()) + step;
        note(fmt::format("exposure {:+.2f} EV", *view_.exposure));
        break;
    }
    }
    changeScene();
}

void Viewer::performCamera(Action action) {
    const LoadedScene* scene = session_->scene();
    if (scene == nullptr) return;
    const float aspect = area_.size.y > 0 ? area_.size.x / area_.size.y : 1.0f;
    switch (action) {
    case Action::FrameAll:
        if (view_.uv) {
            view_.uvWindow = {};
        } else {
            camera_.frame(scene->geometry.bounds, aspect);
        }
        break;
    case Action::FrameSelected: {
        if (view_.selected < 0) return note("nothing is selected: click something");
        const WorldMesh& mesh = scene->prepared.mesh;
        const glm::mat4 placement =
            placementOf(*scene, session_->document().edits, static_cast<uint32_t>(view_.selected));
        Box box;
        for (size_t i = 0; i < mesh.triangleCount(); ++i)
            for (size_t k = 0; k < 3 && mesh.instance[i] == static_cast<uint32_t>(view_.selected); ++k)
                box.add(glm::vec3(placement * glm::vec4(mesh.positions[3 * i + k], 1.0f)));
        camera_.frame(box, aspect);
        break;
    }
    case Action::ResetCamera:
        camera_.reset();
        break;
    default:
        return storeBookmark();
    }
    cameraMoved();
}

void Viewer::storeBookmark() {
    std::vector<Bookmark>& marks = preferences_.bookmarks[scenePath()];
    const auto taken = [&](const std::string& name) {
        return std::any_of(marks.begin(), marks.end(),
                           [&](const Bookmark& mark) { return mark.name == name; });
    };
    size_t number = marks.size() + 1;
    while (taken(fmt::format("bookmark {}", number)))
        ++number;
    marks.push_back({fmt::format("bookmark {}", number), camera_.camera()});
    savePreferences();
    note("stored " + marks.back().name);
}

void Viewer::reloadShaders() {
    if (shaderFolder().empty())
        return note("the shaders are built in: start with --shaders FOLDER, a copy of them");
    try {
        pane_.reload();
        bake_->reloadShaders();
        note("shaders reloaded");
    } catch (const Error& error) {
        spdlog::error("{}", error.what()); // shown as well: followLog()
    }
    changeScene();
}

} // namespace relume
