#include "bake/layer.h"

#include "bake/shader_types.h"

#include <algorithm>

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

double Layer::directShare() const {
    if (penumbra.empty()) return 1.0;
    const auto within = static_cast<double>(std::count(penumbra.begin(), penumbra.end(), 1));
    const double share = within / static_cast<double>(penumbra.size());
    return share + (1.0 - share) / shader::kPenumbraRounds;
}

std::string staleReason(const Layer& layer) {
    if (layer.has() || layer.source.weight == glm::vec3(0.0f)) return "";
    const std::string light = "light '" + layer.source.name + "' ";
    const Layer* shown = layer.shown();
    if (!shown) return light + "is not baked yet";
    const LightPattern &now = layer.pattern, &then = shown->pattern;
    if (now.light.transform != then.light.transform) return light + "moved";
    if (now.rotation != then.rotation) return light + "turned";
    LightPattern recoloured = then;
    recoloured.surfaces = now.surfaces;
    if (recoloured == now) return light + "meets surfaces of other colours";
    recoloured.objects = now.objects;
    return light + (recoloured == now ? "shines on objects that moved" : "has another form");
}

} // namespace relume
