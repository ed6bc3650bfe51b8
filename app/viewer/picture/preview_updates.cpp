#include "app/viewer/picture/preview_updates.h"

#include <utility>

namespace relume {

void PreviewUpdates::sceneCame() {
    previews_.clear();
    shown_.reset();
}

bool PreviewUpdates::follow(const std::vector<LightSource>& lights, const std::vector<LightGroup>& groups,
                            bool held, double time) {
    const LoadedScene* scene = session_.scene();
    due_ = false;
    if (!previews_.wanted || scene == nullptr) {
        if (shown_) bake_.askProbes({});
        shown_.reset();
        return false;
    }
    ScenePane& pane = picture_.pane();
    const Document& document = session_.document();
    const ViewCamera& camera = picture_.camera().camera();
    Shown now{camera, scene->number, document.edits.placements, mapSize(session_)};
    if (picture_.rests(time) && !held && !pane.surfacesPending() && shown_ != now) {
        shown_ = std::move(now);
        pane.askSurfaces(camera);
    }
    if (std::optional<LightPreviews::Surfaces> surfaces = pane.surfaces())
        bake_.askProbes(previews_.see(std::move(*surfaces), mapSize(session_)));
    if (std::optional<LayerProbe> probe = bake_.exchange().takeProbe()) previews_.take(std::move(*probe));
    std::vector<LightSource> sources = lights;
    for (const LightGroup& group : groups)
        sources.push_back(group.source);
    due_ = previews_.update(document.edits, sources);
    return due_;
}

bool PreviewUpdates::underWay() const {
    return due_ || picture_.pane().surfacesPending() || (previews_.wanted && bake_.exchange().hasProbe());
}

} // namespace relume
