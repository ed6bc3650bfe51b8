// Tells what the scene's fragment is, in place of its colour. OUTPUT 0 is the lightmap tile, 1 instance,
// material and lightmap uv, 2 the position. MASKED says that the material has holes, BASE that its colour is
// a texture.

#include "lib/scene_material.glsl"

layout(binding = 0) uniform sampler2D baseTexture;
layout(std430, binding = 0) readonly buffer Materials { SceneMaterial materials[]; };

layout(location = 1) uniform uint material;
layout(location = 2) uniform uint lightmapSize; // [texels]

in vec3 fragPosition;
in vec2 fragBaseUv;
in vec2 fragLightmapUv;
in vec4 fragColor;
flat in uvec2 fragIds;

out uvec4 result; // x above 0 where the scene is

void main() {
    float alpha = materials[material].baseColor.a * fragColor.a;
    if (BASE != 0) alpha *= texture(baseTexture, fragBaseUv).a;
    bool mapped = fragIds.y != 0u;
    uint tiles = (lightmapSize + kTileTexels - 1u) / kTileTexels;
    uvec2 texel = uvec2(clamp(fragLightmapUv * float(lightmapSize), 0.0, float(lightmapSize) - 1.0));
    uvec2 tile = texel / kTileTexels;
    if (OUTPUT == 0) result = uvec4(mapped ? 1u + tile.y * tiles + tile.x : 0u, 0u, 0u, 0u);
    if (OUTPUT == 1) result = uvec4(1u + fragIds.x, material, mapped ? floatBitsToUint(fragLightmapUv) : uvec2(kNoUv));
    if (OUTPUT == 2) result = uvec4(1u, floatBitsToUint(fragPosition));
    if (MASKED != 0 && alpha < materials[material].emission.a) discard;
}
