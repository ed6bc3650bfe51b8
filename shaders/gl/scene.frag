// A fragment of the scene in view VIEW with lightmap filter FILTER. Lit views are linear light times preScale, which keeps any unit within half
// floats; the others are colours as they are to be displayed.

#include "lib/tone.glsl"
#include "lib/scene_material.glsl"
#include "gl/lightmap.glsl"

layout(binding = 0) uniform sampler2D baseTexture;
layout(binding = 1) uniform sampler2D emissionTexture;
layout(binding = 2) uniform sampler2D metallicTexture;
layout(std430, binding = 0) readonly buffer Materials { SceneMaterial materials[]; };

layout(location = 1) uniform uint material;
layout(location = 4) uniform vec3 eye;
layout(location = 5) uniform vec3 ambient;       // lighting where there is no lightmap [cd/m^2]
layout(location = 6) uniform uint lightmapSize;  // [texels]
layout(location = 7) uniform float preScale;
layout(location = 8) uniform float medianDensity; // of the scene, in texels per metre at lightmapSize
layout(location = 9) uniform uint hasLightmap;    // 0: there is no light yet

in vec3 fragPosition;
in vec3 fragNormal;
in vec2 fragBaseUv;
in vec2 fragEmissionUv;
in vec2 fragMetallicUv;
in vec2 fragLightmapUv;
in vec4 fragColor;
flat in uvec2 fragIds;

out vec4 result; // a: 1 where the scene is

// Constants, not uniforms: a software device would go through all branches.
const uint view = VIEW;
const uint filterKind = FILTER;
const vec3 kNoLightmap = vec3(0.35, 0.3, 0.4); // display; of geometry without lightmap UVs
const float kTile = 8.0;                       // texels, the unit of the baker's order

// Light from the viewer's side, so that shapes show where there is no other light.
float headlight() {
    return 0.6 + 0.4 * abs(dot(normalize(fragNormal), normalize(eye - fragPosition)));
}

vec3 lighting(bool mapped) {
    vec3 flatLight = ambient * headlight();
    return mapped && hasLightmap != 0u ? sampleLightmap(fragLightmapUv, filterKind, flatLight) : flatLight;
}

// Hues a golden angle apart: neighbours in number are far apart in colour.
vec3 idColor(uint id) {
    float hue = fract(float(id) * 0.61803399 + 0.13);
    vec3 rgb = clamp(abs(fract(hue + vec3(0.0, 2.0 / 3.0, 1.0 / 3.0)) * 6.0 - 3.0) - 1.0, 0.0, 1.0);
    float value = 0.95 - 0.25 * fract(float(id) * 0.381966);
    return value * mix(vec3(1.0), rgb, 0.55);
}

vec3 checkerColor() {
    vec2 texel = floor(fragLightmapUv * float(lightmapSize));
    vec2 tile = floor(texel / kTile);
    float odd = mod(texel.x + texel.y, 2.0), oddTile = mod(tile.x + tile.y, 2.0);
    vec3 tint = mix(vec3(1.0, 0.93, 0.8), vec3(0.78, 0.88, 1.0), oddTile);
    return tint * mix(0.55, 0.9, odd);
}

// Blue: fewer texels per metre than the median, red: more; full colour at a factor of 4.
vec3 densityColor(float density) {
    float octaves = clamp(log2(max(density / medianDensity, 1e-6)) / 2.0, -1.0, 1.0);
    vec3 end = octaves < 0.0 ? vec3(0.15, 0.3, 0.85) : vec3(0.85, 0.2, 0.1);
    return mix(vec3(0.9), end, abs(octaves));
}

vec3 coverageColor() {
    float coverage = texelFetch(lightmap, ivec2(fragLightmapUv * float(lightmapSize)), 0).a;
    return coverage > 0.75  ? vec3(0.35, 0.7, 0.4)  // a patch
           : coverage > 0.0 ? vec3(0.95, 0.75, 0.2) // filled from its neighbours
                            : vec3(0.85, 0.15, 0.15);
}

void main() {
    SceneMaterial m = materials[material];
    // Derivatives and mips need all fragments of a quad: no discard before them.
    vec3 px = dFdx(fragPosition), py = dFdy(fragPosition);
    vec2 tx = dFdx(fragLightmapUv), ty = dFdy(fragLightmapUv);
    vec4 base = m.baseColor * fragColor * texture(baseTexture, fragBaseUv);
    vec3 emission = m.emission.rgb * texture(emissionTexture, fragEmissionUv).rgb;
    vec4 metal = texture(metallicTexture, fragMetallicUv);
    if (m.emission.a > 0.0 && base.a < m.emission.a) discard;

    vec3 albedo = diffuseAlbedo(base.rgb, m.metallic.x * metal.b, m.metallic.y * metal.g);
    bool mapped = fragIds.y != 0u;
    vec3 color;
    switch (view) {
    case kViewLit: color = (emission + albedo * lighting(mapped)) * preScale; break;
    case kViewLighting: color = lighting(mapped) * preScale; break;
    case kViewAlbedo: color = srgbEncode(clamp(albedo, 0.0, 1.0)); break;
    case kViewEmission: color = emission * preScale; break;
    case kViewNormal: color = 0.5 * normalize(fragNormal) + 0.5; break;
    case kViewMaterial: color = idColor(material) * headlight(); break;
    case kViewInstance: color = idColor(fragIds.x) * headlight(); break;
    case kViewChecker: color = (mapped ? checkerColor() : kNoLightmap) * headlight(); break;
    case kViewDensity: {
        float texels = float(lightmapSize) * sqrt(abs(tx.x * ty.y - tx.y * ty.x));
        float metres = sqrt(length(cross(px, py)));
        color = (mapped ? densityColor(texels / max(metres, 1e-30)) : kNoLightmap) * headlight();
        break;
    }
    default: color = (mapped && hasLightmap != 0u ? coverageColor() : kNoLightmap) * headlight(); break;
    }
    const float largest = 6e4; // below the largest half float
    result = vec4(clamp(color, vec3(0.0), vec3(largest)), 1.0);
}
