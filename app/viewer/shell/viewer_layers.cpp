// This is the part of the viewer that looks at lights one by one, and at the sky's picture.
#include "app/viewer/shell/viewer.h"

#include "app/viewer/state/views.h"
#include "app/viewer/window/path_completion.h"

#include <filesystem>
#include <system_error>
#include <utility>

namespace relume {
namespace {

using Kind = LightKey::Kind;

constexpr double kRests = 0.25; // [s] without a move until previews follow the camera

} // namespace

// Returns the light that alone lights the scene that is shown, or nothing where all of them do.
std::optional<LightKey> Viewer::loneLight() const {
    return viewEntries()[view_.view].content == MapContent::Layer ? view_.light : std::nullopt;
}

void Viewer::toggleAlone() {
    if (loneLight()) {
        view_.view = viewIndex("lit");
        return changeScene();
    }
    if (!view_.light) return note("no light is selected: click one, or press L");
    if (!status_.layered)
        return note(status_.remark.empty() ? "this bake has no layer for each light" : status_.remark, true);
    view_.view = viewIndex("layer");
    note(viewTitle(view_, lights_, status_.groups));
    changeScene();
}

// Shows which lights shine: a muted one is dark, and so are all but a light that is looked at alone.
void Viewer::showShining() {
    const std::optional<LightKey> alone = loneLight();
    const Document& document = session_->document();
    const LightGroup* group = alone ? groupWith(status_.groups, *alone) : nullptr; // it is shown whole
    const auto shines = [&](const LightKey& key) {
        if (alone && group == nullptr) return key == *alone;
        return (group == nullptr || groupWith(status_.groups, key) == group) && document.mix.shines(key);
    };
    std::vector<Material> shown = document.edits.materials;
    std::vector<bool> bright(shown.size(), false), lights(shown.size(), false);
    for (const LightSource& source : lights_.sources()) {
        if (source.key.kind != Kind::Emitter) continue;
        lights[source.key.material] = true;
        if (shines(source.key)) bright[source.key.material] = true;
    }
    for (size_t i = 0; i < shown.size(); ++i)
        if (lights[i] && !bright[i]) shown[i].emission = glm::vec3(0.0f);
    showMaterials(std::move(shown));
    SkySettings sky = document.edits.sky;
    if (!shines({Kind::Sky, 0, 0})) sky.radiance = glm::vec3(0.0f);
    pane_.setSky(sky);
}

// Asks for previews and draws them. Nothing is done while nobody sees them.
void Viewer::followPreviews(double time) {
    const LoadedScene* scene = session_->scene();
    previewsDue_ = false;
    if (!previews_.wanted || scene == nullptr) {
        if (previewed_) bake_->askProbes({});
        previewed_.reset();
        return;
    }
    const Document& document = session_->document();
    Previewed now{camera_.camera(), scene->number, document.edits.placements, document.bake.size};
    if (time - moved_ > kRests && !drag_ && !pane_.surfacesPending() && previewed_ != now) {
        previewed_ = std::move(now);
        pane_.askSurfaces(camera_.camera());
    }
    if (std::optional<LightPreviews::Surfaces> surfaces = pane_.surfaces())
        bake_->askProbes(previews_.see(std::move(*surfaces), document.bake.size));
    if (std::optional<LayerProbe> probe = bake_->exchange().takeProbe()) previews_.take(std::move(*probe));
    std::vector<LightSource> sources = lights_.sources();
    for (const LightGroup& group : status_.groups)
        sources.push_back(group.source);
    previewsDue_ = previews_.update(document.edits, sources);
    if (!previewsDue_) return;
    tell("preview", "drawn");
    pacer_.statusChanged();
}

void Viewer::chooseSky() {
    const std::string path = scenePath();
    const std::string folder = path.empty() ? "" : std::filesystem::path(path).parent_path().string() + "/";
    ui_.files().open({.title = "Picture of the sky",
                      .path = folder,
                      .endings = {".exr", ".hdr"},
                      .recent = {},
                      .done = [this](const std::string& chosen) {
                          tell("sky", chosen);
                          skies_.read(expandHome(chosen), true);
                      }});
}

void Viewer::clearSky() {
    Document next = session_->document();
    SkySettings& sky = next.edits.sky;
    if (sky.file.empty()) return note("the sky has no picture");
    sky.file.clear();
    sky.rotation = 0.0f;
    if (sky.radiance != glm::vec3(0.0f)) sky = makeSky(sky, lightSpot()); // it was the picture's factor
    editOnce("Sky without a picture", next);
}

// Follows the sky's picture. One that an undo brings back is read again.
void Viewer::followSky() {
    if (const std::optional<SkyPictures::Result> result = skies_.poll()) takeSky(*result);
    const LoadedScene* scene = session_->scene();
    const std::string& wanted = session_->document().edits.sky.file;
    if (scene == nullptr || wanted.empty() || wanted == pane_.skyFile() || wanted == badSky_ ||
        !skies_.reading().empty())
        return;
    const Sky& own = scene->prepared.scene.sky;
    if (own.file == wanted && !own.pixels.empty())
        takeSky({.sky = own, .error = "", .chosen = false});
    else
        skies_.read(wanted, false);
}

void Viewer::takeSky(const SkyPictures::Result& result) {
    if (!result.error.empty()) {
        if (!result.chosen) badSky_ = result.sky.file;
        return note(result.error, true);
    }
    pane_.setSkyPicture(result.sky);
    changeScene();
    if (!result.chosen || session_->scene() == nullptr) return;
    Document next = session_->document();
    SkySettings& sky = next.edits.sky;
    // The radiance in cd/m^2 becomes a factor.
    if (sky.file.empty() || sky.radiance == glm::vec3(0.0f)) sky.radiance = glm::vec3(1.0f);
    sky.file = result.sky.file;
    editOnce("Picture of the sky", next);
    followLights();
    selectLight(LightKey{Kind::Sky, 0, 0});
}

} // namespace relume
