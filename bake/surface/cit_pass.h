#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "assets/atlas/world_mesh.h"
#include "bake/surface/texture_group.h"
#include "bake/vk/device.h"

namespace relume {

/// The CIT pass of meshes that share materials: program and textures stay from one drawing to the next.
class CitPass {
public:
    /// Makes what the mesh's materials need. The device must outlive it. Throws Error.
    CitPass(const vk::Device& device, const Scene& scene, const WorldMesh& mesh);
    ~CitPass();

    /// Tells whether this mesh has just these materials.
    bool serves(const WorldMesh& mesh) const;
    /// Draws as rasterizeTextureGroup() does. Factors of materials may have changed, their textures not.
    TextureGroup draw(const Scene& scene, const WorldMesh& mesh, const CitDesc& desc);
    /// Returns a line for images that are larger than the device's may be, and are made smaller for it.
    std::vector<std::string> warnings(const Scene& scene) const;
    /// Returns the device bytes of the textures.
    uint64_t bytes() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Draws the mesh into its lightmap; the triangle drawn last wins. A window has the texels of the whole
/// lightmap. Logs the warnings of CitPass. Throws Error.
TextureGroup rasterizeTextureGroup(const vk::Device& device, const Scene& scene, const WorldMesh& mesh,
                                   const CitDesc& desc);

} // namespace relume
