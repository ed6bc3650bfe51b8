#pragma once

#include <string>
#include <vector>

#include "assets/model/scene_edits.h"
#include "bake/lights/light_source.h"

namespace relume {

/// A thing in a scene that edits refer to by name.
struct NamedThing {
    enum class Kind : uint8_t {
        Lamp,     // of SceneEdits::lights
        Emitter,  // a mesh light: an instance and a material that emits
        Sky,      // always there, shining or not
        Object,   // of Scene::instances
        Material, // of SceneEdits::materials
    };
    Kind kind = Kind::Sky;
    uint32_t index = 0;    // into the list of its kind; Emitter: of instances
    uint32_t material = 0; // Emitter: into SceneEdits::materials
    std::string name;      // unique among lights, objects or materials; "Lamp 2" for a second "Lamp"

    /// Returns "light 'Lamp'", "object 'Chair'".
    std::string label() const;
};

/// Returns all of them; lights have the names that lightSources gives them.
std::vector<NamedThing> namedThings(const Scene& scene, const SceneEdits& edits);

/// The kinds of things that an edit can be about.
struct ThingKinds {
    bool lamps = false, emitters = false, sky = false, objects = false, materials = false;
};

/// Returns the one thing among `kinds` that users mean by `typed`: its name, or where a light, an object and
/// a material share one, "light:NAME", "object:NAME" or "material:NAME". Throws Error, which names similar
/// ones where there is none, and the ways to tell them apart where there are several.
NamedThing findThing(const std::vector<NamedThing>& things, const std::string& typed,
                     const ThingKinds& kinds);

} // namespace relume
