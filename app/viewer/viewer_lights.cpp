#include "app/viewer/viewer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <glm/gtc/matrix_transform.hpp>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace relume {
namespace {

using Kind = LightKey::Kind;

constexpr float kStrengthStep = 1.18920712f; // of a key press, 2^(1/4)
constexpr float kNudge = 0.005f;             // of the scene's diagonal
constexpr float kNudgeTurn = 5.0f;           // [degrees]
constexpr float kGap = 1e-3f;                // of the scene's diagonal, between a surface and a light on it

// Axes of the world that are the most to the right of a picture, up and forward in it, with their directions.
glm::mat3 nearestAxes(const ViewCamera& camera) {
    const glm::vec3 side = right(camera), front = forward(camera), up = glm::cross(side, front);
    glm::mat3 axes(0.0f);
    glm::bvec3 taken(false);
    for (const int row : {0, 1, 2}) {
        const glm::vec3 wanted = row == 0 ? side : row == 1 ? up : front;
        int best = -1;
        for (int axis = 0; axis < 3; ++axis)
            if (!taken[axis] && (best < 0 || std::abs(wanted[axis]) > std::abs(wanted[best]))) best = axis;
        taken[best] = true;
        axes[row][best] = wanted[best] < 0 ? -1.0f : 1.0f;
    }
    return axes;
}

} // namespace

LightStage Viewer::stage() const {
    const Document& document = session_->document();
    return {.edits = document.edits,
            .mix = document.mix,
            .view = view_,
            .screen = {camera_.camera(), glm::max(area_.size / scale_, glm::vec2(1.0f))},
            .scale = scale_};
}

// Of the picture [points], as the stage has it.
glm::vec2 Viewer::pointAt(const glm::dvec2& at) const {
    return (glm::vec2(at) - area_.corner) / scale_;
}

bool Viewer::showsLights() const {
    return session_->scene() != nullptr && !view_.uv && !hidden_;
}

void Viewer::selectLight(const std::optional<LightKey>& key) {
    view_.light = key;
    view_.selected = key && key->kind == Kind::Emitter ? static_cast<int>(key->index) : -1;
    const LightSource* source = key ? lights_.find(*key) : nullptr;
    tell("action", "select light " + (source != nullptr ? source->name : std::string("none")));
    changeScene();
}

// What is gone cannot stay selected; what is muted is dark.
void Viewer::followLights() {
    if (!lights_.update(session_->scene(), *session_)) return;
    if (view_.light && lights_.find(*view_.light) == nullptr) view_.light.reset();
    std::vector<Material> shown = session_->document().edits.materials;
    std::vector<bool> shines(shown.size(), false), lights(shown.size(), false);
    for (const LightSource& source : lights_.sources()) {
        if (source.key.kind != Kind::Emitter) continue;
        lights[source.key.material] = true;
        if (session_->document().mix.shines(source.key)) shines[source.key.material] = true;
    }
    for (size_t i = 0; i < shown.size(); ++i)
        if (lights[i] && !shines[i]) shown[i].emission = glm::vec3(0.0f);
    showMaterials(std::move(shown));
    SkySettings sky = session_->document().edits.sky;
    if (!session_->document().mix.shines({Kind::Sky, 0, 0})) sky.radiance = glm::vec3(0.0f);
    pane_.setSky(sky);
    changeScene();
    pacer_.input();
}

LightSpot Viewer::lightSpot() {
    const glm::vec2 middle = 0.5f * pixelsPerPoint() * area_.size;
    const ViewCamera& camera = camera_.camera();
    const std::optional<Pick> pick = view_.uv ? std::nullopt : pane_.pick(look(), middle);
    const PublishedMap* newest = map();
    const bool light = newest != nullptr && newest->content == MapContent::Light && !newest->radiance;
    return {.camera = glm::inverse(viewMatrix(camera)),
            .seen = pick ? pick->position : camera.target,
            .lighting = light ? newest->ambient : glm::vec3(0.0f)};
}

void Viewer::addLight(int what) {
    Document next = session_->document();
    LightKey key{Kind::Sky, 0, 0};
    if (what != kAddSky) {
        key = addLamp(next, makeLight(static_cast<LightType>(what), lightSpot()));
        editOnce("Add " + next.edits.lights.back().name, next);
    } else if (next.edits.sky.radiance != glm::vec3(0.0f)) {
        note("the scene has a sky");
    } else {
        next.edits.sky = makeSky(next.edits.sky, lightSpot());
        editOnce("Add sky", next);
    }
    followLights();
    selectLight(key);
}

// The next light of the board.
void Viewer::stepLight(int step) {
    const std::vector<LightSource>& sources = lights_.sources();
    if (sources.empty()) return note("there are no lights");
    const auto count = static_cast<int>(sources.size());
    const auto found = std::find_if(sources.begin(), sources.end(),
                                    [&](const LightSource& source) { return view_.light == source.key; });
    const int before =
        found == sources.end() ? (step > 0 ? -1 : 0) : static_cast<int>(found - sources.begin());
    selectLight(sources[static_cast<size_t>((before + step + count) % count)].key);
}

void Viewer::editOnce(const std::string& name, const Document& next) {
    edit(name, next);
    endEdit();
}

void Viewer::endEdit() {
    edited_.clear();
    session_->endEdit();
}

void Viewer::performLight(Action action, int argument) {
    if (session_->scene() == nullptr) return note("there is no scene to light", true);
    if (action == Action::AddLight) return addLight(argument);
    if (action == Action::NextLight) return stepLight(argument);
    const LightSource* found = view_.light ? lights_.find(*view_.light) : nullptr;
    if (found == nullptr) return note("no light is selected: click one, or press L");
    const LightSource source = *found;
    const LightKey& key = source.key;
    Document next = session_->document();
    const bool power =
        action == Action::SoloLight || action == Action::MuteLight || action == Action::LightStrength;
    if (!power && key.kind != Kind::Lamp)
        return note(source.name + ": only lights without geometry can be moved, copied and deleted");
    switch (action) {
    case Action::SoloLight:
        toggle(next.mix.solo, key);
        return editOnce("Solo of " + source.name, next);
    case Action::MuteLight:
        toggle(next.mix.muted, key);
        return editOnce("Mute of " + source.name, next);
    case Action::LightStrength: {
        LightPower changed = powerOf(next.edits, key);
        changed.intensity *= argument > 0 ? kStrengthStep : 1.0f / kStrengthStep;
        setPower(next.edits, key, changed);
        return editOnce("Intensity of " + source.name, next);
    }
    case Action::DuplicateLight: {
        const LightKey copy = duplicateLamp(next, key.index);
        editOnce("Duplicate " + source.name, next);
        followLights();
        return selectLight(copy);
    }
    case Action::DeleteLight:
        eraseLamp(next, key.index);
        editOnce("Delete " + source.name, next);
        view_.light.reset();
        return;
    default:
        return nudgeLight(source, argument);
    }
}

void Viewer::nudgeLight(const LightSource& source, int argument) {
    Document next = session_->document();
    glm::mat4& transform = next.edits.lights[source.key.index].transform;
    const glm::mat3 axes = nearestAxes(camera_.camera());
    const float sign = argument < 0 ? -1.0f : 1.0f;
    const int along = std::abs(argument) - 1;
    if (view_.gizmo == GizmoMode::Translate) {
        const float step = kNudge * session_->scene()->geometry.bounds.diagonal();
        transform[3] += glm::vec4(sign * step * axes[along], 0.0f);
        return editOnce("Position of " + source.name, next);
    }
    // Right: about what points up; up: about what points right.
    const glm::vec3 axis = along == 0 ? axes[1] : along == 1 ? axes[0] : axes[2];
    const glm::vec4 place = transform[3];
    transform = glm::rotate(glm::mat4(1.0f), glm::radians(sign * kNudgeTurn), axis) * transform;
    transform[3] = place;
    editOnce("Rotation of " + source.name, next);
}

bool Viewer::pressLights(const glm::dvec2& at) {
    if (!showsLights()) return false;
    const std::optional<GizmoPlace> place = gizmoOf(stage());
    const glm::vec2 point = pointAt(at);
    const GizmoHandle handle = place ? gizmoAt(*place, point) : GizmoHandle::None;
    if (handle == GizmoHandle::None) return false;
    endEdit(); // of whatever came before: this is a step of its own
    lightDrag_.emplace(*place, handle, selectedLamp(stage())->transform, point);
    return true;
}

void Viewer::dragLight(const glm::dvec2& at) {
    const Light* light = selectedLamp(stage());
    const LightSource* source = view_.light ? lights_.find(*view_.light) : nullptr;
    if (light == nullptr || source == nullptr) return endLightDrag(); // undone meanwhile
    const bool moves = lightDrag_->mode() == GizmoMode::Translate;
    glm::mat4 transform = lightDrag_->moved(pointAt(at), control_);
    if (control_ && moves) {
        const glm::vec2 pixel = (glm::vec2(at) - area_.corner) * pixelsPerPoint();
        const std::optional<Pick> pick = pane_.pick(look(), pixel);
        if (!pick) return;
        const LoadedScene& scene = *session_->scene();
        const glm::vec3 normal = normalAt(scene.prepared.mesh, pick->instance, pick->position,
                                          towardsEye(camera_.camera(), pick->position));
        Light begun = *light;
        begun.transform = lightDrag_->begin();
        transform = placedOn(begun, pick->position, normal, kGap * scene.geometry.bounds.diagonal());
    }
    if (transform == light->transform) return;
    Document next = session_->document();
    next.edits.lights[view_.light->index].transform = transform;
    edit((moves ? "Move " : "Turn ") + source->name, next);
}

void Viewer::endLightDrag() {
    lightDrag_.reset();
    endEdit();
}

// Keys while a gizmo is held.
void Viewer::onDragKey(const WindowEvent& event) {
    if (!event.pressed) return;
    switch (event.code) {
    case GLFW_KEY_X:
        lightDrag_->constrain(GizmoHandle::X);
        break;
    case GLFW_KEY_Y:
        lightDrag_->constrain(GizmoHandle::Y);
        break;
    case GLFW_KEY_Z:
        lightDrag_->constrain(GizmoHandle::Z);
        break;
    case GLFW_KEY_ESCAPE:
        session_->cancelEdit();
        tell("action", "drag cancelled");
        return endLightDrag();
    default:
        return;
    }
    dragLight(cursor_);
}

// Where one can click icons and take hold of the gizmo.
void Viewer::tellLightPlaces() {
    constexpr std::array<const char*, 8> kHandles = {"", "X", "Y", "Z", "YZ", "ZX", "XY", "Screen"};
    const LightStage now = stage();
    const auto add = [&](const char* name, const glm::vec2& point) {
        items_.add(name, glm::ivec2(glm::round(area_.corner + scale_ * point)));
    };
    {
        const ui::ItemLog::Scope scope(items_, "Icons");
        for (const LightSource& source : lights_.sources()) {
            if (source.key.kind != Kind::Lamp) continue;
            const Light& light = now.edits.lights[source.key.index];
            const auto place = project(now.screen, glm::vec3(light.transform[3]));
            if (place) add(source.name.c_str(), *place);
        }
    }
    const ui::ItemLog::Scope scope(items_, "Gizmo");
    const std::optional<GizmoPlace> place = gizmoOf(now);
    GizmoHandle before = GizmoHandle::None;
    for (const GizmoShape& shape : place ? gizmoShapes(*place) : std::vector<GizmoShape>())
        if (shape.handle != std::exchange(before, shape.handle))
            add(kHandles[static_cast<size_t>(shape.handle)], gripOf(shape));
}

void Viewer::drawLightOverlay() {
    if (!showsLights()) return;
    if (desc_.logActions) tellLightPlaces();
    GizmoHandle held = lightDrag_ ? lightDrag_->handle() : GizmoHandle::None;
    const std::optional<GizmoPlace> place = gizmoOf(stage());
    if (!lightDrag_ && place && !camera_.dragging() && overScene(cursor_))
        held = gizmoAt(*place, pointAt(cursor_));
    drawLights(stage(), area_.corner, held);
}

} // namespace relume
