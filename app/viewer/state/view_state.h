#pragma once

#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "app/live/live_bake.h"
#include "bake/lights/light_source.h"
#include "renderer/draw_settings.h"
#include "renderer/gizmo.h"
#include "renderer/uv_view.h"

namespace relume {

/// How the scene is looked at, which the View panel and its keys change.
struct ViewState {
    size_t view = 0; // of viewEntries()
    LightmapFilter filter = LightmapFilter::Bilinear;
    ToneMap tone = ToneMap::Agx;
    std::optional<float> exposure; // [EV], none: automatic
    uint32_t samples = 0;          // of each pixel
    int selected = -1;             // of Scene::instances
    std::optional<LightKey> light; // the one that is selected
    bool lightIcons = true;
    GizmoMode gizmo = GizmoMode::Translate; // of a selected analytic light or object
    std::optional<glm::vec3> ball;          // lit by the light of its place [m]; none: it is not there
    bool ballSelected = false;              // it has the gizmo, unless a light or an object is selected
    bool probes = false;                    // the grid of light probes is shown

    bool bare = false;   // panels, and what lies over the picture, are hidden
    bool wipe = false;   // the reference is shown left of the line
    float wipeAt = 0.5f; // the line, as a share of the picture's width

    bool uv = false; // the lightmap as a flat picture
    bool masked = true;
    UvWindow uvWindow;

    uint32_t mip = 0;
    PairSettings preview;              // of the quad-tree
    uint32_t voxels = 64;              // along each edge
    std::optional<float> high;         // end of a range of colours; none: the map's
    std::optional<uint32_t> seenTexel; // of visible-from-here
};

} // namespace relume
