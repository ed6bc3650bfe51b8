#pragma once

#include <functional>
#include <random>
#include <vector>

#include "assets/atlas/world_mesh.h"
#include "bake/lights/emitters.h"
#include "tests/unit/shapes.h"

namespace relume::shader {

/// Does the light tree's descent over a set on the host.
struct EmitterTables {
    const EmitterSet* set;
    EmitterNode emitterNode(uint index) { return set->nodes[index]; }
    EmitterPolygon emitterPolygon(uint index) { return set->polygons[index]; }
#include "shaders/lib/light/pick_emitter.glsl"
};

} // namespace relume::shader

namespace relume::test {

/// Returns the mesh of a scene as it is in a bake. Its lightmap UVs are TEXCOORD_1; instances without these
/// have none.
inline WorldMesh flattened(const Scene& scene) {
    LightmapAtlas atlas;
    for (const Instance& instance : scene.instances) {
        const bool mapped = !scene.meshes[size_t(instance.mesh)].primitives[0].texCoord1.empty();
        atlas.instances.push_back({{1, 1}, {0, 0}, mapped ? 1 : -1});
    }
    return flatten(scene, atlas);
}

inline EmitterSet emittersOf(const Scene& scene, EmitterDesc desc = {}) {
    return buildEmitters(scene, flattened(scene), desc);
}

/// Makes a scene of one primitive that emits `emission`.
inline Scene glowing(Primitive primitive, glm::vec3 emission = glm::vec3(1)) {
    primitive.material = 0;
    Scene scene = sceneOf(std::move(primitive));
    scene.materials.resize(1);
    scene.materials[0].emission = emission;
    return scene;
}

/// Makes the square with an emission texture over it, upright: pixel (0, 0) is at uv (0, 0).
inline Scene glowingPicture(uint32_t width, uint32_t height,
                            const std::function<glm::u8vec3(uint32_t, uint32_t)>& pixel) {
    Primitive primitive = square();
    primitive.texCoord0 = primitive.texCoord1;
    Scene scene = glowing(primitive);
    Image image{"emission", width, height, {}};
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            const glm::u8vec3 p = pixel(x, y);
            image.rgba.insert(image.rgba.end(), {p.r, p.g, p.b, 255});
        }
    scene.images = {image};
    scene.textures = {{.image = 0}};
    scene.materials[0].emissionTexture.texture = 0;
    return scene;
}

/// Makes `count` squares of side `size` in the unit cube, turned and lit at random, the brightest 1000 times
/// as bright as the darkest.
inline Scene manyLamps(uint32_t count, float size, uint32_t seed = 1) {
    Scene scene;
    scene.path = "lamps.glb";
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    for (uint32_t i = 0; i < count; ++i) {
        Primitive primitive = square();
        primitive.texCoord1.clear();
        primitive.material = int(i);
        Material material;
        material.emission =
            glm::vec3(unit(random), unit(random), unit(random)) * std::pow(1000.0f, unit(random));
        scene.materials.push_back(material);
        glm::mat4 place = glm::translate(glm::mat4(1), {unit(random), unit(random), unit(random)});
        place = glm::rotate(place, 6.28f * unit(random),
                            {unit(random) - 0.5f, unit(random) - 0.5f, unit(random)});
        addInstance(scene, addMesh(scene, primitive), glm::scale(place, glm::vec3(size)));
    }
    return scene;
}

} // namespace relume::test
