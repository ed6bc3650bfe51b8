#include "app/viewer/shell/sky_keys.h"

#include "app/viewer/edits/light_actions.h"
#include "app/viewer/window/path_completion.h"
#include "assets/base/error.h"

namespace relume {

SkyKeys::SkyKeys(const Session& session, SceneView& picture, ShownLights& lights, Editing& editing,
                 Feedback& feedback)
    : session_(session), picture_(picture), lights_(lights), editing_(editing), feedback_(feedback) {}

void SkyKeys::choose(FileDialog& dialog, const std::string& begin) {
    if (session_.scene() == nullptr) return feedback_.note("there is no scene to light", true);
    dialog.open({.title = "Picture of the sky",
                 .path = begin,
                 .endings = {".exr", ".hdr"},
                 .recent = {},
                 .done = [this](const std::string& chosen) {
                     feedback_.tell("sky", chosen);
                     pictures_.read(expandHome(chosen), true);
                 }});
}

void SkyKeys::clear() {
    if (session_.scene() == nullptr) return feedback_.note("there is no scene to light", true);
    const std::optional<LightChange> change = skyWithoutPicture(session_.document(), picture_.lightSpot());
    if (!change) return feedback_.note("the sky has no picture");
    editing_.editOnce(change->name, change->next);
}

void SkyKeys::sceneCame(bool kept) {
    bad_.clear();
    if (!kept) pictures_.forget();
}

void SkyKeys::follow() {
    if (const std::optional<SkyPictures::Result> result = pictures_.poll()) take(*result);
    const LoadedScene* scene = session_.scene();
    const std::string& wanted = session_.document().edits.sky.file;
    if (scene == nullptr || !picture_.pane().hasScene() || wanted.empty() ||
        wanted == picture_.pane().skyFile() || wanted == bad_ || reading())
        return;
    const Sky& own = scene->prepared.scene.sky;
    if (own.file == wanted && !own.pixels.empty())
        take({.sky = own, .error = "", .chosen = false});
    else
        pictures_.read(wanted, false);
}

void SkyKeys::take(const SkyPictures::Result& result) {
    if (!result.error.empty()) {
        if (!result.chosen) bad_ = result.sky.file;
        return feedback_.note(result.error, true);
    }
    try {
        picture_.pane().setSkyPicture(result.sky);
    } catch (const Error& error) { // OpenGL has no room for it, and the picture before is read again
        if (!result.chosen) bad_ = result.sky.file;
        return feedback_.note(result.sky.file + ": " + error.what(), true);
    }
    feedback_.sceneChanged();
    if (!result.chosen || session_.scene() == nullptr) return;
    const LightChange change = skyWithPicture(session_.document(), result.sky.file);
    editing_.editOnce(change.name, change.next);
    lights_.follow();
    lights_.select(*change.selected);
}

} // namespace relume
