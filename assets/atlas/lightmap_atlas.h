#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "assets/atlas/rect_memory.h"
#include "assets/model/lightmap_pages.h"
#include "assets/model/scene.h"

namespace relume {

/// Tells where one instance's lightmap UVs go: page uv = uv * scale + offset.
struct AtlasRect {
    glm::vec2 scale{1.0f};
    glm::vec2 offset{0.0f};
    int texCoord =
        -1; // the set taken, 0 or 1 (of every primitive that has it); -1: this instance has no usable UVs
    uint32_t page = 0; // of LightmapAtlas::pages
};

/// Holds one atlas for the whole scene, which may have several pages.
struct LightmapAtlas {
    std::vector<AtlasRect> instances; // one per Scene::instances
    bool repacked = false;            // every instance got a rectangle of its own
    std::vector<std::string> warnings;
    uint64_t visits = 0; // of grid cells, which is what finding overlaps has cost
    LightmapPages pages = {};

    /// Returns where an instance's UVs, of the set taken, lie on the sheet of all pages.
    glm::vec2 sheetUv(size_t instance, glm::vec2 uv) const {
        const AtlasRect& rect = instances[instance];
        return pages.onSheet(uv * rect.scale + rect.offset, rect.page);
    }
};

/// Chooses the lightmap UVs: TEXCOORD_1, else TEXCOORD_0 where it is a valid atlas (inside [0,1], overlap
/// below 1 % of the UV area). If all instances together form one valid atlas, it is used as it is; otherwise
/// each valid instance gets its own rectangle by world area with 2 texels of gutter at `size` [texels]. An
/// instance without usable UVs blocks light and is warned about. Throws Error where no instance has usable
/// UVs. Messages advise an unwrap, unless the scene is `unwrapped` already. There are as many pages as the
/// scene has, each of edge `size`, unless another number is asked for, for which all is packed anew: no
/// instance spans two, and the pages are filled alike. With a memory, rectangles of objects that are about as
/// large as before stay where they are, as placeAgain() says; then the memory is of this atlas.
LightmapAtlas buildAtlas(const Scene& scene, uint32_t size, bool unwrapped = false,
                         std::optional<LightmapPages> pages = {}, RectMemory* memory = nullptr);

/// Returns the atlas with the sheet of all its pages as its only page.
LightmapAtlas onOneSheet(LightmapAtlas atlas);

/// Returns the scene with the atlas in TEXCOORD_1, in 0 to 1 of each instance's page; instances that were
/// moved in it get a mesh of their own.
Scene withAtlas(const Scene& scene, const LightmapAtlas& atlas);

/// Tells how well a scene's lightmap UVs use the atlas.
struct AtlasStatistics {
    double coverage = 0; // covered share of all pages [1]
    double overlap = 0;  // share of the covered area covered more than once [1]
    double texelDensityMin = 0, texelDensityMean = 0,
           texelDensityMax = 0; // [texels/m] at `size`, the edge of a page, per triangle
    /// The L2 stretch of all triangles whose UVs have an area, weighted by area and normalised by the areas
    /// of both sides [Sander et al. 2001, eq. 3 and 4]; 1 is isometric, at one density.
    double stretch = 0;
};
AtlasStatistics measureAtlas(const Scene& scene, const LightmapAtlas& atlas, uint32_t size);

} // namespace relume
