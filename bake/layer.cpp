#include "bake/layer.h"

namespace relume {

LightPattern patternOf(const Scene& scene, const LightKey& key) {
    LightPattern pattern{.kind = key.kind};
    switch (key.kind) {
    case LightKey::Kind::Emitter:
        pattern.instance = key.index;
        pattern.material = key.material;
        break;
    case LightKey::Kind::Lamp:
        pattern.light = scene.lights[key.index];
        pattern.light.name.clear();
        pattern.light.color = glm::vec3(1.0f);
        pattern.light.intensity = 1.0f;
        pattern.light.node = -1;
        break;
    case LightKey::Kind::Sky:
        pattern.rotation = scene.sky.rotation;
        pattern.file = scene.sky.file;
        break;
    }
    return pattern;
}

} // namespace relume
