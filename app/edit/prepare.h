#pragma once

#include <string>

#include "assets/atlas/lightmap_atlas.h"
#include "assets/atlas/world_mesh.h"
#include "assets/gltf/gltf.h"

namespace relume {

/// A scene that was read, given an atlas and flattened, from which a bake starts.
struct PreparedScene {
    Scene scene;
    LightmapAtlas atlas;
    WorldMesh mesh;
    double loadSeconds = 0, atlasSeconds = 0;
};

struct PrepareDesc {
    std::string path;
    GltfChoice choice;
    uint32_t size = 512; // lightmap edge [texels]
    bool unwrap = false; // make lightmap UVs for meshes without usable ones
    double density = 0;  // of the unwrap [texels/m], 0: fitted to the size
};

/// Prepares a scene and logs the warnings of each step. Throws Error.
PreparedScene prepareScene(const PrepareDesc& desc);

} // namespace relume
