#include "bake/texture_group.h"

#include "bake/cit_pass.h"

namespace relume {

TextureGroup rasterizeTextureGroup(const vk::Device& device, const Scene& scene, const WorldMesh& mesh,
                                   const CitDesc& desc) {
    return CitPass(device, scene, mesh).draw(scene, mesh, desc);
}

} // namespace relume
