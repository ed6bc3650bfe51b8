#pragma once

#include "assets/model/scene_edits.h"

namespace relume {

struct LightmapAtlas;
struct LightMix;

/// An edit of a bake: all that users edit live, as it is to be, whether it changes or not.
struct BakeEdits {
    const SceneEdits& scene;
    const LightMix& mix;
    // This is the one that the mesh was made with; without it, objects that move cannot be followed.
    const LightmapAtlas* atlas = nullptr;
    // The level, where its textures, metallic or roughness are others now; its triangles are those that are
    // baked. What shines and what is masked must look as it did. Needs the atlas.
    const Scene* repainted = nullptr;
};

/// The answer of Baker::apply().
enum class Applied {
    Now,          // the bake goes on with the edit
    Later,        // nothing has changed; the solver must step before it can take the edit
    NeedsNewBake, // nothing has changed; only another Baker can show the edit
};

/// Tells in which ways a scene is to be another one than the one that is baked.
struct SceneDifference {
    bool lights = false;  // analytic lights, or what is set of the sky
    bool colours = false; // base colours or emission of materials
    bool objects = false; // where objects stand, or whether they are hidden
    bool patches = false; // something that patches, or a picture of the sky, were made with

    bool any() const { return lights || colours || objects || patches; }
};
SceneDifference differenceBetween(const Scene& baked, const SceneEdits& wanted);

/// Holds what a bake can do with an edit.
struct BakeReadiness {
    bool follows = false; // the scene may be changed, and each light has a layer
    bool fits = false;    // there is memory for layers of all the lights
    bool atRest = false;  // colours and objects may change now
};
/// Decides what becomes of an edit. Switches and weights of lights count at once. A bounce under way reads
/// the colours of surfaces and the links, so these change between two bounces. An answer of Now is no promise
/// that objects can be followed: that shows when it is tried.
Applied decideEdit(const SceneDifference& difference, const BakeReadiness& readiness);

} // namespace relume
