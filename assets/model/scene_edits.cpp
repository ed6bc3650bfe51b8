#include "assets/model/scene_edits.h"

#include "assets/base/error.h"

namespace relume {

SceneEdits editsOf(const Scene& scene) {
    SceneEdits edits{.materials = scene.materials,
                     .lights = scene.lights,
                     .sky = scene.sky,
                     .placements = {},
                     .densities = {}};
    edits.placements.reserve(scene.instances.size());
    for (const Instance& instance : scene.instances)
        edits.placements.push_back({instance.transform, instance.hidden});
    for (const Instance& instance : scene.instances)
        edits.densities.push_back(instance.density);
    return edits;
}

void applyEdits(Scene& scene, const SceneEdits& edits) {
    ASSERT(edits.placements.size() == scene.instances.size());
    ASSERT(edits.densities.size() == scene.instances.size());
    scene.materials = edits.materials;
    scene.lights = edits.lights;
    if (edits.sky.file != scene.sky.file) {
        scene.sky.width = scene.sky.height = 0;
        scene.sky.pixels.clear();
    }
    static_cast<SkySettings&>(scene.sky) = edits.sky;
    for (size_t i = 0; i < edits.placements.size(); ++i) {
        scene.instances[i].transform = edits.placements[i].transform;
        scene.instances[i].hidden = edits.placements[i].hidden;
        scene.instances[i].density = edits.densities[i];
    }
}

} // namespace relume
