#include "assets/atlas/lightmap_atlas.h"

namespace relume {

Scene withAtlas(const Scene& scene, const LightmapAtlas& atlas) {
    Scene result = scene;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const AtlasRect& rect = atlas.instances[i];
        const bool asItIs =
            rect.texCoord == 1 && rect.scale == glm::vec2(1.0f) && rect.offset == glm::vec2(0.0f);
        if (rect.texCoord < 0 || asItIs) continue;
        Mesh mesh = scene.meshes[static_cast<size_t>(scene.instances[i].mesh)];
        for (Primitive& primitive : mesh.primitives) {
            const auto& uvs = rect.texCoord == 1 ? primitive.texCoord1 : primitive.texCoord0;
            std::vector<glm::vec2> placed;
            placed.reserve(uvs.size());
            for (glm::vec2 uv : uvs)
                placed.push_back(uv * rect.scale + rect.offset);
            primitive.texCoord1 = std::move(placed);
        }
        result.instances[i].mesh = static_cast<int>(result.meshes.size());
        result.meshes.push_back(std::move(mesh));
    }
    return result;
}

} // namespace relume
