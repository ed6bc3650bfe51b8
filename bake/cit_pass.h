#pragma once

#include <cstdint>
#include <memory>

#include "bake/texture_group.h"

namespace relume {

/// The CIT pass of meshes that share materials: program and textures stay from one drawing to the next.
class CitPass {
public:
    /// Of the materials that the mesh has. The device must outlive it. Throws Error.
    CitPass(const vk::Device& device, const Scene& scene, const WorldMesh& mesh);
    ~CitPass();

    /// Whether this mesh has just these materials.
    bool serves(const WorldMesh& mesh) const;
    /// As rasterizeTextureGroup(). Factors of materials may be others than before, their textures not.
    TextureGroup draw(const Scene& scene, const WorldMesh& mesh, const CitDesc& desc);
    /// On the device, of textures.
    uint64_t bytes() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace relume
