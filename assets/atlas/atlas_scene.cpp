#include "assets/atlas/lightmap_atlas.h"
#include "assets/atlas/uv_writer.h"
#include "assets/base/warnings.h"

#include <spdlog/spdlog.h>

namespace relume {

LightmapAtlas onOneSheet(LightmapAtlas atlas) {
    if (atlas.pages.count == 1) return atlas;
    const auto columns = static_cast<float>(atlas.pages.columns());
    for (AtlasRect& rect : atlas.instances) {
        rect.offset = (rect.offset + glm::vec2(atlas.pages.cellOf(rect.page))) / columns;
        rect.scale /= columns;
        rect.page = 0;
    }
    atlas.pages = {};
    return atlas;
}

Scene withAtlas(const Scene& scene, const LightmapAtlas& atlas) {
    Scene result = scene;
    result.pages = atlas.pages.count;
    Warnings warnings;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const AtlasRect& rect = atlas.instances[i];
        result.instances[i].page = rect.page;
        const bool asItIs =
            rect.texCoord == 1 && rect.scale == glm::vec2(1.0f) && rect.offset == glm::vec2(0.0f);
        if (rect.texCoord < 0 || asItIs) continue;
        Mesh mesh = scene.meshes[static_cast<size_t>(scene.instances[i].mesh)];
        if (!canFreeSecondSet(scene, mesh))
            warnings.add(
                "mesh " + inQuotes(mesh.name),
                "needs three UV sets for textures, of which the lightmap takes one where the scene is "
                "written: let its textures share one set");
        std::vector<std::vector<glm::vec2>> lightmapUvs;
        for (const Primitive& primitive : mesh.primitives) {
            std::vector<glm::vec2> placed = uvSet(primitive, rect.texCoord);
            for (glm::vec2& uv : placed)
                uv = uv * rect.scale + rect.offset;
            lightmapUvs.push_back(std::move(placed));
        }
        freeSecondSet(scene, mesh); // or textures that read it would read the lightmap's UVs
        for (size_t k = 0; k < mesh.primitives.size(); ++k)
            mesh.primitives[k].texCoord1 = std::move(lightmapUvs[k]);
        result.instances[i].mesh = static_cast<int>(result.meshes.size());
        result.meshes.push_back(std::move(mesh));
    }
    for (const std::string& line : warnings.lines(scene.path))
        spdlog::warn("{}", line);
    return result;
}

} // namespace relume
