#include "assets/generate/generate.h"

#include "assets/base/error.h"
#include "assets/generate/generate_scenes.h"
#include "assets/generate/town/town.h"

namespace relume {
namespace {

struct Entry {
    SceneName name;
    Scene (*make)();
};

const std::vector<Entry>& entries() {
    static const std::vector<Entry> all = {
        {{"cornell_small", "a Cornell box with a small light in the ceiling and two boxes"},
         generate::cornellSmall},
        {{"cornell_geom", "simple shapes in a Cornell box under a narrow light"}, generate::cornellGeom},
        {{"cornell_layers", "a box cut into layers by a wedge and a shelf, with a closed dark cell"},
         generate::cornellLayers},
        {{"cornell_statue", "a winged figure, finely folded, under a large light"}, generate::cornellStatue},
        {{"gallery", "rooms with pictures and plinths under many small coloured lights"}, generate::gallery},
        {{"octagon", "a textured octagonal room with coloured lights"}, generate::octagon},
        {{"atrium", "a two-storey court of columns and arches under a skylight"}, generate::atrium},
        {{"lamps", "a room with one light of each kind, a window, sun and sky"}, generate::lamps},
        {{"town", "a street with arcades, alleys, a court and three rooms, in sun, sky and twenty lamps",
          false},
         generate::town},
        {{"raw", "a corner of the town as levels come: no lightmap UVs, no lights, doubled faces", false},
         generate::rawCorner},
    };
    return all;
}

} // namespace

std::vector<SceneName> generatedSceneNames() {
    std::vector<SceneName> names;
    for (const Entry& entry : entries())
        names.push_back(entry.name);
    return names;
}

Scene generateScene(const std::string& name) {
    std::string known;
    for (const Entry& entry : entries()) {
        if (entry.name.name == name) return entry.make();
        known += (known.empty() ? "" : ", ") + entry.name.name;
    }
    throw Error("there is no scene '" + name + "': choose one of " + known);
}

} // namespace relume
