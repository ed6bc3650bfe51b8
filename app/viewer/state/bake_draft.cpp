#include "app/viewer/state/bake_draft.h"

#include "app/live/bake_recipe.h"

namespace relume {

void BakeDraft::follow(const Document& document, uint64_t scene, bool held) {
    const bool another = scene != scene_;
    scene_ = scene;
    if (another) drop();
    if (!another && (held || waits())) return;
    bake = document.bake;
    lightmap = document.lightmap;
}

std::optional<Document> BakeDraft::settle(const Document& document) {
    problem_ = settingsProblem(bake);
    if (waits()) return std::nullopt;
    Document next = document;
    next.bake = bake;
    next.lightmap = lightmap;
    return next;
}

} // namespace relume
