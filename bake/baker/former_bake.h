#pragma once

#include <vector>

#include "assets/atlas/world_mesh.h"
#include "assets/model/scene.h"
#include "bake/layers/layer_carry.h"
#include "bake/surface/patch_set.h"
#include "bake/validity/met_bits.h"

namespace relume {

/// Holds what a bake in layers leaves for another one of the same level, whose meshes, materials or objects
/// were edited, and of the same settings.
struct FormerBake {
    Scene scene; // as it was baked; Baker::release() leaves that to its caller, whose scene it is
    PatchSet patches;
    std::vector<MetBits> inside; // per patch, as ObjectMover has them
    std::vector<OwnPoint> aside; // where patches had stepped aside to; they have stepped back
    FormerLayers layers;
};

/// The surfaces of a bake, and what it can go on with.
struct BakeSurfaces {
    BakeSurfaces(WorldMesh flattened) : mesh(std::move(flattened)) {} // NOLINT: a mesh is most of it
    BakeSurfaces(WorldMesh flattened, FormerBake* before) : mesh(std::move(flattened)), former(before) {}

    WorldMesh mesh;
    // Its layers are used up where the bake comes about; where that fails they stay as they are.
    FormerBake* former = nullptr;
};

} // namespace relume
