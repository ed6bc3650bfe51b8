#include "app/edit/scene_names.h"

#include "app/text/near_names.h"
#include "assets/base/error.h"
#include "assets/base/warnings.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <set>

namespace relume {
namespace {

using ThingKind = NamedThing::Kind;

// Returns what lightSources looks at, edited. It has no geometry, so that it is quickly made, and its sky
// shines, to have a name.
Scene skeletonOf(const Scene& scene, const SceneEdits& edits) {
    Scene skeleton;
    skeleton.materials = scene.materials;
    skeleton.instances = scene.instances;
    for (const Mesh& mesh : scene.meshes) {
        Mesh& bare = skeleton.meshes.emplace_back();
        for (const Primitive& primitive : mesh.primitives)
            bare.primitives.emplace_back().material = primitive.material;
    }
    applyEdits(skeleton, edits);
    skeleton.sky.radiance = glm::vec3(1.0f);
    return skeleton;
}

// Returns "light", "object" or "material", with which a name can begin.
const char* wordOf(ThingKind kind) {
    if (kind == ThingKind::Object) return "object";
    return kind == ThingKind::Material ? "material" : "light";
}

bool among(const ThingKinds& kinds, ThingKind kind) {
    const bool chosen[] = {kinds.lamps, kinds.emitters, kinds.sky, kinds.objects, kinds.materials};
    return chosen[static_cast<size_t>(kind)];
}

class UniqueNames {
public:
    std::string take(const std::string& name, const char* kind, size_t index) {
        const std::string own = name.empty() ? fmt::format("{} {}", kind, index) : name;
        std::string unique = own;
        for (uint32_t n = 2; !taken_.insert(unique).second; ++n)
            unique = fmt::format("{} {}", own, n);
        return unique;
    }

private:
    std::set<std::string> taken_;
};

// Tells whether both have the same emission: a mesh light has its material's, so whichever is meant, it is
// the same edit.
bool sameEmission(const NamedThing& a, const NamedThing& b) {
    return a.kind == ThingKind::Emitter && b.kind == ThingKind::Material && a.material == b.index;
}

std::string listedKinds(const ThingKinds& kinds) {
    std::string text;
    const auto add = [&](bool wanted, const char* word) {
        if (wanted) text += std::string(text.empty() ? "" : " or ") + word;
    };
    add(kinds.lamps || kinds.emitters || kinds.sky, "light");
    add(kinds.objects, "object");
    add(kinds.materials, "material");
    return text;
}

} // namespace

std::string NamedThing::label() const {
    return fmt::format("{} {}", wordOf(kind), inQuotes(name));
}

std::vector<NamedThing> namedThings(const Scene& scene, const SceneEdits& edits) {
    std::vector<NamedThing> things;
    for (const LightSource& source : lightSources(skeletonOf(scene, edits))) {
        const ThingKind kind = source.key.kind == LightKey::Kind::Lamp      ? ThingKind::Lamp
                               : source.key.kind == LightKey::Kind::Emitter ? ThingKind::Emitter
                                                                            : ThingKind::Sky;
        things.push_back({kind, source.key.index, source.key.material, source.name});
    }
    UniqueNames objects, materials;
    for (uint32_t i = 0; i < scene.instances.size(); ++i)
        things.push_back({ThingKind::Object, i, 0, objects.take(scene.instances[i].name, "instance", i)});
    for (uint32_t i = 0; i < edits.materials.size(); ++i)
        things.push_back({ThingKind::Material, i, 0, materials.take(edits.materials[i].name, "material", i)});
    return things;
}

NamedThing findThing(const std::vector<NamedThing>& things, const std::string& typed,
                     const ThingKinds& kinds) {
    std::vector<const NamedThing*> found;
    std::vector<std::string> names;
    for (const NamedThing& thing : things) {
        if (!among(kinds, thing.kind)) continue;
        if (std::find(names.begin(), names.end(), thing.name) == names.end()) names.push_back(thing.name);
        if (thing.name == typed || std::string(wordOf(thing.kind)) + ":" + thing.name == typed)
            found.push_back(&thing);
    }
    if (found.empty())
        throw Error(fmt::format("no {} is called {}: {}", listedKinds(kinds), inQuotes(typed),
                                nearNamesHint(typed, names)));
    if (found.size() > 1 && !(found.size() == 2 && sameEmission(*found[0], *found[1]))) {
        std::string ways;
        for (const NamedThing* thing : found)
            ways += fmt::format("{}'{}:{}'", ways.empty() ? "" : " or ", wordOf(thing->kind), thing->name);
        throw Error(fmt::format("{} things are called {}: say {}", found.size(), inQuotes(typed), ways));
    }
    return *found.front();
}

} // namespace relume
