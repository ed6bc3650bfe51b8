#pragma once

#include <vector>

#include "app/live/lightmap_exchange.h"
#include "renderer/draw_settings.h"

namespace relume {

/// One way to look at a scene.
struct ViewEntry {
    const char* name;  // "lit", as in captions and actions
    const char* title; // "Lit"
    const char* tells; // one line
    View view = View::Lit;
    bool readsMap = false;                  // what is drawn comes from a published map ...
    MapContent content = MapContent::Light; // ... with this content
    bool voxels = false;                    // drawn instead of the scene
    int key = 0, mods = 0;
};

const std::vector<ViewEntry>& viewEntries();
/// Finds a view by its name; an unknown name gives the first one.
size_t viewIndex(const char* name);
/// Tells whether a mip can be chosen.
bool hasMips(MapContent content);

} // namespace relume
