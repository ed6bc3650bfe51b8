#pragma once

#include <string>
#include <vector>

#include "app/edit/prepare.h"
#include "assets/model/scene_edits.h"

namespace relume {

/// Tells what a file that was written anew has other than before.
struct SceneChanges {
    size_t lights = 0;     // that changed, came or went; those of preview do not count
    size_t objects = 0;    // that stand elsewhere, are hidden or shown, came or went
    size_t materials = 0;  // whose colour or emission changed, came or went
    size_t meshes = 0;     // whose triangles changed, came or went
    size_t pictures = 0;   // of textures, whose pixels changed, came or went
    bool sky = false;      // what is set of it
    bool surfaces = false; // what patches are made with: they are to be made anew
    bool paint = false;    // textures, metallic or roughness, where patches may stay

    bool any() const {
        return lights + objects + materials + meshes + pictures > 0 || sky || surfaces || paint;
    }
};

/// Compares a scene with the same file's former one. `held` has the materials, objects, lights and sky that
/// the file held last, which a save may have changed since `before` was read. Objects, lights, materials and
/// meshes are told apart by name. Where names are missing or stand twice they go by number as long as all
/// names are the same, else by what they are.
SceneChanges changesBetween(const Scene& held, const PreparedScene& before, const PreparedScene& after);

/// Returns the changes in words: "1 light, 2 objects", "nothing".
std::string describe(const SceneChanges& changes);

/// Holds a user's edits as they stand on a file that was written anew.
struct CarriedEdits {
    SceneEdits edits;
    std::vector<std::string> conflicts = {}; // what was edited both here and there, one line each
    bool sameNumbers = false;                // materials, objects and lights have the numbers that they had
    bool sameFile = false;                   // and the file has them as it had them before
};

/// Merges three ways, part by part: what only the user edited stays edited, what only the file changed is as
/// it is there, and where both did, the user's edit stays and is told. Materials go by their colour and
/// emission, lights and objects as a whole. What the file has no more is gone. `before` is the scene as the
/// file had it, `own` what the user made of it, `after` the scene as the file has it now. Lights of the file
/// keep the nodes of `after`. Preview light that comes because the file is dark now stays away where the
/// user's edits shine.
CarriedEdits carryEdits(const Scene& before, const SceneEdits& own, const Scene& after);

} // namespace relume
