#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "assets/world_mesh.h"
#include "bake/vk/device.h"

namespace relume {

/// What the CIT pass (calculate initial textures: UV-space rasterization) leaves in every texel, row 0 = v 0.
/// Texels without a surface are zero.
struct TextureGroup {
    uint32_t size = 0;               // [texels]
    std::vector<glm::vec4> pos;      // [m], a = 1: a patch
    std::vector<glm::vec4> nrm;      // unit, shading
    std::vector<glm::vec4> mat;      // albedo for a base colour factor of 1
    std::vector<glm::vec4> emission; // for an emission factor of 1 cd/m^2
    std::vector<uint32_t> triangle;  // 1 + index in the WorldMesh
};

struct CitDesc {
    uint32_t size = 512;
    bool conservative = false; // every texel that a triangle touches becomes a patch
    bool rtrad = false;        // albedo = base colour, whatever the metallic factor
    uint32_t firstRow = 0;     // of texels that are asked for; all others come without a surface
    uint32_t rows = ~0u;
};

/// Draws the mesh into its lightmap; the triangle drawn last wins. Throws Error.
TextureGroup rasterizeTextureGroup(const vk::Device& device, const Scene& scene, const WorldMesh& mesh,
                                   const CitDesc& desc);

} // namespace relume
