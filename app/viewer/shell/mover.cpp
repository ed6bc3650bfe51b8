#include "app/viewer/shell/mover.h"

#include "app/viewer/edits/nudge.h"
#include "app/viewer/edits/object_edits.h"
#include "app/viewer/picture/probe_balls.h"

#include <array>
#include <limits>
#include <utility>

#include <glm/gtc/matrix_transform.hpp>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace relume {
namespace {

constexpr float kGap = 1e-3f; // of the scene's diagonal, between a surface and a light on it

} // namespace

Mover::Mover(const Session& session, SceneView& picture, const ShownLights& lights, Editing& editing,
             Feedback& feedback)
    : session_(session), picture_(picture), lights_(lights), editing_(editing), feedback_(feedback) {}

LightStage Mover::stage() const {
    const Document& document = session_.document();
    const float scale = picture_.scale();
    LightStage stage{
        .edits = document.edits,
        .mix = document.mix,
        .view = picture_.state(),
        .screen = {picture_.camera().camera(), glm::max(picture_.area().size / scale, glm::vec2(1.0f))},
        .object = {},
        .scale = scale};
    if (const std::optional<uint32_t> selected = object())
        stage.object = pivotOf(*session_.scene(), document.edits, *selected);
    if (holdsBall()) {
        stage.object = *picture_.state().ball;
        stage.mode = GizmoMode::Translate; // a ball looks the same from all sides
    }
    return stage;
}

// Tells whether the ball has the gizmo: whatever else was selected after it takes it away.
bool Mover::holdsBall() const {
    const ViewState& view = picture_.state();
    return view.ball && view.ballSelected && !view.light && view.selected < 0;
}

void Mover::selectBall() {
    ViewState& view = picture_.state();
    view.ballSelected = true;
    view.selected = -1;
    view.light.reset();
    feedback_.sceneChanged();
}

void Mover::toggleBall() {
    if (session_.scene() == nullptr) return feedback_.note("there is no scene to put a ball into", true);
    ViewState& view = picture_.state();
    view.ballSelected = false;
    if (view.ball) {
        view.ball.reset();
        return feedback_.sceneChanged();
    }
    view.ball = picture_.pane().bounds().centre();
    selectBall();
}

bool Mover::selectBallAt(const glm::dvec2& at, const std::optional<Pick>& behind) {
    const ViewState& view = picture_.state();
    if (!view.ball || !picture_.showsLights()) return false;
    const ScreenView screen = stage().screen;
    const ScreenRay ray = rayThrough(screen, picture_.pointAt(at));
    const std::optional<float> distance = meetsBall(ray, *view.ball, ballRadius(picture_.pane().bounds()));
    if (!distance || (behind && glm::distance(behind->position, ray.origin) < *distance)) return false;
    selectBall();
    feedback_.tell("action", "select ball");
    return true;
}

// Returns the selected instance, where it can be seen and no analytic light is selected.
std::optional<uint32_t> Mover::object() const {
    const ViewState& view = picture_.state();
    const std::vector<Placement>& placements = session_.document().edits.placements;
    if (view.selected < 0 || static_cast<size_t>(view.selected) >= placements.size()) return std::nullopt;
    const auto selected = static_cast<uint32_t>(view.selected);
    const bool lamp = view.light && view.light->kind == LightKey::Kind::Lamp;
    return lamp || placements[selected].hidden ? std::nullopt : std::optional(selected);
}

// Returns what the gizmo and the keys move in a document, or nullptr where there is nothing.
glm::mat4* Mover::target(Document& document) const {
    const std::optional<LightKey>& key = picture_.state().light;
    if (key && key->kind == LightKey::Kind::Lamp && key->index < document.edits.lights.size())
        return &document.edits.lights[key->index].transform;
    const std::optional<uint32_t> selected = object();
    return selected ? &document.edits.placements[*selected].transform : nullptr;
}

std::string Mover::name() const {
    if (const std::optional<uint32_t> selected = object())
        return objectName(session_.scene()->prepared.scene, *selected);
    const LightSource* source = lights_.selected();
    return source != nullptr ? source->name : "";
}

void Mover::perform(Action action, int argument) {
    if (action == Action::Nudge) return nudge(argument);
    if (session_.scene() == nullptr) return feedback_.note("there is no scene to edit", true);
    if (action == Action::ShowObjects)
        showAll();
    else
        toggleHidden();
}

void Mover::nudge(int direction) {
    Document next = session_.document();
    glm::mat4* transform = target(next);
    if (transform == nullptr)
        return feedback_.note("nothing is selected that can be moved: click an object, or a light's icon");
    const GizmoMode mode = picture_.state().gizmo;
    *transform = nudged(*transform, {.mode = mode,
                                     .direction = direction,
                                     .diagonal = session_.scene()->geometry.bounds.diagonal(),
                                     .pivot = gizmoOf(stage()).value_or(GizmoPlace{}).origin,
                                     .camera = picture_.camera().camera()});
    editing_.editOnce((mode == GizmoMode::Translate ? "Position of " : "Rotation of ") + name(), next);
}

void Mover::showAll() {
    Document next = session_.document();
    for (Placement& placement : next.edits.placements)
        placement.hidden = false;
    if (next.edits.placements == session_.document().edits.placements)
        return feedback_.note("no object is hidden");
    editing_.editOnce("Show all objects", next);
}

void Mover::toggleHidden() {
    if (picture_.state().selected < 0) return feedback_.note("no object is selected: click one");
    const auto selected = static_cast<uint32_t>(picture_.state().selected);
    Document next = session_.document();
    bool& hidden = next.edits.placements[selected].hidden;
    hidden = !hidden;
    editing_.editOnce((hidden ? "Hide " : "Show ") + objectName(session_.scene()->prepared.scene, selected),
                      next);
}

bool Mover::press(const glm::dvec2& at) {
    if (!picture_.showsLights()) return false;
    const std::optional<GizmoPlace> place = gizmoOf(stage());
    const glm::vec2 point = picture_.pointAt(at);
    const GizmoHandle handle = place ? gizmoAt(*place, point) : GizmoHandle::None;
    if (handle == GizmoHandle::None) return false;
    editing_.end(); // of whatever came before: this is a step of its own
    Document now = session_.document();
    drag_.emplace(*place, handle,
                  holdsBall() ? glm::translate(glm::mat4(1.0f), *picture_.state().ball) : *target(now),
                  point);
    return true;
}

// Returns the transform that puts what is dragged on the surface under the cursor, or nothing where there is
// none.
std::optional<glm::mat4> Mover::onSurface(const glm::dvec2& at) const {
    const std::optional<uint32_t> selected = object();
    const std::optional<Pick> pick = picture_.pick(at, selected);
    if (!pick) return std::nullopt;
    const LoadedScene& scene = *session_.scene();
    const glm::vec3 normal = placedNormalAt(scene, session_.document().edits, pick->instance, pick->position,
                                            towardsEye(picture_.camera().camera(), pick->position));
    if (selected)
        return restingOn({.scene = scene, .instance = *selected, .begin = drag_->begin()}, pick->position,
                         normal);
    Light begun = *selectedLamp(stage());
    begun.transform = drag_->begin();
    return placedOn(begun, pick->position, normal, kGap * scene.geometry.bounds.diagonal());
}

// The ball is no part of the scene: where it goes is no edit.
void Mover::dragBall(const glm::dvec2& at, bool control) {
    glm::vec3 wanted(drag_->moved(picture_.pointAt(at), false)[3]);
    if (control) {
        const std::optional<Pick> pick = picture_.pick(at);
        if (!pick) return;
        const glm::vec3 normal =
            placedNormalAt(*session_.scene(), session_.document().edits, pick->instance, pick->position,
                           towardsEye(picture_.camera().camera(), pick->position));
        wanted = pick->position + ballRadius(picture_.pane().bounds()) * normal;
    }
    if (wanted == *picture_.state().ball) return;
    picture_.state().ball = wanted;
    feedback_.sceneChanged();
}

void Mover::drag(const glm::dvec2& at, bool control) {
    if (holdsBall()) return dragBall(at, control);
    Document next = session_.document();
    glm::mat4* transform = target(next);
    const std::string moved = name();
    if (transform == nullptr || moved.empty()) return release(); // undone meanwhile
    const bool moves = drag_->mode() == GizmoMode::Translate;
    const std::optional<glm::mat4> wanted =
        control && moves ? onSurface(at) : drag_->moved(picture_.pointAt(at), control);
    if (!wanted || *wanted == *transform) return;
    *transform = *wanted;
    editing_.edit((moves ? "Move " : "Turn ") + moved, next);
}

void Mover::release() {
    if (holdsBall()) feedback_.tell("action", "move ball");
    drag_.reset();
    editing_.end();
}

void Mover::takeKey(const WindowEvent& key, const glm::dvec2& at, bool control) {
    if (key.code == GLFW_KEY_LEFT_CONTROL || key.code == GLFW_KEY_RIGHT_CONTROL) return drag(at, control);
    if (!key.pressed) return;
    switch (key.code) {
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
        editing_.cancel();
        if (holdsBall()) picture_.state().ball = glm::vec3(drag_->begin()[3]);
        feedback_.tell("action", "drag cancelled");
        return release();
    default:
        return;
    }
    drag(at, control);
}

std::optional<LightKey> Mover::iconAt(const glm::dvec2& at) const {
    return picture_.showsLights() ? relume::iconAt(stage(), picture_.pointAt(at)) : std::nullopt;
}

// Tells where one can click icons and take hold of the gizmo.
void Mover::tellPlaces(ui::ItemLog& items) const {
    constexpr std::array<const char*, 8> kHandles = {"", "X", "Y", "Z", "YZ", "ZX", "XY", "Screen"};
    const LightStage now = stage();
    const auto add = [&](const char* label, const glm::vec2& point) {
        items.add(label, glm::ivec2(glm::round(picture_.area().corner + picture_.scale() * point)));
    };
    {
        const ui::ItemLog::Scope scope(items, "Icons");
        for (const LightSource& source : lights_.list().sources()) {
            if (source.key.kind != LightKey::Kind::Lamp) continue;
            const Light& light = now.edits.lights[source.key.index];
            const auto place = project(now.screen, glm::vec3(light.transform[3]));
            if (place) add(source.name.c_str(), *place);
        }
    }
    const ui::ItemLog::Scope scope(items, "Gizmo");
    const std::optional<GizmoPlace> place = gizmoOf(now);
    GizmoHandle before = GizmoHandle::None;
    for (const GizmoShape& shape : place ? gizmoShapes(*place) : std::vector<GizmoShape>())
        if (shape.handle != std::exchange(before, shape.handle))
            add(kHandles[static_cast<size_t>(shape.handle)], gripOf(shape));
}

void Mover::draw(const std::optional<glm::dvec2>& cursor, ui::ItemLog& items) const {
    if (!picture_.showsLights()) return;
    if (feedback_.logs()) tellPlaces(items);
    const LightStage now = stage();
    GizmoHandle lit = drag_ ? drag_->handle() : GizmoHandle::None;
    const std::optional<GizmoPlace> place = gizmoOf(now);
    if (!drag_ && place && cursor) lit = gizmoAt(*place, picture_.pointAt(*cursor));
    drawLights(now, picture_.area().corner, lit);
}

} // namespace relume
