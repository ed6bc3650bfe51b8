#include "app/viewer/shell/viewer.h"

#include "app/viewer/state/views.h"

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

constexpr float kStrengthKeyStep = 1.18920712f; // of a key press, 2^(1/4)

} // namespace

void Viewer::selectLight(const std::optional<LightKey>& key) {
    view_.light = key;
    view_.selected = key && key->kind == Kind::Emitter ? static_cast<int>(key->index) : -1;
    const LightSource* source = key ? lights_.find(*key) : nullptr;
    tell("action", "select light " + (source != nullptr ? source->name : std::string("none")));
    changeScene();
}

// Follows the lights. One that is gone cannot stay selected.
void Viewer::followLights() {
    const bool changed = lights_.update(session_->scene(), *session_);
    if (view_.light && lights_.find(*view_.light) == nullptr) view_.light.reset();
    if (viewEntries()[view_.view].content == MapContent::Layer && !view_.light) {
        view_.view = viewIndex("lit");
        changeScene();
    }
    const std::optional<LightKey> alone = loneLight();
    if (!changed && alone == shownAlone_) return;
    shownAlone_ = alone;
    if (session_->scene() == nullptr) return;
    showShining();
    pane_.setPlacements(session_->document().edits.placements);
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

// Selects the light that is `step` further on the board.
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
    if (action == Action::SkyPicture) return chooseSky();
    if (action == Action::NoSkyPicture) return clearSky();
    const LightSource* found = view_.light ? lights_.find(*view_.light) : nullptr;
    if (found == nullptr) return note("no light is selected: click one, or press L");
    const LightSource source = *found;
    const LightKey& key = source.key;
    Document next = session_->document();
    const bool power =
        action == Action::SoloLight || action == Action::MuteLight || action == Action::LightStrength;
    if (!power && key.kind != Kind::Lamp)
        return note(source.name + ": only lights without geometry can be copied and deleted");
    switch (action) {
    case Action::SoloLight:
        toggle(next.mix.solo, key);
        return editOnce("Solo of " + source.name, next);
    case Action::MuteLight:
        toggle(next.mix.muted, key);
        return editOnce("Mute of " + source.name, next);
    case Action::LightStrength: {
        LightPower changed = powerOf(next.edits, key);
        changed.intensity *= argument > 0 ? kStrengthKeyStep : 1.0f / kStrengthKeyStep;
        setPower(next.edits, key, changed);
        return editOnce("Intensity of " + source.name, next);
    }
    case Action::DuplicateLight: {
        const LightKey copy = duplicateLamp(next, key.index);
        editOnce("Duplicate " + source.name, next);
        followLights();
        return selectLight(copy);
    }
    default: // DeleteLight
        eraseLamp(next, key.index);
        editOnce("Delete " + source.name, next);
        view_.light.reset();
    }
}

} // namespace relume
