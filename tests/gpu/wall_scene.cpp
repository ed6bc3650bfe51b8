#include "tests/gpu/wall_scene.h"

#include <cmath>

namespace relume {

FloatImage lightmapOf(LightTexel first, LightTexel second, uint32_t split) {
    FloatImage image{kWallSize, kWallSize, {}, {}, {}};
    const char* channels[] = {"R", "G", "B", "coverage"};
    for (size_t c = 0; c < 4; ++c) {
        std::vector<float>& plane = image.add(channels[c]);
        for (size_t i = 0; i < plane.size(); ++i)
            plane[i] = i % kWallSize < split ? first[c] : second[c];
    }
    return image;
}

FloatImage lightmapOf(float light) {
    const LightTexel all = {light, light, light, 1.0f};
    return lightmapOf(all, all, 0);
}

SceneMaker wall(const Material& material) {
    SceneMaker maker(kWallSize);
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(material), {kWallSize, kWallSize});
    return maker;
}

Material grey(float albedo, float emission) {
    Material material;
    material.baseColor = glm::vec4(glm::vec3(albedo), 1.0f);
    material.emission = glm::vec3(emission);
    material.metallic = 0.0f;
    return material;
}

ViewCamera before(float z) {
    ViewCamera camera;
    camera.eye = {0, 0, z};
    camera.halfHeight = 1.0f;
    camera.znear = 0.1f;
    camera.zfar = 10.0f;
    return camera;
}

DrawSettings plain(View view, LightmapFilter filter) {
    DrawSettings settings;
    settings.view = view;
    settings.filter = filter;
    settings.tone = ToneMap::None;
    settings.exposure = 0.0f;
    settings.dither = false; // each value is one step of 8 bits
    return settings;
}

int encoded(double linear) {
    return static_cast<int>(std::lround(255.0 * srgbFromLinear(linear)));
}

} // namespace relume
