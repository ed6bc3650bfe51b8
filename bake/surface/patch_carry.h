#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "assets/model/scene.h"
#include "bake/surface/patch_set.h"

namespace relume {

/// Tells which patches of a level are those that it had before its meshes, materials or objects were edited.
/// An object is the same one where its triangles, their places in the lightmap and its patches are the same
/// to the bit, and rays that meet it are told the same of it; its name and number say nothing. Colours may be
/// others.
struct PatchCarry {
    struct Object {
        uint32_t former = shader::kNoPatch; // the instance that it was; kNoPatch: there was none
        std::vector<std::pair<uint32_t, uint32_t>> materials; // of its triangles: now, and then
    };
    std::vector<Object> objects;   // per instance of the scene
    std::vector<uint32_t> changed; // instances with triangles that were not there
    std::vector<uint32_t> gone;    // instances of the former scene whose triangles are there no more
    // Per patch, padding included, which one it was, and per former patch which one it is; kNoPatch: none.
    std::vector<uint32_t> former, now;
    uint32_t kept = 0; // patches that were there
    bool same = false; // all patches are, each in its place

    /// Returns what an instance's material was a material of: its instance and material in the former scene.
    /// Returns nothing where there is no such thing, or several.
    std::optional<std::pair<uint32_t, uint32_t>> formerLight(uint32_t instance, uint32_t material) const;
};

/// A scene and the patches that were made of it, with hidden objects as ObjectMover leaves them.
struct BakedSurfaces {
    const Scene& scene;
    const PatchSet& patches;
};

/// Compares the surfaces of two scenes, which have lightmaps of one size.
PatchCarry carryPatches(const BakedSurfaces& before, const BakedSurfaces& after);

/// Has patches that were there lie inside something, and start their samples, as they did before.
void carrySearches(const PatchCarry& carry, const PatchSet& before, PatchSet& after);

/// Tells whether all patches have the colours and the emission, for factors of 1, that they had before; needs
/// carry.same.
bool sameColours(const PatchSet& before, const PatchSet& after);

} // namespace relume
