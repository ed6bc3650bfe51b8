#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "assets/atlas/lightmap_atlas.h"
#include "assets/atlas/unwrap_memory.h"
#include "assets/atlas/world_mesh.h"
#include "assets/base/phase_clock.h"
#include "assets/gltf/gltf.h"
#include "assets/images/float_image.h"

namespace relume {

/// Says what a level gets that its file lacks.
struct Furnishing {
    bool unwrap = true;   // lightmap UVs for the meshes that have no usable ones
    double density = 0;   // of these [texels/m], 0: fitted to the size
    bool daylight = true; // light where nothing shines: a sun and a sky, or a lamp in a closed interior
    bool strict = false;  // nothing: what is missing is an Error
};

/// A scene that was read, given an atlas and flattened, from which a bake starts.
struct PreparedScene {
    Scene scene;
    LightmapAtlas atlas;
    WorldMesh mesh;
    uint32_t size = 0;             // edge of a lightmap's page that the atlas is made for [texels]
    std::string madeUvs;           // says which lightmap UVs were made, "" for none
    std::string madeLight;         // says what preview light was added, "" for none
    std::vector<PhaseTime> phases; // load, unwrap, atlas
};

struct PrepareDesc {
    std::string path;
    GltfChoice choice = {};
    uint32_t size = 512;                // edge of a lightmap's page [texels]
    std::optional<uint32_t> pages = {}; // of the lightmap; 0: as many as furnishing.density needs; nothing:
                                        // as many as the file has
    // [texels/m]: the edge is the least power of two from `size` on that gives it, as far as `fitting` goes,
    // and up to 4096 where pages are 0; 0: the edge is `size`.
    double leastDensity = 0;
    uint32_t stride = 0; // of edges that are no powers of two and do as well [texels], 0: none do
    // Returns how much of an edge memory allows for a scene of so many pages, `size` at the least.
    std::function<uint32_t(const Scene&, LightmapPages pages, uint32_t edge)> fitting = {};
    Furnishing furnishing = {};
    // The file's last atlas is remembered by these: charts that are made stay where they are, and so do
    // rectangles of UVs that objects bring.
    UnwrapMemory* memory = nullptr;
    RectMemory* rects = nullptr;
    bool edited = false; // edits follow, which may add light: furnishLight() is called after them
};

/// Takes size and pages from a lightmap that is there: the gutters of a repacked atlas depend on both.
void matchLightmap(PrepareDesc& desc, const FloatImage& lightmap);

/// Prepares a scene and logs the warnings of each step. Where lightmap UVs are to be made, which takes a
/// while, `whenRead` is called before with the scene as its file has it. Throws Error.
PreparedScene prepareScene(const PrepareDesc& desc, const std::function<void(const Scene&)>& whenRead = {});

/// Adds preview light to a prepared scene that is dark and warns about it, or throws Error, as the furnishing
/// says.
void furnishLight(PreparedScene& prepared, const Furnishing& furnishing);

} // namespace relume
