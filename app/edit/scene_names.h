#pragma once

#include <string>
#include <vector>

#include "assets/model/scene_edits.h"
#include "bake/lights/light_source.h"

namespace relume {

/// Something of a scene that edits name.
struct NamedThing {
    enum class Kind : uint8_t {
        Lamp,     // of SceneEdits::lights
        Emitter,  // an instance's material that emits
        Sky,      // always there, shining or not
        Object,   // of Scene::instances
        Material, // of SceneEdits::materials
    };
    Kind kind = Kind::Sky;
    uint32_t index = 0;    // into the list of its kind; Emitter: of instances
    uint32_t material = 0; // Emitter: into SceneEdits::materials
    std::string name;      // unlike that of any other light, object or material; "Lamp 2" for a second "Lamp"

    /// "light 'Lamp'", "object 'Chair'".
    std::string label() const;
};

/// All of them, lights as lightSources names them.
std::vector<NamedThing> namedThings(const Scene& scene, const SceneEdits& edits);

/// Kinds of things, for what an edit can be about.
struct ThingKinds {
    bool lamps = false, emitters = false, sky = false, objects = false, materials = false;
};

/// The one thing that users mean by `typed`: its name, or where a light, an object and a material share one
/// "light:NAME", "object:NAME" or "material:NAME". `kinds`: those that can be meant. Throws Error, naming
/// near ones where there is none and the ways to tell apart where there are several.
NamedThing findThing(const std::vector<NamedThing>& things, const std::string& typed,
                     const ThingKinds& kinds);

} // namespace relume
