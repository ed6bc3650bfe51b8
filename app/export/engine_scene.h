#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "assets/atlas/lightmap_atlas.h"
#include "assets/model/scene.h"

namespace relume {

/// A scene in the form that engines read, whose light is in a lightmap.
struct EngineScene {
    Scene scene;
    std::vector<bool> lit;      // by Scene::materials: those that the lightmap lights
    std::vector<uint32_t> page; // by Scene::materials: the page of the lightmap that does
};

/// Returns a scene as engines read it: one mesh per instance, with the instance's lightmap UVs in TEXCOORD_1;
/// what is hidden, lights and sky are left out, since their light is in the lightmap; emission stays, and
/// metals are an engine's (engine_metals.h). Every primitive has a material, which no objects on several
/// pages of the lightmap share. What has no lightmap UVs gets `ambient`, the mean lighting [cd/m^2], as
/// emission, as the viewer shows it; so do panes, which no bake lights.
EngineScene engineScene(const Scene& scene, const LightmapAtlas& atlas, const glm::vec3& ambient);

/// Makes panes that transmit ones that blend, for engines that do not show what is behind the former.
void blendWhatTransmits(Scene& scene);

/// Makes UVs those that textures read through KHR_texture_transform, for engines that do not know all of it.
/// Returns the names of materials whose textures read one set through several: these stay as they are.
std::vector<std::string> applyTextureTransforms(Scene& scene);

/// Returns the names of meshes with a texture that reads TEXCOORD_2, each once: glTF asks engines to read two
/// sets, of which the lightmap has one.
std::vector<std::string> meshesWithThirdSet(const Scene& scene);

/// Leaves out images and textures that no material reads.
void dropUnusedTextures(Scene& scene);

} // namespace relume
