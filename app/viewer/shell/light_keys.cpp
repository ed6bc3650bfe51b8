#include "app/viewer/shell/light_keys.h"

namespace relume {

LightKeys::LightKeys(const Session& session, SceneView& picture, ShownLights& lights, Editing& editing,
                     Feedback& feedback)
    : session_(session), picture_(picture), lights_(lights), editing_(editing), feedback_(feedback) {}

void LightKeys::add(int what) {
    const std::optional<LightChange> change = addedLight(session_.document(), what, picture_.lightSpot());
    if (change)
        editing_.editOnce(change->name, change->next);
    else
        feedback_.note("the scene has a sky");
    lights_.follow();
    lights_.select(change ? *change->selected : LightKey{LightKey::Kind::Sky, 0, 0});
}

void LightKeys::perform(Action action, int argument) {
    if (session_.scene() == nullptr) return feedback_.note("there is no scene to light", true);
    if (action == Action::AddLight) return add(argument);
    if (action == Action::NextLight) return lights_.step(argument);
    const LightSource* source = lights_.selected();
    if (source == nullptr) return feedback_.note("no light is selected: click one, or press L");
    const LightKey before = source->key;
    const auto changed = changedLight(session_.document(), *source, action, argument);
    if (const std::string* why = std::get_if<std::string>(&changed)) return feedback_.note(*why);
    const LightChange& change = std::get<LightChange>(changed);
    editing_.editOnce(change.name, change.next);
    if (!change.selected) return lights_.selectNone();
    if (*change.selected == before) return;
    lights_.follow();
    lights_.select(*change.selected);
}

} // namespace relume
