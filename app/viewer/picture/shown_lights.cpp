#include "app/viewer/picture/shown_lights.h"

#include "app/viewer/edits/light_actions.h"
#include "app/viewer/state/views.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

bool sameFactors(const std::vector<Material>& a, const std::vector<Material>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Material& x, const Material& y) {
        return x.baseColor == y.baseColor && x.emission == y.emission;
    });
}

bool showsLayer(const ViewState& view) {
    return viewEntries()[view.view].content == MapContent::Layer;
}

} // namespace

std::string viewTitle(const ViewState& view, const LightList& lights, const std::vector<LightGroup>& groups) {
    const LightSource* source = view.light ? lights.find(*view.light) : nullptr;
    if (!showsLayer(view) || source == nullptr) return viewEntries()[view.view].title;
    const LightGroup* group = groupWith(groups, source->key);
    return group != nullptr ? "Lights: " + group->source.name : "Light: " + source->name;
}

ShownLights::ShownLights(const Session& session, const BakeStatus& status, SceneView& picture,
                         Feedback& feedback)
    : session_(session), status_(status), picture_(picture), feedback_(feedback) {}

const LightSource* ShownLights::selected() const {
    const std::optional<LightKey>& key = picture_.state().light;
    return key ? list_.find(*key) : nullptr;
}

void ShownLights::select(const LightKey& key) {
    ViewState& view = picture_.state();
    view.light = key;
    view.selected = key.kind == LightKey::Kind::Emitter ? static_cast<int>(key.index) : -1;
    const LightSource* source = list_.find(key);
    feedback_.tell("action", "select light " + (source != nullptr ? source->name : std::string("none")));
    feedback_.sceneChanged();
}

void ShownLights::step(int step) {
    const std::optional<LightKey> key = lightBeside(list_.sources(), picture_.state().light, step);
    if (!key) return feedback_.note("there are no lights");
    select(*key);
}

void ShownLights::selectObject(const std::optional<Pick>& pick) {
    ViewState& view = picture_.state();
    const int instance = pick ? static_cast<int>(pick->instance) : -1;
    view.selected = instance == view.selected ? -1 : instance;
    feedback_.tell("action", "select " + std::to_string(view.selected));
    feedback_.sceneChanged();
    selectNone();
    if (view.selected < 0) return;
    const LightKey emitter{LightKey::Kind::Emitter, pick->instance, pick->material};
    if (list_.find(emitter) != nullptr) select(emitter);
}

std::optional<LightKey> ShownLights::alone() const {
    return showsLayer(picture_.state()) ? picture_.state().light : std::nullopt;
}

void ShownLights::toggleAlone() {
    ViewState& view = picture_.state();
    if (alone()) {
        view.view = viewIndex("lit");
        return feedback_.sceneChanged();
    }
    if (!view.light) return feedback_.note("no light is selected: click one, or press L");
    if (!status_.layered) {
        const std::string& why = status_.remark;
        return feedback_.note(why.empty() ? "this bake has no layer for each light" : why, true);
    }
    view.view = viewIndex("layer");
    feedback_.note(viewTitle(view, list_, status_.groups));
    feedback_.sceneChanged();
}

void ShownLights::sceneCame() {
    materials_ = session_.scene()->prepared.scene.materials;
    selectNone();
}

void ShownLights::follow() {
    const bool changed = list_.update(session_.scene(), session_);
    ViewState& view = picture_.state();
    if (selected() == nullptr) selectNone();
    if (showsLayer(view) && !view.light) {
        view.view = viewIndex("lit");
        feedback_.sceneChanged();
    }
    if (!changed && alone() == shownAlone_) return;
    shownAlone_ = alone();
    if (session_.scene() == nullptr) return;
    showShining();
    picture_.pane().setPlacements(session_.document().edits.placements);
    feedback_.sceneChanged();
    feedback_.pacer().input();
}

void ShownLights::showShining() {
    ShiningScene shining = shiningScene(session_.document(), list_.sources(), alone(), status_.groups);
    if (!sameFactors(materials_, shining.materials)) {
        materials_ = std::move(shining.materials);
        picture_.pane().setMaterials(materials_);
    }
    picture_.pane().setSky(shining.sky);
}

} // namespace relume
