#include "bake/lights/light_source.h"

#include <algorithm>
#include <set>

namespace relume {
namespace {

using Kind = LightKey::Kind;

// Returns the emitting materials of an instance's mesh, each once, in ascending order.
std::set<uint32_t> emittingMaterials(const Scene& scene, const Instance& instance) {
    std::set<uint32_t> found;
    if (instance.mesh < 0) return found;
    for (const Primitive& primitive : scene.meshes[static_cast<size_t>(instance.mesh)].primitives) {
        if (primitive.material < 0) continue;
        const auto material = static_cast<uint32_t>(primitive.material);
        // A pane has no triangles in a bake; one that is made to shine does so once its file is read again.
        if (scene.materials[material].emission != glm::vec3(0.0f) && !scene.materials[material].pane)
            found.insert(material);
    }
    return found;
}

std::string orElse(const std::string& name, const char* kind, size_t index) {
    return name.empty() ? std::string(kind) + " " + std::to_string(index) : name;
}

// Gives each light a name of its own: "Lamp", "Lamp 2", "Lamp 3".
void tellApart(std::vector<LightSource>& sources) {
    std::set<std::string> taken;
    for (LightSource& source : sources) {
        std::string name = source.name;
        for (uint32_t n = 2; !taken.insert(name).second; ++n)
            name = source.name + " " + std::to_string(n);
        source.name = name;
    }
}

bool holds(const std::vector<LightKey>& keys, const LightKey& key) {
    return std::find(keys.begin(), keys.end(), key) != keys.end();
}

} // namespace

std::vector<LightSource> lightSources(const Scene& scene) {
    std::vector<LightSource> sources;
    for (uint32_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        if (instance.hidden) continue;
        const std::set<uint32_t> materials = emittingMaterials(scene, instance);
        for (const uint32_t m : materials) {
            std::string name = orElse(instance.name, "instance", i);
            if (materials.size() > 1) name += " / " + orElse(scene.materials[m].name, "material", m);
            sources.push_back({{Kind::Emitter, i, m}, std::move(name), scene.materials[m].emission});
        }
    }
    for (uint32_t i = 0; i < scene.lights.size(); ++i) {
        const Light& light = scene.lights[i];
        sources.push_back(
            {{Kind::Lamp, i, 0}, orElse(light.name, "light", i), light.color * light.intensity});
    }
    if (scene.sky.shines()) sources.push_back({{Kind::Sky, 0, 0}, "Sky", scene.sky.radiance});
    tellApart(sources);
    return sources;
}

bool LightMix::shines(const LightKey& key) const {
    return !holds(muted, key) && (solo.empty() || holds(solo, key));
}

void LightMix::lampErased(uint32_t index) {
    for (std::vector<LightKey>* keys : {&muted, &solo}) {
        std::erase(*keys, LightKey{Kind::Lamp, index, 0});
        for (LightKey& key : *keys)
            key.index -= key.kind == Kind::Lamp && key.index > index;
    }
}

void LightMix::lampInserted(uint32_t index) {
    for (std::vector<LightKey>* keys : {&muted, &solo}) {
        for (LightKey& key : *keys)
            key.index += key.kind == Kind::Lamp && key.index >= index;
    }
}

} // namespace relume
