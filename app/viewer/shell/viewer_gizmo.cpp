// This is the part of the viewer that moves things: lights without geometry, and objects.
#include "app/viewer/shell/viewer.h"

#include "app/viewer/edits/object_edits.h"

#include <array>
#include <cmath>
#include <utility>

#include <glm/gtc/matrix_transform.hpp>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace relume {
namespace {

constexpr float kNudge = 0.005f;   // of the scene's diagonal
constexpr float kNudgeTurn = 5.0f; // [degrees]
constexpr float kGap = 1e-3f;      // of the scene's diagonal, between a surface and a light on it

// Returns the axes of the world, with their signs, that point the most to the right of a picture, up and
// forward in it.
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
    LightStage stage{.edits = document.edits,
                     .mix = document.mix,
                     .view = view_,
                     .screen = {camera_.camera(), glm::max(area_.size / scale_, glm::vec2(1.0f))},
                     .object = {},
                     .scale = scale_};
    if (const std::optional<uint32_t> object = movableObject())
        stage.object = pivotOf(*session_->scene(), document.edits, *object);
    return stage;
}

// Returns a point of the window as one of the picture [points], as the stage has it.
glm::vec2 Viewer::pointAt(const glm::dvec2& at) const {
    return (glm::vec2(at) - area_.corner) / scale_;
}

bool Viewer::showsLights() const {
    return session_->scene() != nullptr && !view_.uv && !hidden_;
}

// Returns the selected instance, where it can be seen and no analytic light is selected.
std::optional<uint32_t> Viewer::movableObject() const {
    const std::vector<Placement>& placements = session_->document().edits.placements;
    if (view_.selected < 0 || static_cast<size_t>(view_.selected) >= placements.size()) return std::nullopt;
    const auto object = static_cast<uint32_t>(view_.selected);
    const bool lamp = view_.light && view_.light->kind == LightKey::Kind::Lamp;
    return lamp || placements[object].hidden ? std::nullopt : std::optional(object);
}

// Returns what the gizmo and the keys move in a document, or nullptr where there is nothing.
glm::mat4* Viewer::movable(Document& document) const {
    const std::optional<LightKey>& key = view_.light;
    if (key && key->kind == LightKey::Kind::Lamp && key->index < document.edits.lights.size())
        return &document.edits.lights[key->index].transform;
    const std::optional<uint32_t> object = movableObject();
    return object ? &document.edits.placements[*object].transform : nullptr;
}

std::string Viewer::movableName() const {
    if (const std::optional<uint32_t> object = movableObject())
        return objectName(session_->scene()->prepared.scene, *object);
    const LightSource* source = view_.light ? lights_.find(*view_.light) : nullptr;
    return source != nullptr ? source->name : "";
}

void Viewer::nudge(int argument) {
    Document next = session_->document();
    glm::mat4* transform = movable(next);
    if (transform == nullptr)
        return note("nothing is selected that can be moved: click an object, or a light's icon");
    const glm::mat3 axes = nearestAxes(camera_.camera());
    const float sign = argument < 0 ? -1.0f : 1.0f;
    const int along = std::abs(argument) - 1;
    if (view_.gizmo == GizmoMode::Translate) {
        const float step = kNudge * session_->scene()->geometry.bounds.diagonal();
        (*transform)[3] += glm::vec4(sign * step * axes[along], 0.0f);
        return editOnce("Position of " + movableName(), next);
    }
    // To the right it turns about what points up, upwards about what points right.
    const glm::vec3 axis = along == 0 ? axes[1] : along == 1 ? axes[0] : axes[2];
    const glm::vec3 pivot = gizmoOf(stage()).value_or(GizmoPlace{}).origin;
    const glm::mat4 turn = glm::rotate(glm::mat4(1.0f), glm::radians(sign * kNudgeTurn), axis);
    const glm::vec3 arm = glm::vec3((*transform)[3]) - pivot;
    *transform = turn * *transform;
    (*transform)[3] = glm::vec4(pivot + glm::mat3(turn) * arm, 1.0f);
    editOnce("Rotation of " + movableName(), next);
}

void Viewer::performObject(Action action) {
    if (session_->scene() == nullptr) return note("there is no scene to edit", true);
    Document next = session_->document();
    std::vector<Placement>& placements = next.edits.placements;
    if (action == Action::ShowObjects) {
        for (Placement& placement : placements)
            placement.hidden = false;
        if (placements == session_->document().edits.placements) return note("no object is hidden");
        return editOnce("Show all objects", next);
    }
    if (view_.selected < 0) return note("no object is selected: click one");
    const auto object = static_cast<uint32_t>(view_.selected);
    placements[object].hidden = !placements[object].hidden;
    editOnce((placements[object].hidden ? "Hide " : "Show ") +
                 objectName(session_->scene()->prepared.scene, object),
             next);
}

bool Viewer::pressGizmo(const glm::dvec2& at) {
    if (!showsLights()) return false;
    const std::optional<GizmoPlace> place = gizmoOf(stage());
    const glm::vec2 point = pointAt(at);
    const GizmoHandle handle = place ? gizmoAt(*place, point) : GizmoHandle::None;
    if (handle == GizmoHandle::None) return false;
    endEdit(); // of whatever came before: this is a step of its own
    Document now = session_->document();
    drag_.emplace(*place, handle, *movable(now), point);
    return true;
}

// Returns the transform that puts what is dragged on the surface under the cursor, or nothing where there is
// none.
std::optional<glm::mat4> Viewer::onSurface(const glm::dvec2& at) {
    const glm::vec2 pixel = (glm::vec2(at) - area_.corner) * pixelsPerPoint();
    const std::optional<uint32_t> object = movableObject();
    const std::optional<Pick> pick = pane_.pick(look(), pixel, object);
    if (!pick) return std::nullopt;
    const LoadedScene& scene = *session_->scene();
    const SceneEdits& edits = session_->document().edits;
    const glm::vec3 normal = placedNormalAt(scene, edits, pick->instance, pick->position,
                                            towardsEye(camera_.camera(), pick->position));
    if (object)
        return restingOn({.scene = scene, .instance = *object, .begin = drag_->begin()}, pick->position,
                         normal);
    Light begun = *selectedLamp(stage());
    begun.transform = drag_->begin();
    return placedOn(begun, pick->position, normal, kGap * scene.geometry.bounds.diagonal());
}

void Viewer::dragGizmo(const glm::dvec2& at) {
    Document next = session_->document();
    glm::mat4* transform = movable(next);
    const std::string name = movableName();
    if (transform == nullptr || name.empty()) return endDrag(); // undone meanwhile
    const bool moves = drag_->mode() == GizmoMode::Translate;
    const std::optional<glm::mat4> wanted =
        control_ && moves ? onSurface(at) : drag_->moved(pointAt(at), control_);
    if (!wanted || *wanted == *transform) return;
    *transform = *wanted;
    edit((moves ? "Move " : "Turn ") + name, next);
}

void Viewer::endDrag() {
    drag_.reset();
    endEdit();
}

// Follows keys while a gizmo is held.
void Viewer::onDragKey(const WindowEvent& event) {
    if (!event.pressed) return;
    switch (event.code) {
    case GLFW_KEY_X:
        drag_->constrain(GizmoHandle::X);
        break;
    case GLFW_KEY_Y:
        drag_->constrain(GizmoHandle::Y);
        break;
    case GLFW_KEY_Z:
        drag_->constrain(GizmoHandle::Z);
        break;
    case GLFW_KEY_ESCAPE:
        session_->cancelEdit();
        tell("action", "drag cancelled");
        return endDrag();
    default:
        return;
    }
    dragGizmo(cursor_);
}

// Tells where one can click icons and take hold of the gizmo.
void Viewer::tellPlaces() {
    constexpr std::array<const char*, 8> kHandles = {"", "X", "Y", "Z", "YZ", "ZX", "XY", "Screen"};
    const LightStage now = stage();
    const auto add = [&](const char* name, const glm::vec2& point) {
        items_.add(name, glm::ivec2(glm::round(area_.corner + scale_ * point)));
    };
    {
        const ui::ItemLog::Scope scope(items_, "Icons");
        for (const LightSource& source : lights_.sources()) {
            if (source.key.kind != LightKey::Kind::Lamp) continue;
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

void Viewer::drawOverlay() {
    if (!showsLights()) return;
    if (desc_.logActions) tellPlaces();
    GizmoHandle held = drag_ ? drag_->handle() : GizmoHandle::None;
    const std::optional<GizmoPlace> place = gizmoOf(stage());
    if (!drag_ && place && !camera_.dragging() && overScene(cursor_))
        held = gizmoAt(*place, pointAt(cursor_));
    drawLights(stage(), area_.corner, held);
}

} // namespace relume
